"""A court of modular blocks: faces that touch, lie in one plane, or coincide.

Where blocks adjoin, opposite faces coincide; floor tiles and wall tops make large coplanar
surfaces across objects; and three blocks stand twice in the very same place in two colours.
"""

from __future__ import annotations

from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.shapes import box
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera

SIDE_TILES, WALL_LAYERS, TILE_HEIGHT_M = 6, 2, 0.25

_COLOURS = {
    "sand": (0.62, 0.52, 0.38),
    "brick": (0.55, 0.20, 0.13),
    "moss": (0.25, 0.36, 0.16),
    "chalk": (0.80, 0.79, 0.75),
}


def build() -> GltfDocument:
    """Every block is a node of its own; tiles and blocks share a mesh for each colour."""
    scene = SceneBuilder("blocks")
    colours = {name: scene.material(matte(name, rgb)) for name, rgb in _COLOURS.items()}
    tile, block = box((0, 0, 0), (1, TILE_HEIGHT_M, 1)), box((0, 0, 0), (1, 1, 1))
    tiles = [scene.mesh(f"tile {name}", (tile, colours[name])) for name in ("sand", "chalk")]
    blocks = {name: scene.mesh(f"block {name}", (block, colour)) for name, colour in colours.items()}

    for x in range(SIDE_TILES):
        for z in range(SIDE_TILES):
            scene.node(f"tile {x} {z}", mesh=tiles[(x + z) % 2], translation=(x, -TILE_HEIGHT_M, z))
    for layer in range(WALL_LAYERS):
        for k in range(SIDE_TILES):
            name = ("brick", "chalk")[(k + layer) % 2]
            scene.node(f"back wall {layer} {k}", mesh=blocks[name], translation=(k, layer, -1))
            scene.node(f"side wall {layer} {k}", mesh=blocks[name], translation=(-1, layer, k))
    for k, (x, y, z) in enumerate([(2, 0, 2), (3, 0, 2), (3, 1, 2)]):
        scene.node(f"twin {k} moss", mesh=blocks["moss"], translation=(x, y, z))
        scene.node(f"twin {k} chalk", mesh=blocks["chalk"], translation=(x, y, z))
    scene.camera(Camera(look_at((8, 5, 9), (2, 0.5, 2)), yfov_rad=0.75, name="camera"))
    scene.sky(sun_elevation_deg=45, sun_azimuth_deg=120, turbidity=3, sun=True)
    return scene.build()
