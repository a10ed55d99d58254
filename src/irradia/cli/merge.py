"""``irradia merge``: joins the shards of one bake."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from irradia.cli import options
from irradia.cli.output import code_of, finish


@click.command("merge")
@click.argument("shards", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("-o", "--out", type=click.Path(path_type=Path), required=True, help="Folder for the results.")
@click.option("--scene", help="Where the scene is here, if elsewhere than on the machines that traced.")
@click.option("--no-report", is_flag=True, help="Write no report, and render no reference for it.")
@options.device_option
@options.threads_option
@options.json_option
def command(
    as_json: bool,
    shards: tuple[Path, ...],
    out: Path,
    scene: str | None,
    no_report: bool,
    device: str,
    threads: int | None,
) -> int:
    """Join the shards of one bake.

    SHARDS are the files that ``irradia bake --shard I/N`` wrote, in any order. The results
    have the same bytes as those of an undivided bake.
    """
    from dataclasses import replace

    from irradia.bake.shards import in_order, read_shard
    from irradia.cli.bake import describe
    from irradia.cli.bake_job import run_bake
    from irradia.cli.job_json import job_from_json
    from irradia.core.progress import stderr_progress

    parts = in_order([read_shard(path) for path in shards])
    job = job_from_json(parts[0].job, out, scene)
    views = None if no_report else job.views
    job = replace(job, shard=None, views=views, device=device, threads=threads)
    summary = run_bake(job, stderr_progress(), shards=parts)
    result: dict[str, Any] = {**summary.record, "out": str(out), "files": list(summary.files)}
    return finish(as_json, result, describe(job, summary), code_of(summary.complete))
