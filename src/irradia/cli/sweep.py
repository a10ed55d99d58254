"""``irradia sweep``: a grid of trainings, each in a process of its own, that goes on where it was."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from irradia.cli import options
from irradia.cli.output import INTERRUPTED, finish
from irradia.cli.sections import SectionedCommand

SECTIONS = {
    "Results": ("--out", "--json"),
    "Grid": ("--grid", "--steps", "--time", "--batch-size", "--list"),
    "Contact sheet": (
        *("--scene", "--camera", "--reference-spp", "--env", "--env-rotation", "--env-strength"),
        *("--env-color", "--sky", "--no-default-light"),
    ),
    "Machine": ("--jobs", "--seed", "--device", "--threads"),
}


@click.command("sweep", cls=SectionedCommand, sections=SECTIONS)
@click.argument("data", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("-o", "--out", type=click.Path(file_okay=False, path_type=Path), required=True, help="Folder.")
@click.option(
    "--grid",
    default="pareto",
    show_default=True,
    metavar="GRID",
    help="nic99, pareto, or a .json of options and their values.",
)
@click.option("--steps", type=options.Whole(1, 1 << 30), metavar="N", help="Of each training.")
@click.option("--time", "time_s", type=options.POSITIVE, metavar="S", help="Of each training.")
@click.option("--batch-size", type=options.Whole(1, 1 << 24), metavar="N", help="Samples a step.")
@click.option("--list", "only_list", is_flag=True, help="Name the runs and what is done; train nothing.")
@click.option("--scene", metavar="SCENE", help="Show every field in it: a .gltf, a .glb, or builtin:NAME.")
@click.option("--camera", metavar="CAMERA", help="Index, name, saved .json, or auto.  [default: the first]")
@click.option(
    "--reference-spp",
    type=options.Whole(2, options.MAX_SAMPLES),
    default=256,
    show_default=True,
    metavar="N",
    help="Samples per pixel of the picture's reference.",
)
@options.lighting_options
@click.option(
    "--jobs",
    type=options.Whole(1, 1024),
    default=1,
    show_default=True,
    metavar="N",
    help="Trainings at a time; they share the threads.",
)
@options.seed_option
@options.device_option
@options.threads_option
@options.json_option
def command(as_json: bool, **choices: Any) -> int:
    """Train a grid of fields and compare them.

    DATA is a file of samples. Every run has a folder; what is done is kept, so the same command goes on
    after Ctrl-C, a crash or a loss of power. A table (.csv and .parquet) and sweep.html grow run by run.
    """
    from irradia.cli.sweep_job import describe, run_sweep
    from irradia.core.progress import stderr_progress

    result = run_sweep(_job(**choices), stderr_progress())
    return finish(as_json, result, describe(result), _exit_code(result))


def _exit_code(result: dict[str, Any]) -> int:
    if not result["complete"]:
        return INTERRUPTED
    codes = [row["exit_code"] for row in result["failed"]]
    return 0 if not codes else (2 if set(codes) == {2} else 1)


def _job(
    *,
    data: Path,
    out: Path,
    grid: str,
    steps: int | None,
    time_s: float | None,
    batch_size: int | None,
    only_list: bool,
    scene: str | None,
    camera: str | None,
    reference_spp: int,
    jobs: int,
    seed: int,
    device: str,
    threads: int | None,
    **light: Any,
) -> Any:
    from irradia.cli.sweep_arguments import check_arguments
    from irradia.cli.sweep_grid import read_grid
    from irradia.cli.sweep_job import Sweep
    from irradia.cli.sweep_pictures import PictureJob

    shared = {"steps": steps, "time": time_s, "batch-size": batch_size}
    runs = read_grid(grid, {name: value for name, value in shared.items() if value is not None})
    check_arguments(runs, data, grid)
    pictures = None
    if scene is not None:
        pictures = PictureJob(scene, camera, options.light_options(**light), reference_spp)
    elif camera is not None:
        raise click.UsageError("--camera looks at a --scene.")
    return Sweep(data, out, grid, runs, pictures, jobs, seed, device, threads, only_list)
