"""Parameters as files name them: encodings in their parts, such as ``position.level.0``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import prod

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.field.backend import Parameters
from irradia.field.spec import FieldSpec

F32 = NDArray[np.float32]


def tensor_shapes(spec: FieldSpec) -> dict[str, tuple[int, ...]]:
    """Every tensor of a field's file by name."""
    return {name: shape for _, name, shape in _parts(spec)}


def encoding_tensors(spec: FieldSpec) -> list[str]:
    """Names of the tensors that belong to encodings, which are what quantisation is for."""
    return [name for owner, name, _ in _parts(spec) if owner in ("position", "direction")]


def to_tensors(spec: FieldSpec, parameters: Parameters) -> dict[str, F32]:
    """Views of the parameters, by tensor."""
    found: dict[str, F32] = {}
    first: dict[str, int] = {}
    for owner, name, shape in _parts(spec):
        start = first.get(owner, 0)
        first[owner] = start + prod(shape)
        found[name] = parameters[owner].reshape(-1)[start : first[owner]].reshape(shape)
    return found


def from_tensors(spec: FieldSpec, tensors: Mapping[str, F32]) -> Parameters:
    """The parameters as a field wants them, copied."""
    pieces: dict[str, list[F32]] = {}
    for owner, name, _ in _parts(spec):
        pieces.setdefault(owner, []).append(np.asarray(tensors[name], np.float32).reshape(-1))
    shapes = spec.parameter_shapes()
    return {owner: np.concatenate(parts).reshape(shapes[owner]) for owner, parts in pieces.items()}


def to_halves(values: NDArray[np.float32], name: str) -> NDArray[np.float16]:
    """Rounded to half floats.

    Raises:
        InputError: One is too large for that.
    """
    with np.errstate(over="ignore"):
        halves = values.astype(np.float16)
    if not np.isfinite(halves).all():
        raise InputError(
            f"{np.abs(values).max():.3g} in {name} is more than a half float holds",
            fix="Save with 32 bits.",
        )
    return halves


def _parts(spec: FieldSpec) -> Iterator[tuple[str, str, tuple[int, ...]]]:
    """Name among the parameters, name among the tensors, and shape; in order."""
    encodings = {"position": spec.position, "direction": spec.direction}
    for owner, shape in spec.parameter_shapes().items():
        encoding = encodings.get(owner)
        if encoding is None:
            yield owner, owner, shape
            continue
        for slot in encoding.tensors():
            yield owner, f"{owner}.{slot.name}", slot.shape
