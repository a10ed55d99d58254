"""Four closed boxes under a bright sky, each closed in another way: black inside, all of them.

They float above a ground, so that light comes at their joints from below too.
"""

from __future__ import annotations

import numpy as np

from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Mesh, join, look_at
from irradia.scene.builtin.shapes import box, centred_box, floor
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera

INNER_M, WALL_M, CENTRE_Y_M = 2.0, 0.2, 1.75

CENTRES_X_M = {"shell": -6.0, "touching": -2.0, "overlapping": 2.0, "edges-only": 6.0}
"""Where each box stands along x, at z = 0 and CENTRE_Y_M; its inside is a cube of INNER_M."""


def build() -> GltfDocument:
    """One node a box; its name is the key of CENTRES_X_M."""
    scene = SceneBuilder("leaks")
    grey = scene.material(matte("ground", (0.6, 0.6, 0.6)))
    white = scene.material(matte("white", (0.8, 0.8, 0.8)))
    scene.object("ground", (floor(24, 16, n_x=6, n_z=4), grey))
    boxes = {
        "shell": centred_box((INNER_M,) * 3).inside_out(),
        "touching": _touching(),
        "overlapping": _overlapping(),
        "edges-only": _meeting_at_edges(),
    }
    for name, mesh in boxes.items():
        scene.node(name, mesh=scene.mesh(name, (mesh, white)), translation=(CENTRES_X_M[name], CENTRE_Y_M, 0))
    scene.camera(Camera(look_at((0, 6, 14), (0, 1, 0)), yfov_rad=0.8, name="camera"))
    scene.sky(sun_elevation_deg=50, sun_azimuth_deg=30, turbidity=3, sun=True)
    return scene.build()


def _touching() -> Mesh:
    """Floor and roof over the full width, two walls between them, two between those: faces touch."""
    inner, outer = INNER_M / 2, INNER_M / 2 + WALL_M
    return _slabs((outer, outer), (outer, inner), (inner, inner))


def _overlapping() -> Mesh:
    """Every slab runs through its neighbours and ends beyond them, no two faces in one plane."""
    outer = INNER_M / 2 + WALL_M
    return _slabs((outer + 0.10, outer + 0.15), (outer + 0.20, outer + 0.25), (outer + 0.30, outer + 0.35))


def _meeting_at_edges() -> Mesh:
    """Every slab is just as large as the inside: neighbours share an edge and nothing else."""
    inner = INNER_M / 2
    return _slabs((inner, inner), (inner, inner), (inner, inner))


def _slabs(*half_sizes: tuple[float, float]) -> Mesh:
    """Pairs of slabs against ±y, ±x and ±z of the inner cube; half sizes along the next two axes."""
    slabs = []
    for axis, (half_a, half_b) in zip((1, 0, 2), half_sizes, strict=True):
        low, high = np.zeros(3), np.zeros(3)
        low[axis], high[axis] = INNER_M / 2, INNER_M / 2 + WALL_M
        first, second = [(0, 2), (2, 1), (0, 1)][(1, 0, 2).index(axis)]
        low[first], high[first] = -half_a, half_a
        low[second], high[second] = -half_b, half_b
        flip = np.ones(3)
        flip[axis] = -1
        slabs += [
            box(low, high),
            box(np.minimum(low * flip, high * flip), np.maximum(low * flip, high * flip)),
        ]
    return join(*slabs)
