"""A valley with a lake: a heightfield of over a million triangles, rocks and conifers on it.

One mesh of 768 × 768 cells of half a metre. It is what lightmap UVs, the tree of triangles and the
texel list have to get through in seconds, and it shows what a sun does to relief.
"""

from __future__ import annotations

import numpy as np

from irradia.core.rng import Seed
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Array, Mesh, grid, join, look_at
from irradia.scene.builtin.noise import cloud
from irradia.scene.builtin.shapes import cone, cylinder, floor, sphere
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import U8, Camera, Material

CELLS, SIZE_M = 768, 384.0
CELL_M = SIZE_M / CELLS
WATER_M = 4.0
RELIEF_M = 60.0
N_ROCK_SHAPES, N_ROCKS = 4, 180
N_TREE_SHAPES, N_TREES = 3, 420
_CREST = 0.25  # how round ridges are; at 0 they are knives
_STEEPEST_TREE, _STEEPEST_ROCK = 0.45, 0.9  # metres up per metre along


def build() -> GltfDocument:
    """The ground with its painted map, the lake, and what stands around it."""
    scene = SceneBuilder("terrain")
    height = heights()
    painted = scene.texture("ground", ground_texture(height))
    ground = scene.material(
        Material("ground", base_color_texture=painted, metallic=0.0, specular=0.0), tile_m=SIZE_M
    )
    scene.object("ground", (_ground(height), ground))
    water = scene.material(matte("water", (0.05, 0.10, 0.11)), tile_m=SIZE_M)
    scene.object("lake", (floor(SIZE_M, SIZE_M, WATER_M, n_x=8, n_z=8), water), lightmap_scale=0.25)
    _scatter_rocks(scene, height)
    _scatter_trees(scene, height)
    eye, target = (92.0, 0.0, -104.0), (22.0, 26.0, 30.0)
    eye_y = height_at(height, eye[0], eye[2]) + 13.0
    scene.camera(Camera(look_at((eye[0], eye_y, eye[2]), target), yfov_rad=0.8, name="camera"))
    scene.sky(sun_elevation_deg=24, sun_azimuth_deg=300, turbidity=3, sun=True)
    return scene.build()


def heights() -> Array:
    """(CELLS + 1, CELLS + 1) metres; rows go along +Z, columns along +X."""
    hills = cloud(CELLS, "terrain-hills", slope=2.8, lowest=1.0)
    folds = 2.0 * cloud(CELLS, "terrain-ridges", slope=2.6, lowest=2.0) - 1.0
    ridges = 1.0 - (np.hypot(folds, _CREST) - _CREST)
    rough = cloud(CELLS, "terrain-rough", slope=2.3, lowest=12.0) - 0.5
    shape = hills**1.4 * (0.45 + 0.55 * ridges**2)
    field = RELIEF_M * shape + 3.0 * rough * (0.25 + shape)
    return np.pad(field, ((0, 1), (0, 1)), mode="wrap")


def slopes(height: Array) -> Array:
    """Metres up per metre along, at every point of the grid."""
    along_z, along_x = np.gradient(height, CELL_M)
    return np.hypot(along_z, along_x)


def height_at(height: Array, x: float, z: float) -> float:
    """Height of the surface's nearest grid point."""
    return float(height[_cell(z), _cell(x)])


def ground_texture(height: Array) -> U8:
    """(CELLS, CELLS, 3) sRGB: sand by the water, grass, scree where it is steep, snow on top."""
    level, slope = height[:-1, :-1], slopes(height)[:-1, :-1]
    grain = cloud(CELLS, "terrain-grain", slope=0.7, lowest=4.0)
    patches = cloud(CELLS, "terrain-patches", slope=1.8, lowest=6.0)
    colour = _mix(np.array([92.0, 108.0, 52.0]), np.array([128.0, 122.0, 66.0]), patches)
    colour = _mix(colour, np.array([122.0, 113.0, 104.0]), _ramp(slope + 0.2 * patches, 0.55, 0.85))
    colour = _mix(
        colour, np.array([186.0, 168.0, 128.0]), _ramp(-level - 1.5 * patches, -WATER_M - 1.8, -WATER_M)
    )
    snow = _ramp(level + 8.0 * patches, 40.0, 47.0) * (1.0 - _ramp(slope, 0.6, 0.9))
    colour = _mix(colour, np.array([238.0, 240.0, 244.0]), snow)
    return np.clip(colour * (0.86 + 0.28 * grain[..., None]), 0, 255).round().astype(np.uint8)


