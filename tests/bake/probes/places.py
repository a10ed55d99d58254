"""Scenes and probes for the tests of probes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irradia.formats.probes import VALID, ProbeGrid, ProbeSet
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Mesh, join
from irradia.scene.builtin.shapes import box, centred_box
from irradia.scene.environment import environment_from_color
from irradia.scene.gltf import document_to_scene
from irradia.scene.types import Light, Rgb, Scene


def scene_of(
    *meshes: Mesh, reflectance: float = 0.6, lights: tuple[Light, ...] = (), sky: Rgb | None = None
) -> Scene:
    """Grey surfaces under the given light."""
    builder = SceneBuilder("made")
    grey = builder.material(matte("grey", (reflectance,) * 3))
    for number, mesh in enumerate(meshes):
        builder.object(f"part {number}", (mesh, grey))
    scene = document_to_scene(builder.build())
    environment = None if sky is None else environment_from_color(sky)
    return replace(scene, lights=lights, environment=environment)


WALL_M = 0.06


def two_rooms() -> Scene:
    """Rooms of 2 × 2 × 2 m on either side of a thin wall at x = 0; a lamp hangs in that at −x."""
    half = WALL_M / 2
    left = box((-2 - half, 0, -1), (-half, 2, 1)).inside_out()
    right = box((half, 0, -1), (2 + half, 2, 1)).inside_out()
    lamp = Light("point", (10.0, 10.0, 10.0), position=(-1.2, 1.5, 0.1))
    return scene_of(join(left, right), lights=(lamp,))


def thick_block() -> Scene:
    """A cube of 2 m, solid, under an even sky."""
    return scene_of(centred_box((2, 2, 2)), sky=(1.0, 1.0, 1.0))


def blank_probes(positions: np.ndarray, **fields: object) -> ProbeSet:
    """Probes that see 10 m in every direction and hold no light."""
    n = len(positions)
    distance = np.zeros((n, 8, 8, 2), np.float32)
    distance[..., 0] = 10.0
    plain = ProbeSet(
        positions=np.asarray(positions, np.float32),
        offsets=np.zeros((n, 3), np.float32),
        coefficients=np.zeros((n, 9, 3), np.float32),
        validity=np.ones(n, np.float32),
        state=np.full(n, VALID, np.uint8),
        sky=np.zeros((n, 4), np.float32),
        distance=distance,
        reach=np.full(n, 10.0, np.float32),
    )
    return replace(plain, **fields)  # type: ignore[arg-type]


def unit_grid(shape: tuple[int, int, int]) -> tuple[ProbeGrid, np.ndarray]:
    """A grid with spacing 1 from the origin, and its positions in order."""
    nx, ny, nz = shape
    grid = ProbeGrid(np.zeros(3, np.float32), np.ones(3, np.float32), shape)
    positions = [(x, y, z) for z in range(nz) for y in range(ny) for x in range(nx)]
    return grid, np.array(positions, np.float32)
