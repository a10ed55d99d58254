"""Baked scenes of a few texels and probes, and what NumPy reads in them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from irradia.bake.directional import DirectionalMaps
from irradia.bake.directional_modes import MODES, DirectionalName, SurfaceFrame
from irradia.bake.probes.interpolation import interpolate
from irradia.core.sh import fibonacci_sphere, irradiance
from irradia.export.glb import Companions, baked_glb
from irradia.export.probes_extension import read_baked_probes
from irradia.export.read_baked import BakedScene
from irradia.formats.ktx2 import Encoding
from irradia.formats.probes import NO_PROBE, ProbeGrid, ProbeOctree, ProbeSet
from irradia.scene.gltf import read_document
from irradia.scene.layout import LightmapLayout, Unwrap
from irradia.scene.load import load_scene

from .cases import Questions, bilinear

N_PAGES, HEIGHT_PX, WIDTH_PX = 2, 12, 20
SIGHT_SIZE = 5  # odd, so that texels and words don't match


def write_baked(
    path: Path,
    mode: DirectionalName | None = None,
    encoding: Encoding = "half",
    *,
    direct: bool = False,
    field: bytes | None = None,
    probes: ProbeSet | None = None,
) -> Path:
    """A .glb with pages of made-up light, on which one primitive has its place."""
    scene = load_scene("builtin:pane")
    corners = scene.primitives[0].indices.ravel()
    triangles = np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
    unwrap = Unwrap(corners, triangles, np.zeros((len(corners), 2), np.float32), triangles[:, 0] // 3)
    n_instances = len(scene.instances)
    layout = LightmapLayout(
        n_pages=N_PAGES,
        width_px=WIDTH_PX,
        height_px=HEIGHT_PX,
        unwraps=(unwrap, *[None] * (len(scene.primitives) - 1)),
        page=np.array([0 if each.primitive == 0 else -1 for each in scene.instances], np.int32),
        scale=np.ones((n_instances, 2), np.float32),
        offset=np.zeros((n_instances, 2), np.float32),
        texels_per_metre=1.0,
    )
    pages = made_pages(1) * 5
    directional = None if mode is None else DirectionalMaps(mode, made_maps(mode))
    companions = Companions(
        directional=directional, direct=pages / 4 if direct else None, field=field, probes=probes
    )
    path.write_bytes(baked_glb(scene, layout, pages, companions, encoding=encoding))
    return path


def made_pages(seed: int) -> np.ndarray:
    """(P, H, W, 3) in [0, 1]."""
    shape = (N_PAGES, HEIGHT_PX, WIDTH_PX, 3)
    return np.random.default_rng(seed).random(shape).astype(np.float32)


def made_maps(mode: DirectionalName) -> dict[str, np.ndarray]:
    """Of the mode's names; mean directions fill the ball that they may."""
    maps = {name: made_pages(seed) for seed, name in enumerate(MODES[mode].light_maps, 2)}
    if mode == "sh":
        by_colour = np.stack([_directions(seed) for seed in (11, 12, 13)], axis=-2)
        return maps | {f"sh_{axis}": by_colour[..., k] for k, axis in enumerate("xyz")}
    coded = {name: _directions(11) for name in MODES[mode].maps if name not in maps}
    return maps | coded


def _directions(seed: int) -> np.ndarray:
    """(P, H, W, 3) in the unit ball, as x/2 + 1/2."""
    within = 2.0 * made_pages(seed) - 1.0
    return 0.5 + 0.5 * within / np.maximum(np.linalg.norm(within, axis=-1, keepdims=True), 1.0)


def lightmap_irradiance(baked: BakedScene, asked: Questions) -> np.ndarray:
    """E of the plain map."""
    return math.pi * bilinear(baked.pages, asked.uv, asked.page)


