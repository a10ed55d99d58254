"""What a stopped training needs to go on, in one file.

An uncompressed ``.npz``: its CRCs find damage, and nothing in it is pickled. Going on from a checkpoint
gives the same bytes as never having stopped.
"""

from __future__ import annotations

import json
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.field.backend import Parameters, TrainState
from irradia.field.checks import check_parameters
from irradia.field.spec import FieldSpec

VERSION = 1
_GROWS = ("rows", "sha256")
_GROUPS = ("parameters", "average", "first", "second")
# What reading a file of nonsense may raise: lengths beyond memory and unknown kinds of packing among it.
_DAMAGE = (
    *(ValueError, KeyError, TypeError, AttributeError, EOFError, MemoryError, NotImplementedError),
    *(zipfile.BadZipFile, zlib.error),
)


@dataclass(frozen=True)
class Course:
    """Where a training stands, apart from the weights.

    Attributes:
        spent_s: Seconds of training.
        rate_factor: What setbacks have left of the learning rates.
        n_setbacks: So many have there been.
        best_relmse: Of all validations.
        n_worse: Validations since that one.
        losses: Of the last steps.
    """

    spent_s: float = 0.0
    rate_factor: float = 1.0
    n_setbacks: int = 0
    best_relmse: float = float("inf")
    n_worse: int = 0
    losses: tuple[float, ...] = ()


@dataclass(frozen=True)
class Checkpoint:
    """A training between two steps.

    Attributes:
        state: Weights, moments and means.
        course: The rest.
        best: Parameters for inference at the best validation; empty where training never ends early.
        identity: Spec, options and data, as plain values; must be the same for it to go on.
        scale: Of the frame, which a growing dataset would give anew.
    """

    state: TrainState
    course: Course
    best: Parameters
    identity: dict[str, Any]
    scale: float


def save_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Writes one, whole or not at all.

    Raises:
        OSError: It can't be written.
    """
    header = {
        "version": VERSION,
        "step": checkpoint.state.step,
        "course": asdict(checkpoint.course),
        "identity": checkpoint.identity,
        "scale": checkpoint.scale,
    }
    arrays = {
        f"{group}/{name}": array
        for group in _GROUPS
        for name, array in getattr(checkpoint.state, group).items()
    }
    arrays |= {f"best/{name}": array for name, array in checkpoint.best.items()}
    text = np.frombuffer(json.dumps(header).encode(), np.uint8)
    with write_atomic(path) as stream:
        np.savez(stream, header=text, allow_pickle=False, **arrays)


def load_checkpoint(path: Path) -> Checkpoint:
    """Reads one.

    Raises:
        InputError: It is absent, damaged, or of another version.
    """
    with _opened(path) as stored:
        header = _header(stored, path)
        arrays = {name: stored[name] for name in stored.files if name != "header"}
        state = TrainState(*(_group(arrays, group) for group in _GROUPS), step=header["step"])
        course = Course(**{**header["course"], "losses": tuple(header["course"]["losses"])})
        return Checkpoint(state, course, _group(arrays, "best"), header["identity"], header["scale"])


def read_step(path: Path) -> int:
    """After how many steps a checkpoint was taken; see :func:`load_checkpoint`."""
    with _opened(path) as stored:
        return _header(stored, path)["step"]


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """An archive whose defects become the user's to know."""
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
            yield stored
    except FileNotFoundError as error:
        raise InputError(
            "there is no stopped training here", where=str(path), fix="Train without --resume."
        ) from error
    except _DAMAGE as error:
        raise _damaged(path, str(error)) from error


def _damaged(path: Path | str, how: str) -> InputError:
    return InputError(f"this checkpoint is damaged: {how}", where=str(path), fix="Train without --resume.")


def _header(stored: Any, path: Path) -> dict[str, Any]:
    header = json.loads(stored["header"].tobytes())
    if header["version"] != VERSION:
        raise InputError(f"expected version {VERSION}, found {header['version']}", where=str(path))
    return header


def check_same(checkpoint: Checkpoint, identity: dict[str, Any], where: Path | str) -> None:
    """Refuses to go on with another training.

    Raises:
        InputError: Names what differs.
    """
    before, now = _flat(checkpoint.identity), _flat(json.loads(json.dumps(identity)))
    differ = sorted(
        name
        for name in before.keys() | now.keys()
        if before.get(name) != now.get(name) and not _may_grow(name, before)
    )
    if differ:
        name = differ[0]
        raise InputError(
            f"the stopped training has another {name}: {before.get(name)}, now {now.get(name)}",
            where=str(where),
            fix="Give the same options and samples, or train without --resume.",
        )


def check_state(checkpoint: Checkpoint, spec: FieldSpec, where: Path | str, *, averaged: bool) -> None:
    """Refuses arrays that are not a training's of this spec: compiled steps take their shapes on trust.

    Raises:
        InputError: One is missing, of another shape, or has values that are no numbers.
    """
    state = checkpoint.state
    groups = [state.parameters, state.first, state.second]
    groups += [state.average] if averaged else []
    groups += [checkpoint.best] if checkpoint.best else []
    for group in groups:
        try:
            check_parameters(spec, group)
        except InputError as error:
            raise _damaged(where, str(error)) from error


def _group(arrays: dict[str, Any], group: str) -> Parameters:
    prefix = f"{group}/"
    return {name.removeprefix(prefix): array for name, array in arrays.items() if name.startswith(prefix)}


def _may_grow(name: str, before: dict[str, Any]) -> bool:
    """Whether something tells how far a dataset had grown; what has come since is welcome."""
    dataset, _, what = name.rpartition(".")
    return what in _GROWS and before.get(f"{dataset}.rows") is None


def _flat(value: Any, path: str = "") -> dict[str, Any]:
    """Leaves by dotted name."""
    if not isinstance(value, dict):
        return {path: value}
    return {
        name: leaf
        for key, each in value.items()
        for name, leaf in _flat(each, f"{path}.{key}" if path else key).items()
    }
