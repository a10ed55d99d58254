"""``irradia bake``: a scene's lightmaps, with baked .glb and report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from irradia.cli import options
from irradia.cli.output import INTERRUPTED, finish

if TYPE_CHECKING:
    from irradia.cli.bake_job import BakeJob, BakeSummary


@click.command("bake")
@click.argument("scene")
@click.option("-o", "--out", type=click.Path(path_type=Path), required=True, help="Folder for the results.")
@options.budget_options
@click.option(
    "--resolution",
    type=click.IntRange(options.MIN_RESOLUTION_PX, options.MAX_RESOLUTION_PX),
    help="Edge of the one page, in texels.  [default: about a million texels]",
)
@click.option("--texels-per-metre", type=options.POSITIVE, help="Density; as many pages as that needs.")
@click.option(
    "--integrator",
    type=click.Choice(["cached", "path"]),
    default="cached",
    show_default=True,
    help="Cached gather, or the unbiased reference.",
)
@click.option(
    "--mode",
    type=click.Choice(["full", "indirect", "direct"]),
    default="full",
    show_default=True,
    help="Which light: indirect leaves out the first bounce of punctual lights.",
)
@click.option(
    "--view-first",
    metavar="CAMERA",
    help="Finish first what this camera sees: a name, a camera file, or auto.",
)
@options.lighting_options
@options.scene_options
@options.map_options
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
@click.option(
    "--checkpoint",
    "checkpoint_s",
    type=options.POSITIVE,
    default=60.0,
    show_default=True,
    metavar="S",
    help="How often to save what --resume needs.",
)
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
        finish(as_json, {"shard": str(path)}, f"Shard {job.shard[0]} of {job.shard[1]}: {path}")
        return 0
    summary = run_bake(job, stderr_progress())
    result = {**summary.record, "out": str(job.out), "files": list(summary.files)}
    finish(as_json, result, describe(job, summary))
    return 0 if summary.complete else INTERRUPTED


def make_job(
    *,
    scene: str,
    out: Path,
    samples: int | None,
    time_s: float | None,
    noise: float | None,
    adaptive: bool,
    indirect_clamp: float | None,
    mode: str,
    view_first: str | None,
    shard: tuple[int, int] | None,
    only: tuple[str, ...],
    update: bool,
    directional: str | None,
    normal_maps: bool,
    no_seams: bool,
    probes: str | None,
    probe_samples: int,
    formats: str,
    material_override: tuple[str, ...],
    ies: tuple[str, ...],
    resume: bool,
    checkpoint_s: float,
    resolution: int | None,
    texels_per_metre: float | None,
    integrator: str,
    fast_rays: bool,
    no_denoise: bool,
    no_report: bool,
    reference_spp: int,
    compatible: bool,
    seed: int,
    device: str,
    threads: int | None,
    variant: str | None,
    pose_time: float | None,
    **light: Any,
) -> BakeJob:
    """The command line as a job."""
    from irradia.bake.lightmap import BakeOptions
    from irradia.bake.probes.options import ProbeOptions
    from irradia.cli.bake_job import BakeJob
    from irradia.cli.bake_views import ViewOptions
    from irradia.export.map_files import parse_formats
    from irradia.scene.lightmap_uv.options import LayoutOptions
    from irradia.scene.load import LoadOptions

    return BakeJob(
        scene=scene,
        out=out,
        load=LoadOptions(pose_time=pose_time, variant=variant),
        light=options.light_options(**light),
        layout=LayoutOptions(texels_per_metre=texels_per_metre, resolution=resolution),
        bake=BakeOptions(
            samples=options.sample_limit(samples, time_s, noise),
            time_s=time_s,
            noise=noise,
            adaptive=adaptive,
            indirect_clamp=indirect_clamp,
            integrator=integrator,  # type: ignore[arg-type]
            mode=mode,  # type: ignore[arg-type]
            directional=directional,  # type: ignore[arg-type]
            normal_maps=normal_maps,
            seams=not no_seams,
            seed=seed,
            fast_rays=fast_rays,
            denoise=not no_denoise,
        ),
        views=None if no_report else ViewOptions(reference_spp, seed=seed, fast_rays=fast_rays),
        compatible=compatible,
        shard=shard,
        only=tuple(name for part in only for name in part.split(",") if name),
        update=update,
        overrides=material_override,
        ies=ies,
        probes=None
        if probes is None
        else ProbeOptions.parse(probes, samples=probe_samples, seed=seed, fast_rays=fast_rays),
        formats=parse_formats(formats),
        resume=resume,
        checkpoint_s=checkpoint_s,
        view_first=view_first,
        device=device,  # type: ignore[arg-type]
        threads=threads,
    )


def describe(job: BakeJob, summary: BakeSummary) -> str:
    """Three lines of results."""
    record = summary.record
    lightmap, stats, found = record["lightmap"], record["stats"], record["against_reference"]
    pages = f"{lightmap['n_pages']} page{'s' if lightmap['n_pages'] > 1 else ''}"
    lines = [
        f"{record['scene']}: {lightmap['n_texels']:,} texels on {pages} of "
        f"{lightmap['width_px']} × {lightmap['height_px']}, {stats['samples_per_texel']:.4g} samples each, "
        f"baked in {record['bake_s']:.1f} s ({record['samples_per_second'] / 1e6:.2f} M samples/s)",
        ("No reference was rendered (--no-report)." if summary.complete else "Stopped early: no reference.")
        if found is None
        else f"Against the path-traced reference: HDR-FLIP {found['flip']:.4f}, "
        f"mean ratio {found['mean_ratio']:.4f}, relMSE {found['relmse']:.2e}",
        f"In {job.out}: {', '.join(summary.files)}",
    ]
    return "\n".join(lines)
