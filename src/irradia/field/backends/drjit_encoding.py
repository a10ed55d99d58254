"""What the Dr.Jit backend asks of an encoding's fast version.

A kernel has a thread for every sample and *block* of features, such as a level's; neighbouring threads are
neighbouring samples of one block. See drjit_tiles.py for the layout of what it writes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Any, Generic, TypeVar

import drjit as dr

from irradia.field.backends.drjit_catalogue import ACCELERATED, parts
from irradia.field.backends.drjit_tiles import TILE, F, Points, Shape, U, address, write
from irradia.field.encoding import Encoding
from irradia.field.spec import FieldSpec

E = TypeVar("E", bound=Encoding)
Constants = dict[str, Any]


@dataclass
class Lookup:
    """What a thread of an encoding's kernel works on.

    Attributes:
        points: Of all samples.
        sample: Its own.
        block: Its block of features.
        in_cube: Whether points are normals to be brought into [0, 1]³.
        constants: The encoding's.
    """

    points: Points
    sample: U
    block: U
    in_cube: bool
    constants: Constants

    def coordinate(self, axis: U | int) -> F:
        """One coordinate of the sample, in the encoding's domain."""
        return self.points.at(self.sample, axis, self.in_cube)


class DrJitEncoding(ABC, Generic[E]):
    """The fast version of one encoding that is no composition.

    Attributes:
        encoding: The definition that values and gradients must agree with.
        jit: Array types.
        first: Of its parameters, in the array that it has a part of.
        n_blocks: Threads of a sample.
        block_size: Features of a thread; block b has those from ``b * block_size`` on.
    """

    n_blocks: int = 1
    block_size: int = 1

    def __init__(self, encoding: E, jit: ModuleType, first: int) -> None:
        self.encoding, self.jit, self.first = encoding, jit, first

    def constants(self) -> Constants:
        """Arrays that kernels read. They come back in :class:`Lookup`, as a recorded step needs them."""
        return {}

    @abstractmethod
    def features(self, at: Lookup, parameters: F) -> list[F]:
        """A block's features of a sample."""

    def scatter(self, at: Lookup, gradients: list[F], scale: F, target: Any) -> None:
        """Adds to the gradients of parameters, if there are any.

        Args:
            at: As in :meth:`features`.
            gradients: Of the loss with respect to the block's features.
            scale: Of fixed point; see drjit_fixed_point.py.
            target: UInt64 (P,), changed.
        """
        del at, gradients, scale, target


@dataclass(frozen=True)
class Placed:
    """An encoding's part and where its features stand.

    Attributes:
        name: The parameters that it has a part of: ``position`` or ``direction``.
        fast: Its kernels.
        row: Of its first feature.
        in_cube: As in :class:`Lookup`.
    """

    name: str
    fast: DrJitEncoding[Any]
    row: int
    in_cube: bool

    def encode(
        self, features: F, n_rows: int, points: Points, parameters: F, shape: Shape, consts: Constants
    ) -> None:
        """Writes its rows of features (n_tiles, n_rows, 512)."""
        at = self._lookup(dr.width(features) // n_rows, points, shape, consts)
        place = self._place(at, n_rows)
        for i, value in enumerate(self.fast.features(at, parameters)):
            write(features, value, place + i * TILE)

    def learn(
        self,
        gradients: F,
        n_rows: int,
        points: Points,
        scale: F,
        target: Any,
        shape: Shape,
        consts: Constants,
    ) -> None:
        """Adds what gradients (n_tiles, n_rows, 512) of features mean for parameters."""
        at = self._lookup(dr.width(gradients) // n_rows, points, shape, consts)
        place = self._place(at, n_rows)
        own = [dr.gather(type(gradients), gradients, place + i * TILE) for i in range(self.fast.block_size)]
        self.fast.scatter(at, own, scale, target)

    def _lookup(self, n_padded: int, points: Points, shape: Shape, consts: Constants) -> Lookup:
        thread = dr.arange(self.fast.jit.UInt, n_padded * self.fast.n_blocks)
        block = thread // shape.n_padded
        return Lookup(points, thread - block * shape.n_padded, block, self.in_cube, consts)

    def _place(self, at: Lookup, n_rows: int) -> U:
        return address(at.sample, self.row + at.block * self.fast.block_size, n_rows)


def place_all(spec: FieldSpec, jit: ModuleType) -> list[Placed]:
    """The parts of a spec's encodings, made ready."""
    placed: list[Placed] = []
    for name, encoding, row in (
        ("position", spec.position, 0),
        ("direction", spec.direction, spec.position.n_outputs),
    ):
        if encoding is None:
            continue
        in_cube = name == "direction" and encoding.domain == "cube"
        for part in parts(encoding, row=row):
            module, _, kind = ACCELERATED[part.encoding.name].partition(":")
            made = getattr(import_module(f"irradia.field.backends.{module}"), kind)
            placed.append(Placed(name, made(part.encoding, jit, part.first), part.row, in_cube))
    return placed
