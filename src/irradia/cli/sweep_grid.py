"""Grids of trainings: products of values of `irradia train`'s own options, each with a name made of them.

A grid file is JSON. Values that are lists are varied, each with each; ``common`` holds for all::

    {
      "common": {"hidden-dim": 64, "time": 60},
      "grids": [
        {"encoding": "hash", "n-levels": [4, 8], "log2-hashmap-size": [15, 17]},
        {"encoding": "triplane", "plane-res": [64, 128]}
      ]
    }
"""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean

Value = str | int | float | bool
Choices = dict[str, Value]

# What names of runs call an option; any other is called by its own name.
_SHORT = {
    "n-levels": "L",
    "log2-hashmap-size": "T",
    "base-resolution": "B",
    "max-resolution": "R",
    "n-features": "F",
    "plane-res": "P",
    "features-per-plane": "F",
    "n-frequencies": "K",
    "hidden-dim": "w",
    "hidden-layers": "d",
    "finish": "",
}
_NOT_IN_A_GRID = ("input", "out", "json", "resume", "threads", "help", "follow")
_MAX_RUNS = 10_000

# 72 + 18 + 9 combinations over the ranges that the Unity project documents. Which values its own batch of
# 99 took isn't public; these are ours.
_NIC99: dict[str, Any] = {
    "grids": [
        {
            "encoding": "hash",
            "n-levels": [8, 16],
            "log2-hashmap-size": [17, 19, 21],
            "max-resolution": [512, 2048],
            "hidden-dim": [32, 64, 128],
            "hidden-layers": [2, 3],
        },
        {
            "encoding": "frequency",
            "n-frequencies": [6, 10],
            "hidden-dim": [32, 64, 128],
            "hidden-layers": [2, 3, 4],
        },
        {"encoding": "triplane", "plane-res": [64, 128, 256], "features-per-plane": [8, 16, 32]},
    ]
}
# From tens of kilobytes to a few megabytes, tables in 8 bits where there are tables.
_PARETO: dict[str, Any] = {
    "common": {"direction": "sh:3", "batch-size": 16_384, "lr-network": 0.005},
    "grids": [
        {
            "encoding": "hash",
            "n-levels": [2, 4, 6],
            "log2-hashmap-size": [13, 15, 17],
            "max-resolution": [64, 192],
            "hidden-dim": 64,
            "hidden-layers": [2, 3],
            "finish": "int8",
        },
        {
            "encoding": "triplane",
            "plane-res": [48, 96, 160],
            "features-per-plane": [4, 8, 16],
            "hidden-dim": 64,
            "hidden-layers": [2, 3],
            "finish": "int8",
        },
        {
            "encoding": "frequency",
            "n-frequencies": [6, 8],
            "hidden-dim": [32, 64, 128],
            "hidden-layers": [2, 4, 6],
        },
    ],
}
BUILT_IN: dict[str, dict[str, Any]] = {"nic99": _NIC99, "pareto": _PARETO}


@dataclass(frozen=True)
class SweepRun:
    """One training of a grid.

    Attributes:
        name: Unlike all others; made of what its grid says.
        choices: Options of `irradia train` by their names without dashes in front.
    """

    name: str
    choices: Choices

    @property
    def arguments(self) -> list[str]:
        """As the command line takes them: one word an option, so that no value passes for another option."""
        given = {name: value for name, value in self.choices.items() if value is not False}
        return [f"--{name}" if value is True else f"--{name}={value}" for name, value in given.items()]


def read_grid(spec: str, overrides: Mapping[str, Value]) -> tuple[SweepRun, ...]:
    """The runs of a built-in grid or of a file.

    Args:
        spec: Name of a built-in grid, or a file.
        overrides: Options for all runs, stronger than the grid's own.

    Raises:
        InputError: The grid isn't there or isn't one; options are unknown, or two runs have one name.
    """
    if spec in BUILT_IN:
        return expand(BUILT_IN[spec], overrides, spec)
    path = Path(spec)
    if not path.is_file():
        raise InputError(f"no grid {spec!r}", where="--grid", fix=did_you_mean(spec, BUILT_IN))
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, UnicodeDecodeError) as error:
        raise InputError(f"expected JSON: {error}", where=spec) from error
    return expand(content, overrides, spec)


def expand(content: Any, overrides: Mapping[str, Value], where: str) -> tuple[SweepRun, ...]:
    """All runs of a grid file's content, in its order; see :func:`read_grid`."""
    if not isinstance(content, dict) or not isinstance(content.get("grids"), list) or not content["grids"]:
        raise InputError('expected an object with a list "grids"', where=where)
    _expect_keys(content, ("common", "grids"), where)
    known = _train_options()
    common = content.get("common", {})
    runs = []
    for i, grid in enumerate(content["grids"]):
        if not isinstance(grid, dict) or not isinstance(common, dict):
            raise InputError("expected an object of options", where=f"{where} /grids/{i}")
        _expect_keys({**common, **grid}, known, f"{where} /grids/{i}")
        for own in _products(grid, f"{where} /grids/{i}"):
            if len(runs) == _MAX_RUNS:
                raise InputError(f"expected at most {_MAX_RUNS:,} runs", where=where)
            runs.append(SweepRun(run_name(own), {**common, **own, **overrides}))
    _expect_folder_names(runs, where)
    _expect_different(runs, where)
    return tuple(runs)


def run_name(choices: Choices) -> str:
    """Such as ``hash-L8-T17-R512-w32-d2``: fit for a folder on any system."""
    parts = [str(choices.get("encoding", "hash"))]
    for name, value in choices.items():
        if name != "encoding":
            parts.append(f"{_SHORT.get(name, f'{name}_')}{value}")
    return re.sub(r"[^A-Za-z0-9._-]+", "_", "-".join(parts))


def _products(grid: Mapping[str, Any], where: str) -> Iterator[Choices]:
    values = []
    for name, value in grid.items():
        each = value if isinstance(value, list) else [value]
        if not each or not all(isinstance(v, (str, int, float, bool)) for v in each):
            raise InputError(f"expected a value or a list of values for {name!r}", where=where)
        values.append(each)
    for chosen in itertools.product(*values):
        yield dict(zip(grid, chosen, strict=True))


def _train_options() -> tuple[str, ...]:
    from irradia.cli.train import command

    names = [flag.removeprefix("--") for p in command.params for flag in p.opts if flag.startswith("--")]
    return tuple(name for name in names if name not in _NOT_IN_A_GRID)


def _expect_keys(found: Mapping[str, Any], known: Sequence[str], where: str) -> None:
    for name in found:
        if name not in known:
            raise InputError(f"unknown key {name!r}", where=where, fix=did_you_mean(name, known))


def _expect_folder_names(runs: Sequence[SweepRun], where: str) -> None:
    for run in runs:  # a folder of that name may be emptied, so it must be the run's own
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]*", run.name):
            raise InputError(f"{run.name!r} can't be the name of a run's folder", where=where)


def _expect_different(runs: Sequence[SweepRun], where: str) -> None:
    seen: set[str] = set()
    for run in runs:
        if run.name.lower() in seen:  # file systems may not tell capitals apart
            raise InputError(f"two runs are called {run.name!r}", where=where, fix="Take one of them out.")
        seen.add(run.name.lower())
