"""``irradia bake``: a scene's lightmaps, with baked .glb and report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from irradia.cli import options
from irradia.cli.output import code_of, finish
from irradia.cli.sections import SectionedCommand

if TYPE_CHECKING:
    from irradia.bake.occlusion import OcclusionOptions
    from irradia.bake.options import BakeOptions
    from irradia.cli.bake_job import BakeJob, BakeSummary


_MANY_FILES = 12

# Parameters that the job calls as click does.
JOB_NAMES = (
    *("scene", "out", "view_first", "shard", "update", "ies", "resume", "checkpoint_s", "compatible"),
    *("device", "threads"),
)

SECTIONS = {
    "Results": ("--out", "--format", "--compatible", "--no-report", "--reference-spp", "--json"),
    "When it is done": ("--samples", "--time", "--noise", "--adaptive", "--view-first"),
    "Texels": ("--resolution", "--texels-per-metre"),
    "What is baked": (
        *("--mode", "--ao-distance", "--directional", "--direct-map", "--normal-maps"),
        *("--probes", "--probe-samples", "--only", "--update"),
    ),
    "The scene": (
        *("--env", "--env-rotation", "--env-strength", "--env-color", "--sky", "--no-default-light"),
        *("--ies", "--material-override", "--variant", "--pose-time"),
    ),
    "How it is traced": (
        "--integrator",
        "--indirect-clamp",
        "--fast-rays",
        "--no-denoise",
        "--no-seams",
        "--seed",
    ),
    "Interruptions and machines": ("--resume", "--checkpoint", "--shard", "--device", "--threads"),
}


@click.command("bake", cls=SectionedCommand, sections=SECTIONS)
@click.argument("scene")
@click.option("-o", "--out", type=click.Path(path_type=Path), required=True, help="Folder for the results.")
@options.budget_options
@click.option(
    "--resolution",
    type=options.Whole(options.MIN_RESOLUTION_PX, options.MAX_RESOLUTION_PX),
    metavar="PX",
    help="Edge of the one page, in texels.  [default: about a million texels]",
)
@click.option(
    "--texels-per-metre", type=options.POSITIVE, metavar="X", help="Density; as many pages as that needs."
)
@click.option(
    "--integrator",
    type=click.Choice(["cached", "path"]),
    default="cached",
    show_default=True,
    help="Cached gather, or the unbiased reference.",
)
@click.option(
    "--mode",
    type=click.Choice(["full", "indirect", "direct", "ao"]),
    default="full",
    show_default=True,
    metavar="MODE",
    help="full light; indirect: without the first bounce of punctual lights; direct: the first bounce "
    "alone; ao: ambient occlusion instead.",
)
@click.option(
    "--ao-distance",
    type=options.REACH,
    metavar="M",
    help="--mode ao: surfaces farther away don't occlude; inf for all.  [default: 1, less in small scenes]",
)
@click.option(
    "--view-first",
    metavar="CAMERA",
    help="Finish first what this camera sees: a name, a camera file, or auto.",
)
@options.lighting_options
@options.scene_options
@options.map_options
@options.override_options
@click.option("--only", multiple=True, metavar="NAME", help="Bake this object alone; * and ? match.")
@click.option("--update", is_flag=True, help="Bake only what has changed since the last --update here.")
@click.option("--fast-rays", is_flag=True, help="Faster intersection that may miss edges.")
@click.option("--no-denoise", is_flag=True, help="Leave the noise in.")
@click.option("--no-report", is_flag=True, help="Write no report, and render no reference for it.")
@options.reference_spp_option
@click.option(
    "--shard",
    type=options.SHARD,
    metavar="I/N",
    help="Trace only the I-th of N parts of the samples; irradia merge joins them.",
)
@click.option("--resume", is_flag=True, help="Go on with the bake that was stopped in this folder.")
@options.checkpoint_option()
@click.option("--compatible", is_flag=True, help="Write instances out, for loaders that can't read them.")
@options.seed_option
@options.device_option
@options.threads_option
@options.json_option
def command(as_json: bool, **choices: Any) -> int:
    """Bake a scene's lightmaps, with baked .glb and report.

    SCENE is a .gltf, a .glb, or builtin:NAME.
    """
    from irradia.cli.bake_job import run_bake, run_shard
    from irradia.core.progress import stderr_progress

    job = make_job(**choices)
    if job.shard is not None:
        path = run_shard(job, stderr_progress())
        return finish(as_json, {"shard": str(path)}, f"Shard {job.shard[0]} of {job.shard[1]}: {path}")
    summary = run_bake(job, stderr_progress())
    result = {**summary.record, "out": str(job.out), "files": list(summary.files)}
    return finish(as_json, result, describe(job, summary), code_of(summary.complete))


def make_job(
    *,
    samples: int | None,
    ao_distance: float | None,
    only: tuple[str, ...],
    probes: str | None,
    probe_samples: int,
    formats: str,
    material_override: tuple[str, ...],
    resolution: int | None,
    texels_per_metre: float | None,
    fast_rays: bool,
    no_report: bool,
    reference_spp: int,
    seed: int,
    variant: str | None,
    pose_time: float | None,
    mode: str,
    **choices: Any,
) -> BakeJob:
    """The command line as a job; ``choices`` hold ``JOB_NAMES`` and those of light and of a map's values."""
    from irradia.bake.probes.options import ProbeOptions
    from irradia.cli.bake_job import BakeJob
    from irradia.cli.bake_views import ViewOptions
    from irradia.export.map_files import parse_formats
    from irradia.scene.lightmap_uv.options import LayoutOptions
    from irradia.scene.load import LoadOptions

    common: dict[str, Any] = {"seed": seed, "fast_rays": fast_rays}
    return BakeJob(
        **{name: choices.pop(name) for name in JOB_NAMES},
        load=LoadOptions(pose_time=pose_time, variant=variant),
        light=options.light_options(**{name: choices.pop(name) for name in options.LIGHT_NAMES}),
        layout=LayoutOptions(texels_per_metre=texels_per_metre, resolution=resolution),
        bake=_bake_options(samples, mode, **common, **choices),
        views=None if no_report else ViewOptions(reference_spp, **common),
        only=tuple(name for part in only for name in part.split(",") if name),
        overrides=material_override,
        probes=ProbeOptions.parse(probes, samples=probe_samples, **common) if probes is not None else None,
        formats=parse_formats(formats),
        occlusion=_occlusion(mode, samples, ao_distance, seed),
    )


