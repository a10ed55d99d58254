"""Our showcase: a colonnaded court of two storeys, open to a clear sky, with a stair hall at its end.

The sun stands in the south-south-east. It falls on the court's floor, on cloth and into the
northern arcade, through stained glass onto the southern gallery and the stairs.
"""

from __future__ import annotations

import math

from irradia.scene.builtin.atrium.arcades import add_arcades
from irradia.scene.builtin.atrium.cloth import add_cloth
from irradia.scene.builtin.atrium.columns import add_columns
from irradia.scene.builtin.atrium.furnishing import add_furnishing
from irradia.scene.builtin.atrium.galleries import add_galleries
from irradia.scene.builtin.atrium.materials import add_materials
from irradia.scene.builtin.atrium.ornament import add_ornament
from irradia.scene.builtin.atrium.stairs import add_stairs
from irradia.scene.builtin.atrium.vaults import add_vaults
from irradia.scene.builtin.atrium.walls import add_walls
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.mesh import look_at
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera, Light

SUN_ELEVATION_DEG, SUN_AZIMUTH_DEG, TURBIDITY = 60.0, 150.0, 2.5
SUN_LUX = (116690.0, 96100.0, 74080.0)
"""What the sky of that turbidity lets through: the sun of ``scene.sky`` at this elevation."""


def build() -> GltfDocument:
    """About 175,000 triangles in some 300 nodes; repeated parts share meshes."""
    scene = SceneBuilder("atrium")
    materials = add_materials(scene)
    for add in (
        add_galleries,
        add_columns,
        add_arcades,
        add_vaults,
        add_walls,
        add_ornament,
        add_stairs,
        add_cloth,
        add_furnishing,
    ):
        add(scene, materials)
    _add_sun(scene)
    _add_cameras(scene)
    return scene.build()


def _add_sun(scene: SceneBuilder) -> None:
    elevation, azimuth = math.radians(SUN_ELEVATION_DEG), math.radians(SUN_AZIMUTH_DEG)
    level = math.cos(elevation)
    direction = (-math.sin(azimuth) * level, -math.sin(elevation), math.cos(azimuth) * level)
    scene.light(Light("directional", SUN_LUX, direction=direction, angle_deg=0.53, name="sun"))
    scene.sky(
        sun_elevation_deg=SUN_ELEVATION_DEG, sun_azimuth_deg=SUN_AZIMUTH_DEG, turbidity=TURBIDITY, sun=False
    )


def _add_cameras(scene: SceneBuilder) -> None:
    views = {
        "court": ((-10.35, 1.7, 2.6), (3.0, 3.75, -1.2), 60),
        "gallery": ((-10.9, 6.95, -6.0), (4.0, 5.6, -3.4), 60),
        "stairs": ((2.2, 2.2, -2.0), (13.0, 4.4, 0.6), 60),
        "arcade": ((9.6, 1.75, -7.4), (-6.0, 1.9, -5.4), 60),
    }
    for name, (eye, target, yfov_deg) in views.items():
        scene.camera(Camera(look_at(eye, target), math.radians(yfov_deg), name=name))