def _ground(height: Array) -> Mesh:
    """Smooth mesh over the grid, front up."""
    ticks = np.linspace(-SIZE_M / 2, SIZE_M / 2, CELLS + 1)
    z, x = np.meshgrid(ticks, ticks, indexing="ij")
    along_z, along_x = np.gradient(height, CELL_M)
    normals = np.stack([-along_x, np.ones_like(height), -along_z], axis=-1)
    uv = np.stack([x, z], axis=-1) + SIZE_M / 2
    return grid(np.stack([x, height, z], axis=-1), normals, uv)


def _scatter_rocks(scene: SceneBuilder, height: Array) -> None:
    material = scene.material(matte("rock", (0.34, 0.31, 0.28)))
    rng = Seed(1).child("terrain-rocks").numpy()
    shapes = [scene.mesh(f"rock {k}", (_rock(rng), material)) for k in range(N_ROCK_SHAPES)]
    for number, (x, y, z) in enumerate(_places(rng, height, N_ROCKS, _STEEPEST_ROCK, 200.0)):
        size, yaw = rng.uniform(0.5, 2.4), rng.uniform(0, 360)
        scene.node(
            f"rock {number}",
            mesh=shapes[number % N_ROCK_SHAPES],
            translation=(x, y - 0.15 * size, z),
            yaw_deg=yaw,
            scale=size,
        )


def _scatter_trees(scene: SceneBuilder, height: Array) -> None:
    needles = scene.material(matte("needles", (0.07, 0.12, 0.06)))
    bark = scene.material(matte("bark", (0.20, 0.14, 0.10)))
    rng = Seed(1).child("terrain-trees").numpy()
    trunk = cylinder(0.16, 1.6, 8)
    shapes = [scene.mesh(f"tree {k}", (_crown(rng), needles), (trunk, bark)) for k in range(N_TREE_SHAPES)]
    for number, (x, y, z) in enumerate(_places(rng, height, N_TREES, _STEEPEST_TREE, 36.0)):
        size, yaw = rng.uniform(0.8, 1.7), rng.uniform(0, 360)
        scene.node(
            f"tree {number}",
            mesh=shapes[number % N_TREE_SHAPES],
            translation=(x, y - 0.3, z),
            yaw_deg=yaw,
            scale=size,
            lightmap_scale=0.5,
        )


def _places(
    rng: np.random.Generator, height: Array, n: int, steepest: float, highest_m: float
) -> list[tuple[float, float, float]]:
    """Points on dry ground that isn't too steep."""
    slope, found = slopes(height), []
    while len(found) < n:
        x, z = rng.uniform(-0.48 * SIZE_M, 0.48 * SIZE_M, 2)
        y = height_at(height, x, z)
        if WATER_M + 1.0 < y < highest_m and slope[_cell(z), _cell(x)] < steepest:
            found.append((float(x), y, float(z)))
    return found


def _rock(rng: np.random.Generator) -> Mesh:
    """A lump about a metre across."""
    ball = sphere(0.5, 20, 12)
    lump = np.zeros(len(ball.positions))
    for _ in range(5):
        direction = rng.normal(size=3)
        lump += rng.uniform(0.03, 0.09) * np.sin(
            ball.positions @ (direction * rng.uniform(3, 7)) + rng.uniform(0, 6)
        )
    squash = np.array([1.0, rng.uniform(0.55, 0.8), rng.uniform(0.75, 1.0)])
    points = (ball.positions + ball.normals * lump[:, None]) * squash
    normals = ball.normals / squash
    return Mesh(points, normals / np.linalg.norm(normals, axis=1, keepdims=True), ball.uv, ball.indices)


def _crown(rng: np.random.Generator) -> Mesh:
    """Four tiers of branches, each narrower than the one below."""
    tiers = []
    for k in range(4):
        radius, tall = 1.5 * (1.0 - 0.21 * k) * rng.uniform(0.9, 1.1), 2.2 - 0.25 * k
        tiers.append(cone(radius, tall, 12).turned(rng.uniform(0, 30)).moved(y=1.2 + 1.15 * k))
    return join(*tiers)


def _cell(metres: float) -> int:
    return round((metres + SIZE_M / 2) / CELL_M)


def _mix(low: Array, high: Array, share: Array) -> Array:
    return low + (high - low) * share[..., None]


def _ramp(value: Array, low: float, high: float) -> Array:
    """Smoothly 0 below ``low`` and 1 above ``high``."""
    t = np.clip((value - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
