"""Light from emissive triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.scene.merge import MergedMesh
from irradia.transport.alias import AliasTable
from irradia.transport.backend import dr, mi


class EmissiveTriangles:
    """Area lights: triangles picked by power, points on them uniformly."""

    def __init__(self, mesh: MergedMesh, radiance: NDArray[np.float64]) -> None:
        corners = mesh.positions[mesh.indices].astype(np.float64)
        area = 0.5 * np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        power = area * (radiance @ np.array(LUMINANCE_WEIGHTS))
        chosen = np.flatnonzero(power > 0.0)
        self._alias = AliasTable(power[chosen])
        self._triangle = mi.UInt32(chosen.astype(np.uint32))
        density = np.zeros(len(area), np.float32)
        density[chosen] = power[chosen] / power.sum() / area[chosen]
        self._density = mi.Float(density)

    def density(self, triangle: mi.UInt32, active: mi.Bool) -> mi.Float:
        """Density per area of picking a point of this triangle."""
        return dr.gather(mi.Float, self._density, triangle, active)

    def sample(self, u: mi.Point2f, active: mi.Bool) -> tuple[mi.UInt32, mi.Point2f, mi.Float]:
        """A triangle, a point on it and its density per area."""
        index, fresh = self._alias.sample(u.x, active)
        triangle = dr.gather(mi.UInt32, self._triangle, index, active)
        root = dr.sqrt(fresh)
        bary = mi.Point2f(root * (1.0 - u.y), root * u.y)
        return triangle, bary, self.density(triangle, active)