def directional_irradiance(baked: BakedScene, asked: Questions) -> np.ndarray:
    """E of the directional maps, by the reference."""
    assert baked.directional is not None
    texels = {name: bilinear(p, asked.uv, asked.page) for name, p in baked.directional.pages.items()}
    surface, tangent = np.float64(asked.surface_normal), np.float64(asked.tangent)
    bitangent = np.cross(surface, tangent[:, :3]) * tangent[:, 3:]
    frame = SurfaceFrame(surface, tangent[:, :3], bitangent)
    plain = bilinear(baked.pages, asked.uv, asked.page)
    mode = MODES[baked.directional.mode]
    return math.pi * mode.irradiance_over_pi(plain, texels, np.float64(asked.normal), frame)


def probes_irradiance(path: Path, asked: Questions, *, on_surface: bool) -> np.ndarray:
    """E between the probes of a .glb, by the reference."""
    probes = read_baked_probes(read_document(path))
    assert probes is not None
    surface = np.float64(asked.surface_normal) if on_surface else None
    series = interpolate(probes, np.float64(asked.position), surface)
    return np.maximum(irradiance(series, np.float64(asked.normal)), 0.0)


def grid_probes(shape: tuple[int, int, int]) -> ProbeSet:
    """A lattice of so many probes, a fifth of them in walls."""
    origin, spacing = np.float32([-1.0, 0.25, 2.0]), np.float32([0.5, 0.75, 0.4])
    z, y, x = np.meshgrid(*(np.arange(n) for n in reversed(shape)), indexing="ij")
    places = origin + spacing * np.stack([x, y, z], axis=-1).reshape(-1, 3)
    return _probes(places.astype(np.float32), 0.75, ProbeGrid(origin, spacing, shape))


def octree_probes() -> ProbeSet:
    """Cells of three levels in a lattice with holes, some corners without a probe."""
    origin, size = np.float32([-2.0, 0.0, 1.0]), 2.0
    cells = np.array(_octree_cells(), np.int32)
    steps = np.array([(i & 1, i >> 1 & 1, i >> 2 & 1) for i in range(8)])
    corners = (cells[:, None, :3] + steps) * (0.5 ** cells[:, None, 3:])
    places, numbers = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    numbers = numbers.reshape(-1, 8).astype(np.uint32)
    numbers[3::5, 6] = NO_PROBE
    positions = (origin + size * places).astype(np.float32)
    return _probes(positions, size, ProbeOctree(origin, size, cells, numbers))


def _octree_cells() -> list[tuple[int, int, int, int]]:
    """Roots 3 × 1 × 2: two leaves, one hole, one split into leaves and holes, two split twice."""
    found = [(0, 0, 0, 0), (2, 0, 1, 0)]
    found += [(2 + (i & 1), i >> 1 & 1, i >> 2, 1) for i in range(8) if i not in (2, 7)]
    for root in ((0, 1), (2, 0)):
        halves = [(2 * root[0] + (i & 1), i >> 1 & 1, 2 * root[1] + (i >> 2), 1) for i in range(8)]
        found += halves[1:]
        x, y, z, _ = halves[0]
        found += [(2 * x + (i & 1), 2 * y + (i >> 1 & 1), 2 * z + (i >> 2), 2) for i in range(7)]
    return found


def _probes(positions: np.ndarray, spacing_m: float, structure: ProbeGrid | ProbeOctree) -> ProbeSet:
    n, rng = len(positions), np.random.default_rng(17)
    reach = np.full(n, 2.2 * spacing_m, np.float32)
    distance = rng.random((n, SIGHT_SIZE, SIGHT_SIZE, 2)) * reach[:, None, None, None] * (0.8, 0.3)
    series = rng.normal(size=(n, 9, 3)) * 0.2
    series[:, 0] += 2.0
    return ProbeSet(
        positions=positions,
        offsets=np.float32(0.1 * spacing_m * fibonacci_sphere(n)),
        coefficients=series.astype(np.float32),
        validity=rng.random(n).astype(np.float32),
        state=(rng.random(n) < 0.2).astype(np.uint8),
        sky=np.zeros((n, 4), np.float32),
        distance=distance.astype(np.float32),
        reach=reach,
        structure=structure,
    )
