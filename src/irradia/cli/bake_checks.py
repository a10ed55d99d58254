"""Which options of a bake can't be had together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from irradia.cli.bake_trace import STATE
from irradia.core.errors import InputError

if TYPE_CHECKING:
    from irradia.cli.bake_job import BakeJob


@dataclass(frozen=True)
class Conflict:
    """An option and what it can't be had with.

    Attributes:
        option: As on the command line.
        others: Likewise.
        why: Said to whoever gives both.
    """

    option: str
    others: tuple[str, ...]
    why: str


CONFLICTS = (
    Conflict(
        "--mode ao",
        (
            *("--time", "--noise", "--adaptive", "--indirect-clamp", "--integrator path", "--view-first"),
            *("--directional", "--direct-map", "--normal-maps", "--probes", "--only", "--update"),
            *("--shard", "--resume"),
        ),
        "Ambient occlusion is no light: it has --samples, --ao-distance and --format.",
    ),
    Conflict(
        "--shard",
        ("--time", "--noise", "--adaptive", "--view-first", "--update", "--only", "--resume"),
        "Parts must be alike on all machines: give --samples alone.",
    ),
    Conflict(
        "--update",
        ("--time", "--noise", "--adaptive", "--integrator path", "--mode direct"),
        "It compares the early passes of two bakes, which must be alike: give --samples alone.",
    ),
    Conflict(
        "--direct-map",
        ("--mode indirect", "--mode direct"),
        "It is the part of a map of full light that punctual lights send straight.",
    ),
    Conflict(
        "--probes", ("--mode direct",), "Probes are lit by what the map holds; bake them with full light."
    ),
)


def check_job(job: BakeJob) -> None:
    """Refuses a job that asks for what can't be had together.

    Raises:
        InputError: Names the options.
    """
    if job.resume and not (job.out / STATE).exists():
        raise InputError(
            "there is no interrupted bake here", where=str(job.out), fix="Bake without --resume."
        )
    given = _given(job)
    for conflict in CONFLICTS:
        found = [other for other in conflict.others if other in given]
        if conflict.option in given and found:
            raise InputError(
                f"can't be had with {', '.join(found)}",
                where=conflict.option,
                fix=conflict.why,
            )


def _given(job: BakeJob) -> set[str]:
    """Options that a job stands for, as far as they exclude others."""
    bake = job.bake
    is_given = {
        "--time": bake.time_s is not None,
        "--noise": bake.noise is not None,
        "--adaptive": bake.adaptive,
        "--indirect-clamp": bake.indirect_clamp is not None,
        "--integrator path": not bake.cached,
        "--view-first": job.view_first is not None,
        "--directional": bake.directional is not None,
        "--direct-map": bake.direct_map,
        "--normal-maps": bake.normal_maps,
        "--probes": job.probes is not None,
        "--only": bool(job.only),
        "--update": job.update,
        "--shard": job.shard is not None,
        "--resume": job.resume,
        "--mode ao" if job.occlusion else f"--mode {bake.mode}": True,
    }
    return {option for option, chosen in is_given.items() if chosen}
