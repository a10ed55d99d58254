"""``irradia demo``: bakes a scene of our own and trains a field from it, with report."""

from __future__ import annotations

import shlex
import shutil
import sys
from pathlib import Path

import click

from irradia.cli import options
from irradia.cli.output import code_of, finish

SCENE = "builtin:atrium"
N_PIXELS = 640 * 360  # of the report's pictures: the references take half of the demo's three minutes


@click.command("demo")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("irradia-demo"),
    show_default=True,
    help="Folder for the results.",
)
@options.reference_spp_option
@options.seed_option
@options.device_option
@options.threads_option
@options.json_option
def command(as_json: bool, out: Path, reference_spp: int, seed: int, device: str, threads: int | None) -> int:
    """Bake a scene of our own and train a field from it, with report."""
    from irradia.bake.lightmap import BakeOptions
    from irradia.cli.bake import describe
    from irradia.cli.bake_job import BakeJob, run_bake
    from irradia.cli.bake_views import ViewOptions
    from irradia.cli.field_job import FieldOptions
    from irradia.core.progress import stderr_progress

    job = BakeJob(
        scene=SCENE,
        out=out,
        bake=BakeOptions(seed=seed, direct_map=True),
        views=ViewOptions(reference_spp, n_pixels=N_PIXELS, seed=seed),
        neural_field=FieldOptions(seed=seed),
        device=device,  # type: ignore[arg-type]
        threads=threads,
    )
    progress = stderr_progress()
    progress.say("Baking the atrium, a scene of our own.")
    summary = run_bake(job, progress)
    progress.say(f"Open {out.resolve() / 'report.html'} in a browser.\n")
    result = {**summary.record, "out": str(out), "files": list(summary.files), "view": view_command(out)}
    told = f"{describe(job, summary)}\n\nWalk through it:  {view_command(out)}"
    return finish(as_json, result, told, code_of(summary.complete))


def view_command(folder: Path) -> str:
    """The command line that opens the viewer, as this shell understands it."""
    program = "irradia" if shutil.which("irradia") else sys.argv[0]
    return shlex.join([program, "view", str(folder)])
