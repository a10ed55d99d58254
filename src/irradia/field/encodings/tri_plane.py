"""Three learned images along the box's axes, after Chan et al. 2022 (EG3D).

Ours differs: the features of the planes are concatenated instead of added, so the perceptron can tell them
apart, and so does the Unity project's.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.field.encoding import Array, Encoding, TensorSlot

PLANES = ((0, 1), (0, 2), (1, 2))  # xy, xz, yz: the axes of column and row


@dataclass(frozen=True)
class TriPlane(Encoding):
    """Bilinear lookups in the planes xy, xz and yz, in this order.

    Texels lie in memory as (plane, row, column, feature); in xy, x runs along columns and y along rows. Their
    centres are at (i + ½) / resolution and edges are clamped, as any texture unit filters them.

    Attributes:
        resolution: Texels along each side of a plane.
        n_features: Of each plane.
        align_corners: Centres are at i / (resolution − 1) instead, so that the outermost lie on the box's
            faces; PyTorch ports differ in this.
    """

    name: ClassVar[str] = "triplane"

    resolution: int = 128
    n_features: int = 16
    align_corners: bool = False

    def __post_init__(self) -> None:
        if not (2 <= self.resolution <= 8192 and 1 <= self.n_features <= 128):
            found = f"{self.resolution} and {self.n_features}"
            raise InputError(f"expected a resolution of 2–8192 and 1–128 features a plane, found {found}")

    @property
    def n_outputs(self) -> int:
        """Of xy, then xz, then yz."""
        return len(PLANES) * self.n_features

    @property
    def texel_from_unit(self) -> tuple[np.float32, np.float32]:
        """Scale and offset: texel coordinates, whole at centres, are ``scale * x + offset``."""
        if self.align_corners:
            return np.float32(self.resolution - 1), np.float32(0.0)
        return np.float32(self.resolution), np.float32(-0.5)

    def tensors(self) -> tuple[TensorSlot, ...]:
        """The planes (3, rows, columns, features)."""
        return (TensorSlot("planes", (len(PLANES), self.resolution, self.resolution, self.n_features)),)

    def init(self, rng: np.random.Generator) -> NDArray[np.float32]:
        """Uniform in ±0.01, which of 1e-4 to 1 learnt hard shadows best; 1 ended with 2.5 times the error."""
        return rng.uniform(-0.01, 0.01, self.n_parameters).astype(np.float32)

    def forward(self, x: Array, parameters: Array) -> Array:
        """Interpolated features (N, 3 · features)."""
        texels = parameters.reshape(-1, self.n_features)
        features = np.zeros((len(x), len(PLANES), self.n_features), parameters.dtype)
        for plane, texel, weight in self._corners(x):
            features[:, plane] += weight[:, None].astype(parameters.dtype) * texels[texel]
        return features.reshape(len(x), self.n_outputs)

    def backward(self, x: Array, parameters: Array, gradient: Array) -> Array:
        """Spreads each plane's gradient over the four texels of a lookup."""
        texels = np.zeros_like(parameters).reshape(-1, self.n_features)
        of_planes = gradient.reshape(len(x), len(PLANES), self.n_features)
        for plane, texel, weight in self._corners(x):
            np.add.at(texels, texel, weight[:, None].astype(parameters.dtype) * of_planes[:, plane])
        return texels.ravel()

    def _corners(self, x: Array) -> Iterator[tuple[int, NDArray[np.int64], Array]]:
        """Plane, (N,) texel in the flat array and (N,) weight of each texel that a point sees.

        Positions are rounded to float32 as kernels do, also where all else is double.
        """
        scale, offset = self.texel_from_unit
        last = np.float32(self.resolution - 1)
        position = np.clip(scale * x.astype(np.float32) + offset, np.float32(0.0), last)
        cell = np.minimum(np.floor(position), last - 1)  # the last texel is the end of the last cell
        fraction = (position - cell).astype(np.float64)
        cell = cell.astype(np.int64)
        for plane, (across, down) in enumerate(PLANES):
            for row in (0, 1):
                for column in (0, 1):
                    u = fraction[:, across] if column else 1.0 - fraction[:, across]
                    v = fraction[:, down] if row else 1.0 - fraction[:, down]
                    texel = (plane * self.resolution + cell[:, down] + row) * self.resolution
                    yield plane, texel + cell[:, across] + column, u * v
