"""``irradia sample``: a dataset of a scene's light, for fields to learn from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from irradia.cli import options
from irradia.cli.output import code_of, finish
from irradia.cli.sections import SectionedCommand

if TYPE_CHECKING:
    from irradia.cli.sample_job import SampleJob

SECTIONS = {
    "Results": ("--out", "--validation", "--json"),
    "Points": ("--kind", "--count", "--spacing", "--order", "--stratified"),
    "Light": ("--quantity", "--samples", "--integrator", "--lightmap", "--resolution", "--fast-rays"),
    "The scene": (
        *("--env", "--env-rotation", "--env-strength", "--env-color", "--sky", "--no-default-light"),
        *("--ies", "--material-override", "--variant", "--pose-time"),
    ),
    "Machine": ("--seed", "--device", "--threads"),
}


@click.command("sample", cls=SectionedCommand, sections=SECTIONS)
@click.argument("scene")
@click.option(
    "-o", "--out", type=click.Path(dir_okay=False, path_type=Path), required=True, help=".samples or .bin."
)
@click.option(
    "--validation",
    type=options.Whole(0, 1 << 24),
    metavar="N",
    default=16_384,
    show_default=True,
    help="Points of NAME.validation.samples: independent, with 16 times the samples; 0 for none.",
)
@click.option(
    "--kind",
    type=click.Choice(["surface", "volume", "sh-grid", "sh-random"]),
    default="surface",
    show_default=True,
    help="Irradiance on surfaces, or in free space too; spherical harmonics in a grid or at random.",
)
@click.option(
    "--count",
    type=options.Whole(1, 1 << 30),
    metavar="N",
    help="Points; of a grid, sites.  [default: 2000000, of SH 200000]",
)
@click.option("--spacing", type=options.POSITIVE, metavar="M", help="Of a grid, instead of --count.")
@click.option(
    "--order", type=click.IntRange(1, 2), default=1, show_default=True, help="Of spherical harmonics."
)
@click.option("--stratified", is_flag=True, help="Fill surface or space evenly.")
@click.option(
    "--quantity",
    type=click.Choice(["full", "indirect"]),
    default="full",
    show_default=True,
    help="indirect: without the first bounce of punctual lights.",
)
@click.option(
    "--samples",
    type=options.Whole(4, options.MAX_SAMPLES),
    metavar="N",
    default=64,
    show_default=True,
    help="Rays per point, a multiple of 4.",
)
@click.option(
    "--integrator",
    type=click.Choice(["cached", "path"]),
    default="cached",
    show_default=True,
    help="Final gather over a lightmap, or unbiased paths.",
)
@click.option(
    "--lightmap",
    type=click.Path(exists=True, path_type=Path),
    help="A finished bake's folder or scene.baked.glb, instead of baking one now.",
)
@click.option(
    "--resolution",
    type=options.Whole(options.MIN_RESOLUTION_PX, options.MAX_RESOLUTION_PX),
    metavar="PX",
    help="Edge of the lightmap that is baked.  [default: about a million texels]",
)
@options.lighting_options
@options.scene_options
@options.override_options
@click.option("--fast-rays", is_flag=True, help="Faster intersection that may miss edges.")
@options.seed_option
@options.device_option
@options.threads_option
@options.json_option
def command(as_json: bool, **choices: Any) -> int:
    """Sample a scene's light, for a field to learn from.

    SCENE is a .gltf, a .glb, or builtin:NAME. Ctrl-C ends early: what has been written by then is a
    smaller dataset of the same kind. It doesn't replace a larger one that is there already.
    """
    from irradia.cli.sample_job import run_sampling
    from irradia.core.progress import stderr_progress

    job = make_job(**choices)
    result = run_sampling(job, stderr_progress())
    return finish(as_json, result, describe(result), code_of(result["complete"]))


def make_job(
    *,
    scene: str,
    out: Path,
    validation: int,
    kind: str,
    spacing: float | None,
    lightmap: Path | None,
    resolution: int | None,
    material_override: tuple[str, ...],
    ies: tuple[str, ...],
    variant: str | None,
    pose_time: float | None,
    device: str,
    threads: int | None,
    **choices: Any,
) -> SampleJob:
    """The command line as a job; ``choices`` hold those of light and of :class:`SampleOptions`."""
    from irradia.bake.datasets.options import SampleOptions
    from irradia.cli.sample_job import SampleJob
    from irradia.scene.lightmap_uv.options import LayoutOptions
    from irradia.scene.load import LoadOptions

    return SampleJob(
        scene=scene,
        out=out,
        load=LoadOptions(pose_time=pose_time, variant=variant),
        light=options.light_options(**{name: choices.pop(name) for name in options.LIGHT_NAMES}),
        layout=LayoutOptions(resolution=resolution),
        options=SampleOptions(placement=kind, spacing_m=spacing, **choices),  # type: ignore[arg-type]
        overrides=material_override,
        ies=ies,
        lightmap=lightmap,
        validation=validation,
        device=device,  # type: ignore[arg-type]
        threads=threads,
    )


def describe(result: dict[str, Any]) -> str:
    """What was made and how fast."""
    if "points" not in result:
        return "Stopped before the first sample."
    lines = [
        f"{result['scene']}: {result['points']:,} {result['kind']} samples of {result['quantity']} light, "
        f"{result['samples_per_point']} rays each, {result['points_per_second']:,.0f} points/s "
        f"({result['rays_per_second'] / 1e6:.2f} M rays/s)",
        f"In {result['path']}",
    ]
    if "validation" in result:
        judge = result["validation"]
        lines.append(f"and {judge['path']}: {judge['points']:,} points of {judge['samples_per_point']} rays")
    if not result["complete"]:
        lines.append("Stopped early; what was written is usable.")
    if "kept" in result:
        lines.append(
            f"{result['kept']['path']} stays as it was: it holds {result['kept']['points']:,} samples."
        )
    return "\n".join(lines)
