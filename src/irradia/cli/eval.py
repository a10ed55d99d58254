"""``irradia eval``: a field against the path-traced reference, and against what else holds light."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from irradia.cli import options
from irradia.cli.bin_samples import bin_options, bin_sample_options
from irradia.cli.output import finish
from irradia.cli.sections import SectionedCommand

BASELINES = ("sh1", "sh2", "visibility", "lightmap")

SECTIONS = {
    "Results": ("--out", "--json"),
    "Pictures": ("--camera", "--reference-spp", "--spp", "--pixels", "--exposure"),
    "In space": ("--samples", "--coefficients", "--quantity", "--points", "--rays"),
    "Beside it": ("--baselines",),
    "The scene": (
        *("--scene", "--env", "--env-rotation", "--env-strength", "--env-color", "--sky"),
        *("--no-default-light", "--ies", "--material-override", "--variant", "--pose-time", "--force"),
    ),
    "Machine": ("--seed", "--device", "--threads"),
}


class Names(click.ParamType):
    """Some of BASELINES with commas between, ``all`` or ``none``."""

    name = "list"

    def convert(
        self, value: str | tuple[str, ...], param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, ...]:
        """The names, or a usage error."""
        if isinstance(value, tuple):
            return value
        names = {"all": BASELINES, "none": ()}.get(value, tuple(value.split(",")))
        unknown = [name for name in names if name not in BASELINES]
        if unknown:
            self.fail(f"expected all, none or some of {', '.join(BASELINES)}, found {unknown[0]!r}")
        return names


@click.command("eval", cls=SectionedCommand, sections=SECTIONS)
@click.argument("weights", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--scene", required=True, metavar="SCENE", help="A .gltf, a .glb, or builtin:NAME.")
@click.option("-o", "--out", type=click.Path(path_type=Path), required=True, help="Folder for the results.")
@click.option(
    "--camera",
    "cameras",
    multiple=True,
    metavar="CAMERA",
    help="Index, name, saved .json, or auto; may be given again.  [default: all of the scene's]",
)
@click.option(
    "--reference-spp",
    type=options.Whole(2, options.MAX_SAMPLES),
    default=512,
    show_default=True,
    metavar="N",
    help="Samples per pixel of the references, which are kept for the next time.",
)
@click.option(
    "--spp",
    type=options.Whole(1, options.MAX_SAMPLES),
    default=16,
    show_default=True,
    metavar="N",
    help="Samples per pixel of what is judged.",
)
@click.option(
    "--pixels",
    type=options.Whole(64, 1 << 24),
    default=640 * 360,
    show_default=True,
    metavar="N",
    help="About how many each picture has.",
)
@click.option(
    "--exposure", type=options.ANY, metavar="EV", help="Stops, of the pictures.  [default: automatic]"
)
@click.option(
    "--samples",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="Judge in space by this dataset, which the field wasn't trained from.",
)
@bin_sample_options
@click.option(
    "--points",
    type=options.Whole(0, 1 << 24),
    default=16_384,
    show_default=True,
    metavar="N",
    help="Places drawn in space otherwise; 0 for none.",
)
@click.option(
    "--rays",
    type=options.Whole(1, options.MAX_SAMPLES),
    default=1024,
    show_default=True,
    metavar="N",
    help="Rays per place, a multiple of 4.",
)
@click.option(
    "--baselines",
    type=Names(),
    default="all",
    show_default=True,
    metavar="LIST",
    help="What holds the light in as many bytes: sh1, sh2, visibility, lightmap; all or none.",
)
@options.lighting_options
@options.scene_options
@options.override_options
@click.option("--force", is_flag=True, help="Judge a field that was trained in another scene or light too.")
@options.seed_option
@options.device_option
@options.threads_option
@options.json_option
def command(as_json: bool, **choices: Any) -> None:
    """A field against the path-traced reference.

    WEIGHTS is a field's file. The light that it holds is shown from fixed cameras and asked for at places
    in space; both are compared with path tracing, and with probes and a lightmap of as many bytes.
    """
    from irradia.cli.eval_job import run_eval
    from irradia.core.progress import stderr_progress

    record = run_eval(_job(**choices), stderr_progress())
    finish(as_json, {**record, "out": str(choices["out"])}, describe(record))


def _job(
    *,
    weights: Path,
    scene: str,
    out: Path,
    cameras: tuple[str, ...],
    reference_spp: int,
    spp: int,
    pixels: int,
    exposure: float | None,
    samples: Path | None,
    points: int,
    rays: int,
    coefficients: str | None,
    quantity: str | None,
    baselines: tuple[str, ...],
    material_override: tuple[str, ...],
    ies: tuple[str, ...],
    variant: str | None,
    pose_time: float | None,
    seed: int,
    device: str,
    threads: int | None,
    force: bool,
    **light: Any,
) -> Any:
    from irradia.cli.eval_options import EvalJob, PictureOptions, SpaceOptions
    from irradia.scene.load import LoadOptions

    return EvalJob(
        weights=weights,
        scene=scene,
        out=out,
        load=LoadOptions(pose_time=pose_time, variant=variant),
        light=options.light_options(**light),
        overrides=material_override,
        ies=ies,
        pictures=PictureOptions(cameras, reference_spp, spp, pixels, exposure),
        space=SpaceOptions(samples, points, rays, bin_options(coefficients, quantity, samples)),
        baselines=baselines,
        seed=seed,
        device=device,  # type: ignore[arg-type]
        threads=threads,
        force=force,
    )


def describe(record: dict[str, Any]) -> str:
    """A table of the rivals, then what the field costs."""
    rows = [f"{'':<32} {'bytes':>10} {'HDR-FLIP':>10} {'MSE in space':>13} {'leak ratio':>11}"]
    for rival in record["rivals"]:
        mse = rival["space"]["mse_noise_free"] if rival["space"] else None
        leak = rival["leaks"]["ratio"] if rival["leaks"] else None
        cells = (_number(rival["flip"], 10, ".4f"), _number(mse, 13, ".3e"), _number(leak, 11, ".2f"))
        rows.append(f"{rival['name']:<32} {rival['n_bytes']:>10} {' '.join(cells)}")
    query = record["query"]
    flops, n_bytes = (_number(query[name], 0, ".0f") for name in ("flops", "encoding_bytes"))
    rows.append(
        f"{query['million_per_second']:.2f} M queries/s here; {flops} operations and "
        f"{n_bytes} bytes of the encoding a query"
    )
    return "\n".join(rows)


def _number(value: float | None, width: int, form: str) -> str:
    return f"{'–':>{width}}" if value is None else f"{value:>{width}{form}}"
