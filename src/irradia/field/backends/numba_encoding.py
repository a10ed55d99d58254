"""What the Numba backend asks of an encoding's fast version, and which encodings have one.

Everything a kernel meets is feature-major, so that eight samples fill a vector register:

- A batch is cut into tiles of 256 samples; the last is filled up with copies of the batch's last sample,
  whose gradient is exactly 0.
- *Points* are (3, n_tiles · 256) float32, one row per coordinate.
- *Features*, and later their gradients in the same memory, are (n_tiles, rows, 272) float32: sample s of a
  tile stands in column s, columns from 256 on mean nothing. The 16 of them keep the stride from being a
  power of two, at which rows of a tile would fall on each other in the cache.

Kernels run on a :class:`~irradia.field.backends.numba_team.Team`: each is called once per thread and takes
tasks until none are left. What a task computes must not depend on who takes it or when, and no two tasks
may add into the same memory, so one thread and many give the same bits.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from irradia.field.encoding import Encoding

if TYPE_CHECKING:
    from irradia.field.backends.numba_adam import Adam, Learned
    from irradia.field.backends.numba_team import Team

F32 = NDArray[np.float32]
TILE = 256  # samples
STRIDE = TILE + 16  # floats from one row of a tile to the next

# Fast versions by the encoding's name: module beside this one, and class.
ACCELERATED: dict[str, str] = {
    "hash": "numba_hash_grid:NumbaHashGrid",
    "triplane": "numba_tri_plane:NumbaTriPlane",
    "frequency": "numba_frequency:NumbaFrequency",
    "one_blob": "numba_one_blob:NumbaOneBlob",
    "sh": "numba_spherical_harmonics:NumbaSphericalHarmonics",
    "identity": "numba_identity:NumbaIdentity",
    "composite": "numba_composite:NumbaComposite",
}

E = TypeVar("E", bound=Encoding)


class NumbaEncoding(ABC, Generic[E]):
    """The fast version of one encoding, made for one evaluator or training; it may keep scratch memory.

    Attributes:
        encoding: The definition that values and gradients must agree with.
        team: The threads that kernels run on.
    """

    def __init__(self, encoding: E, team: Team) -> None:
        self.encoding = encoding
        self.team = team

    @abstractmethod
    def forward(self, points: F32, parameters: F32, features: F32, row: int) -> None:
        """Writes rows ``row`` to ``row + n_outputs`` of every tile's features.

        Args:
            points: (3, n_tiles · 256), already in the encoding's domain.
            parameters: (P,), flat as the encoding defines; empty where it has none.
            features: (n_tiles, rows, 272), written.
            row: The first row that belongs to this encoding.
        """

    def learn(self, points: F32, gradients: F32, row: int, learned: Learned, adam: Adam) -> None:
        """Takes one step of Adam along the gradient of the parameters. Nothing to do without parameters.

        Scatter the gradient of one part of the parameters, such as a level, into scratch memory, then hand
        that to :func:`irradia.field.backends.numba_adam.adam_sweep`, which zeroes it for the next part.

        Args:
            points: As for :meth:`forward`.
            gradients: (n_tiles, rows, 272), of the loss with respect to the features.
            row: The first row that belongs to this encoding.
            learned: Its parameters, moments and running mean, (P,) each, changed in place.
            adam: Of this step.
        """
        del points, gradients, row, learned, adam


def lacks_acceleration(encoding: Encoding) -> str | None:
    """The first encoding, parts of compositions included, without a fast version, in words; else None."""
    if encoding.name not in ACCELERATED:
        return f"the encoding {encoding.name}"
    for part in getattr(encoding, "parts", ()):
        if missing := lacks_acceleration(part):
            return missing
    return None


def accelerate(encoding: Encoding, team: Team) -> NumbaEncoding[Any]:
    """The fast version of an encoding, on these threads."""
    module, _, name = ACCELERATED[encoding.name].partition(":")
    return getattr(import_module(f"irradia.field.backends.{module}"), name)(encoding, team)
