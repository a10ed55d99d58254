"""Whether points see each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.scene.merge import MergedMesh
from irradia.transport.backend import dr, mi
from irradia.transport.geometry import Geometry
from irradia.transport.receivers import columns

F32 = NDArray[np.float32]


class Between:
    """Asks what stands between points of a scene; every surface is taken for opaque."""

    def __init__(self, mesh: MergedMesh) -> None:
        self._geometry = Geometry(mesh)

    def __call__(self, start: F32, end: F32) -> NDArray[np.bool_]:
        """(N,) whether nothing lies between the points of each pair (N, 3), in metres."""
        if not len(start):
            return np.ones(0, np.bool_)
        origin, way = mi.Point3f(*columns(start)), mi.Vector3f(*columns(end - start))
        distance = dr.norm(way)
        apart = distance > 0.0
        direction = way / dr.select(apart, distance, 1.0)
        return ~np.array(self._geometry.occluded(origin, direction, distance, apart))
