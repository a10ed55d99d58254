"""``irradia bake``: a scene's lightmaps, with baked .glb and report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from irradia.cli import options
from irradia.cli.output import finish

if TYPE_CHECKING:
    from irradia.cli.bake_job import BakeJob, BakeSummary


@click.command("bake")
@click.argument("scene")
@click.option("-o", "--out", type=click.Path(path_type=Path), required=True, help="Folder for the results.")
@click.option(
    "--samples",
    type=click.IntRange(1, options.MAX_SAMPLES),
    default=64,
    show_default=True,
    help="Gather rays per texel.",
)
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
@options.lighting_options
@options.scene_options
@click.option("--fast-rays", is_flag=True, help="Faster intersection that may miss edges.")
@click.option("--no-denoise", is_flag=True, help="Leave the noise in.")
@click.option("--no-report", is_flag=True, help="Write no report, and render no reference for it.")
@options.reference_spp_option
@click.option("--compatible", is_flag=True, help="Write instances out, for loaders that can't read them.")
@options.seed_option
@options.device_option
@options.threads_option
@options.json_option
def command(as_json: bool, **choices: Any) -> None:
    """Bake a scene's lightmaps, with baked .glb and report.

    SCENE is a .gltf, a .glb, or builtin:NAME.
    """
    from irradia.cli.bake_job import run_bake
    from irradia.core.progress import stderr_progress

    job = make_job(**choices)
    summary = run_bake(job, stderr_progress())
    result = {**summary.record, "out": str(job.out), "files": list(summary.files)}
    finish(as_json, result, describe(job, summary))


def make_job(
    *,
    scene: str,
    out: Path,
    samples: int,
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
    from irradia.cli.bake_job import BakeJob
    from irradia.cli.bake_views import ViewOptions
    from irradia.scene.lightmap_uv.options import LayoutOptions
    from irradia.scene.load import LoadOptions

    return BakeJob(
        scene=scene,
        out=out,
        load=LoadOptions(pose_time=pose_time, variant=variant),
        light=options.light_options(**light),
        layout=LayoutOptions(texels_per_metre=texels_per_metre, resolution=resolution),
        bake=BakeOptions(
            samples=samples,
            integrator=integrator,  # type: ignore[arg-type]
            seed=seed,
            fast_rays=fast_rays,
            denoise=not no_denoise,
        ),
        views=None if no_report else ViewOptions(reference_spp, seed=seed, fast_rays=fast_rays),
        compatible=compatible,
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
        f"{lightmap['width_px']} × {lightmap['height_px']}, {stats['samples_per_texel']} samples each, "
        f"baked in {record['bake_s']:.1f} s ({record['samples_per_second'] / 1e6:.2f} M samples/s)",
        "No reference was rendered (--no-report)."
        if found is None
        else f"Against the path-traced reference: HDR-FLIP {found['flip']:.4f}, "
        f"mean ratio {found['mean_ratio']:.4f}, relMSE {found['relmse']:.2e}",
        f"In {job.out}: {', '.join(summary.files)}",
    ]
    return "\n".join(lines)
