"""How far points are from the nearest surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.bake.parallel import kernel_threads
from irradia.scene.merge import LEVEL_BITS, MergedMesh


class NearestSurface:
    """The surfaces of a scene, finest levels of detail only, ready to be asked. Exact.

    Args:
        mesh: The merged mesh, with at least one triangle.
    """

    def __init__(self, mesh: MergedMesh) -> None:
        from irradia.bake.datasets.nearest_kernels import build

        finest = np.arange(len(mesh.indices))
        if mesh.lod is not None:
            finest = finest[(mesh.lod & ((1 << LEVEL_BITS) - 1)) == 0]
        self._numbers = finest
        self._corners = mesh.positions[mesh.indices[finest]].astype(np.float64)
        self._tree = build(self._corners)

    def distance_m(self, positions: NDArray[np.floating]) -> NDArray[np.float64]:
        """(N,) metres from positions (N, 3)."""
        return np.sqrt(self._ask(positions)[0])

    def triangle(self, positions: NDArray[np.floating]) -> NDArray[np.int64]:
        """(N,) the nearest triangle of the mesh; of several, any."""
        return self._numbers[self._ask(positions)[1]]

    def _ask(self, positions: NDArray[np.floating]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        from irradia.bake.datasets.nearest_kernels import nearest

        with kernel_threads():
            return nearest(np.ascontiguousarray(positions, np.float64), self._corners, *self._tree)
