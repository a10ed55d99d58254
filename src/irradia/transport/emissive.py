"""Light from emissive triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.scene.merge import MergedMesh
from irradia.transport.alias import AliasTable
from irradia.transport.backend import dr, mi


class EmissiveTriangles:
    """Area lights: points on triangles, uniformly; triangles picked by power, or by who asks.

    Args:
        mesh: The scene.
        radiance: (T, 3) mean emission over each triangle; sampling goes by the mean of its channels.

    Attributes:
        triangles: (N,) those that emit.
        power: (N,) mean radiance · area.
    """

    def __init__(self, mesh: MergedMesh, radiance: NDArray[np.float64]) -> None:
        corners = mesh.positions[mesh.indices].astype(np.float64)
        area = 0.5 * np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        power = area * radiance.mean(axis=1)
        self.triangles = np.flatnonzero(power > 0.0)
        self.power = power[self.triangles]
        self._alias = AliasTable(self.power)
        self._triangle = mi.UInt32(self.triangles.astype(np.uint32))
        self._density = _by_triangle(self.power / self.power.sum() / area[self.triangles], self, len(area))
        self._inverse_area = _by_triangle(1.0 / area[self.triangles], self, len(area))

    def density(self, triangle: mi.UInt32, active: mi.Bool) -> mi.Float:
        """Density per area with which :meth:`pick` and :meth:`place` give a point of this triangle."""
        return dr.gather(mi.Float, self._density, triangle, active)

    def inverse_area(self, triangle: mi.UInt32, active: mi.Bool) -> mi.Float:
        """Density per area of a point once its triangle is picked; 0 where that emits nothing."""
        return dr.gather(mi.Float, self._inverse_area, triangle, active)

    def pick(self, u: mi.Float, active: mi.Bool) -> tuple[mi.UInt32, mi.Float]:
        """A triangle by power, and what is left of the random number."""
        index, fresh = self._alias.sample(u, active)
        return dr.gather(mi.UInt32, self._triangle, index, active), fresh

    @staticmethod
    def place(u: mi.Point2f) -> mi.Point2f:
        """Barycentric coordinates of a uniform point."""
        root = dr.sqrt(u.x)
        return mi.Point2f(root * (1.0 - u.y), root * u.y)


def _by_triangle(values: NDArray[np.float64], emitters: EmissiveTriangles, n_triangles: int) -> mi.Float:
    """Values of the emitters, spread over all triangles of the mesh."""
    table = np.zeros(n_triangles, np.float32)
    table[emitters.triangles] = values
    return mi.Float(table)
