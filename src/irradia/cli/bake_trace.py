"""Runs a bake's passes so that it can be stopped, killed and taken up again."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irradia.bake.lightmap import LightmapBake
from irradia.bake.shards import Shard
from irradia.bake.state import load_state, save_state
from irradia.core.interrupt import asks_first
from irradia.core.progress import Progress

if TYPE_CHECKING:
    from irradia.cli.bake_job import BakeJob

STATE = "bake.state"  # in the folder of the results, for as long as the bake is unfinished


def trace(bake: LightmapBake, job: BakeJob, identity: dict[str, Any], progress: Progress) -> bool:
    """Traces from the beginning, or from where an earlier run was stopped.

    Args:
        bake: Prepared.
        job: Says where the state is kept, how often it is saved and whether to go on from it.
        identity: What must be the same for the bake to go on; see :func:`save_state`.
        progress: Shows stages.

    Returns:
        Whether the bake came to its end; if not, its state is left for ``--resume``.

    Raises:
        InputError: There is nothing to resume, or it is of another bake.
    """
    path = job.out / STATE
    if job.resume:
        load_state(path, bake.bake, identity)
        progress.say(f"Going on after {bake.bake.progression.spent_s:.0f} s of tracing.")
    saved = time.perf_counter()
    with asks_first(bake.bake.stop, progress.say):
        for _ in bake.passes(progress):
            if time.perf_counter() - saved >= job.checkpoint_s:
                _save(path, bake, identity, progress)
                saved = time.perf_counter()
    if not bake.bake.stopped and bake.bake.progression.spent_s < job.checkpoint_s:
        return True
    _save(path, bake, identity, progress)  # what follows takes time too, and may be killed
    if bake.bake.stopped:
        progress.say("Stopped early; the results are usable. The same command with --resume goes on.")
    return not bake.bake.stopped


def forget(job: BakeJob) -> None:
    """Takes the state away once the results stand in their place."""
    (job.out / STATE).unlink(missing_ok=True)


def _save(path: Path, bake: LightmapBake, identity: dict[str, Any], progress: Progress) -> None:
    """Saves the state; a disk without room for it need not end the bake."""
    try:
        save_state(path, bake.bake, identity)
    except OSError as error:
        progress.say(f"note: the state for --resume could not be saved: {error.strerror or error}")


def trace_shard(bake: LightmapBake, job: BakeJob, identity: dict[str, Any], progress: Progress) -> Shard:
    """Traces the early epochs and this machine's slices of the last."""
    from irradia.cli.job_json import job_to_json

    number, count = job.shard or (1, 1)
    bake.bake.keep_slices = []
    for _ in bake.passes(progress):
        pass
    return Shard(
        number,
        count,
        job_to_json(job),
        identity,
        bake.bake.cache_hash(),
        bake.bake.progression.direct.to_arrays(),
        tuple(bake.bake.keep_slices),
        bake.bake.progression.spent_s,
    )
