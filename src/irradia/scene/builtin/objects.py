"""5,000 objects on a ground, and the very same triangles as one object: they should cost the same.

50 meshes stand 100 times each, every one a node of its own. All share one material, so that
nothing but the number of objects differs.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from irradia.core.rng import Seed
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Mesh, join, look_at
from irradia.scene.builtin.shapes import box, cone, cylinder, floor, sphere
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera

N_MESHES, NODES_PER_MESH, COLUMNS, SPACING_M = 50, 100, 100, 1.0


def build(name: str, merged: bool) -> GltfDocument:
    """The field of objects; ``merged`` writes it, ground included, as one primitive."""
    scene = SceneBuilder(name)
    material = scene.material(matte("clay", (0.6, 0.55, 0.5)))
    meshes = [_thing(k, Seed(1).child(f"thing-{k}").numpy()) for k in range(N_MESHES)]
    ground = floor(104, 54, n_x=26, n_z=13)
    if merged:
        placed = [meshes[k].turned(yaw).moved(x, 0, z) for k, x, z, yaw in _placements()]
        scene.object("everything", (join(ground, *placed), material))
    else:
        scene.object("ground", (ground, material))
        indices = [scene.mesh(f"thing {k}", (mesh, material)) for k, mesh in enumerate(meshes)]
        for number, (k, x, z, yaw) in enumerate(_placements()):
            scene.node(f"object {number}", mesh=indices[k], translation=(x, 0, z), yaw_deg=yaw)
    scene.camera(Camera(look_at((0, 9, 36), (0, 0, 8)), yfov_rad=0.8, name="camera"))
    scene.sky(sun_elevation_deg=40, sun_azimuth_deg=140, turbidity=3, sun=True)
    return scene.build()


def _placements() -> Iterator[tuple[int, float, float, float]]:
    """Mesh, x, z and yaw of each object."""
    rng = Seed(1).child("placements").numpy()
    order = rng.permutation(np.repeat(np.arange(N_MESHES), NODES_PER_MESH))
    rows = len(order) // COLUMNS
    for number, mesh in enumerate(order):
        row, column = divmod(number, COLUMNS)
        dx, dz, turn = rng.uniform(-0.15, 0.15), rng.uniform(-0.15, 0.15), rng.uniform(0, 360)
        x, z = SPACING_M * (column - COLUMNS / 2 + 0.5), SPACING_M * (row - rows / 2 + 0.5)
        yield int(mesh), x + dx, z + dz, turn


def _thing(k: int, rng: np.random.Generator) -> Mesh:
    """One of the 50 shapes, under a metre in size, its foot just over the ground."""
    height, radius, gap = rng.uniform(0.2, 0.9), rng.uniform(0.12, 0.3), 0.01
    n_sides = int(rng.integers(6, 13))
    match k % 4:
        case 0:
            return box((-radius, gap, -radius * 0.8), (radius, gap + height, radius * 0.8))
        case 1:
            return cylinder(radius, height, n_sides).moved(y=gap)
        case 2:
            return cone(radius, height, n_sides).moved(y=gap)
        case _:
            return sphere(radius, n_sides, n_sides // 2).moved(y=gap + radius)