def _bake_options(
    samples: int | None,
    mode: str,
    *,
    time_s: float | None,
    noise: float | None,
    no_seams: bool,
    no_denoise: bool,
    **same_name: Any,
) -> BakeOptions:
    """What decides a lightmap's values."""
    from irradia.bake.options import BakeOptions

    return BakeOptions(
        samples=options.sample_limit(samples, time_s, noise),
        mode="full" if mode == "ao" else mode,  # type: ignore[arg-type]
        time_s=time_s,
        noise=noise,
        seams=not no_seams,
        denoise=not no_denoise,
        **same_name,
    )


def _occlusion(
    mode: str, samples: int | None, distance_m: float | None, seed: int
) -> OcclusionOptions | None:
    from irradia.bake.occlusion import OcclusionOptions
    from irradia.core.errors import InputError

    if mode != "ao":
        if distance_m is not None:
            raise InputError("goes with --mode ao", where="--ao-distance")
        return None
    return OcclusionOptions(samples or OcclusionOptions.samples, distance_m, seed)


def describe(job: BakeJob, summary: BakeSummary) -> str:
    """Three lines of results: what was baked, how right it is, where it lies."""
    from irradia.cli.bake_occlusion import describe_occlusion

    if job.occlusion is not None:
        return describe_occlusion(job, summary)
    record = summary.record
    lightmap, stats = record["lightmap"], record["stats"]
    pages = f"{lightmap['n_pages']} page{'s' if lightmap['n_pages'] > 1 else ''}"
    size = f"{lightmap['width_px']} × {lightmap['height_px']}"
    return "\n".join(
        [
            f"{record['scene']}: {lightmap['n_texels']:,} texels on {pages} of {size}, "
            f"{_count(stats['samples_per_texel'])} samples each, "
            f"baked in {record['bake_s']:.1f} s ({record['samples_per_second'] / 1e6:.2f} M samples/s)"
            + _ending(record),
            _accuracy(job, record),
            files_line(job.out, summary.files),
        ]
    )


def files_line(out: Path, files: Sequence[str]) -> str:
    """Where the results are; where they are many, maps are only counted."""
    if len(files) <= _MANY_FILES:
        return f"In {out}: {', '.join(files)}"
    others = [name for name in files if not name.startswith("lightmap")]
    return f"In {out}: {len(files) - len(others)} maps (lightmap…), {', '.join(others)}"


def _count(number: float) -> str:
    """Three digits, but whole thousands."""
    return f"{number:,.0f}" if number >= 100.0 else f"{number:.3g}"


def _ending(record: dict[str, Any]) -> str:
    """Why it ended, where that isn't plain; the noise and what a clamp has cost, where that is known."""
    ends = {
        "samples": "",
        "noise": "; the noise is as low as asked",
        "time": "; its time was up",
        "interrupt": "; stopped early",
    }
    noise, lost = record["stats"]["noise_p95"], record["stats"]["clamped_off_share"]
    text = ends[record["ended_by"]]
    if noise is not None and record["ended_by"] in ("noise", "time"):
        text += f"; 95 % of the texels have less than {noise:.1%} noise before denoising"
    return text + ("" if lost is None else f"; the clamp has cut off {lost:.2%} of the light")


def _accuracy(job: BakeJob, record: dict[str, Any]) -> str:
    found = record["against_reference"]
    if found is not None:
        return (
            f"Against the path-traced reference: HDR-FLIP {found['flip']:.4f}, "
            f"mean ratio {found['mean_ratio']:.4f}, relMSE {found['relmse']:.2e}"
        )
    if record["ended_by"] == "interrupt":
        return "No reference was rendered: the bake is unfinished."
    if job.bake.mode == "direct" and job.views is not None:
        return "No reference was rendered: direct light alone is not what a camera sees."
    return "No reference was rendered (--no-report)."
