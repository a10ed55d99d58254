"""Scenes in light that was made up: without a bake, and rougher on whoever draws it.

Lightmaps have several pages and change from texel to texel, fields have random weights, probes stand in
a lattice with some of them inside walls. Nothing of it looks like light, and all of it is reproducible.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irradia.bake.directional import DirectionalMaps
from irradia.bake.directional_modes import MODES, DirectionalName
from irradia.core.rng import Seed
from irradia.export.glb import Companions, write_baked_glb
from irradia.field.encoding import Encoding
from irradia.field.encodings import (
    Composite,
    Frequency,
    HashGrid,
    Identity,
    OneBlob,
    SphericalHarmonics,
    TriPlane,
)
from irradia.field.field import Field
from irradia.field.init import new_parameters
from irradia.field.native_fields import Precision, decode_field, encode_field
from irradia.field.quantise import round_tables
from irradia.field.spec import FieldFrame, FieldSpec, Mode, Quantity
from irradia.formats.probes import EMPTY, FILLED, VALID, ProbeGrid, ProbeOctree, ProbeSet
from irradia.scene.layout import LightmapLayout, Unwrap
from irradia.scene.load import load_scene
from irradia.scene.merge import merge
from irradia.scene.types import Primitive, Scene

N_PAGES = 2
PAGE_PX = 96
_NORMAL = SphericalHarmonics(3)
F32 = NDArray[np.float32]


@dataclass(frozen=True)
class FieldCase:
    """A field, and how it is stored.

    Attributes:
        position: Its encoding.
        storage: ``fp16``, ``fp32``, ``int8`` or ``int4``.
        mode: What comes out.
        direction: Encoding of the normal, where one goes in.
        width, n_hidden_layers: Of its perceptron.
        quantity: Whether first bounces are in its light.
    """

    position: Encoding
    storage: str = "fp16"
    mode: Mode = "irradiance"
    direction: Encoding = _NORMAL
    width: int = 16
    n_hidden_layers: int = 2
    quantity: Quantity = "full"


_HASH = HashGrid(n_levels=4, log2_table_size=9, base_resolution=3, max_resolution=16)
FIELDS: dict[str, FieldCase] = {
    "hash-int8": FieldCase(_HASH, "int8"),
    "hash-int4": FieldCase(_HASH, "int4"),
    "hash-fp32": FieldCase(_HASH, "fp32", width=32),
    "triplane-int8": FieldCase(TriPlane(20, 4), "int8"),
    "frequency": FieldCase(Frequency(4)),
    "one-blob": FieldCase(OneBlob(6), direction=OneBlob(3)),
    "sh": FieldCase(SphericalHarmonics(2), direction=SphericalHarmonics(5)),
    "identity": FieldCase(Identity(), direction=Identity()),
    "composite": FieldCase(Composite((Identity(), _HASH, Frequency(2)))),
    "hash-sh1": FieldCase(_HASH, "int8", "sh1"),
    "triplane-sh2": FieldCase(TriPlane(20, 4), "fp16", "sh2"),
    "indirect": FieldCase(SphericalHarmonics(2), quantity="indirect"),
}
"""Every encoding, way to store it, mode and quantity, small enough for a browser without a GPU."""
WIDE_FIELDS: dict[str, FieldCase] = {
    "hash-wide": FieldCase(_HASH, "int8", width=64, n_hidden_layers=3),
    "frequency-wide": FieldCase(Frequency(4), width=100),
}


def made_field(case: FieldCase, aabb: F32) -> bytes:
    """A file with a field of random weights whose light is neither dark nor glaring."""
    is_irradiance = case.mode == "irradiance"
    direction = case.direction if is_irradiance else None
    head = "exp" if is_irradiance else "linear"
    spec = FieldSpec(case.position, direction, case.width, case.n_hidden_layers, head=head, mode=case.mode)
    seed = Seed(5, (type(case.position).__name__,))
    parameters = new_parameters(spec, seed)
    if "position" in parameters:
        values = seed.child("values").numpy().uniform(-0.5, 0.5, parameters["position"].shape)
        parameters["position"] = values.astype(np.float32)
    if not is_irradiance:
        parameters[f"mlp.{case.n_hidden_layers}.bias"][:3] += 2.0  # the same from all around
    field = Field(spec, FieldFrame(aabb, 0.5, case.quantity), parameters)
    precision: Precision = "fp32" if case.storage == "fp32" else "fp16"
    match case.storage:
        case "int8":
            return encode_field(round_tables(field, 8, 0), precision=precision)
        case "int4":
            return encode_field(round_tables(field, 4, 32), precision=precision)
    return encode_field(field, precision=precision)


def write_made_scene(path: Path, name: str, mode: DirectionalName, *, octree: bool = False) -> None:
    """A built-in scene as a .glb with a lightmap, directional maps, a direct map and probes."""
    scene = load_scene(f"builtin:{name}")
    low, high = bounds(scene)
    probes = made_octree(low, high) if octree else made_grid(low, high)
    direct = made_pages(Seed(4), 0.1, 0.5)
    companions = Companions(directional=made_directional(mode), direct=direct, probes=probes)
    pages = made_pages(Seed(1), 0.5, 1.5)
    write_baked_glb(path, scene, made_layout(scene), pages, companions)


def bounds(scene: Scene) -> F32:
    """(2, 3) the scene's box, metres."""
    positions = merge(scene).positions
    return np.stack([positions.min(axis=0), positions.max(axis=0)]).astype(np.float32)


def made_layout(scene: Scene) -> LightmapLayout:
    """A cell of a page's grid for each instance; charts are views along a slanted axis, and overlap."""
    n = len(scene.instances)
    side = int(np.ceil(np.sqrt(n / N_PAGES)))
    cell = np.arange(n) // N_PAGES
    offset = np.stack([cell % side, cell // side], axis=1) / side
    return LightmapLayout(
        n_pages=N_PAGES,
        width_px=PAGE_PX,
        height_px=PAGE_PX,
        unwraps=tuple(_slanted_view(primitive) for primitive in scene.primitives),
        page=(np.arange(n) % N_PAGES).astype(np.int32),
        scale=np.full((n, 2), 1.0 / side, np.float32),
        offset=offset.astype(np.float32),
        texels_per_metre=1.0,
    )


def made_pages(seed: Seed, low: float, high: float) -> F32:
    """(P, H, W, 3) waves with noise on every texel, between two values."""
    rng = seed.numpy()
    y, x = np.mgrid[:PAGE_PX, :PAGE_PX] / PAGE_PX
    u, v, phase = rng.uniform(-4.0, 4.0, (3, N_PAGES, 1, 1, 3))
    waves = np.sin(6.28 * (u * x[..., None] + v * y[..., None] + phase))
    pages = 0.5 + 0.4 * waves + rng.uniform(-0.1, 0.1, waves.shape)
    return (low + (high - low) * pages).astype(np.float32)


def made_directional(mode: DirectionalName) -> DirectionalMaps:
    """Maps of a mode: light as :func:`made_pages`, directions of every kind that are at most 1 long."""
    light = MODES[mode].light_maps
    bound = 0.5 / np.sqrt(3.0)
    ranges = {name: (0.2, 0.8) if name in light else (0.5 - bound, 0.5 + bound) for name in MODES[mode].maps}
    pages = {name: made_pages(Seed(2, (name,)), *ends) for name, ends in ranges.items()}
    return DirectionalMaps(mode, pages)


def made_grid(low: F32, high: F32) -> ProbeSet:
    """A lattice of 4 × 3 × 4 probes that ends a little inside the box."""
    shape = (4, 3, 4)
    origin = low + 0.1 * (high - low)
    spacing = 0.8 * (high - low) / (np.array(shape, np.float32) - 1)
    z, y, x = np.meshgrid(*(np.arange(k) for k in shape[::-1]), indexing="ij")
    places = origin + spacing * np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    return _probes(places, float(spacing.max()), ProbeGrid(origin, spacing.astype(np.float32), shape))


def made_octree(low: F32, high: F32) -> ProbeSet:
    """Eight cells, one of them split; probes at all corners. No surface lies on a cell's face."""
    low = (low - 0.07 * (high - low)).astype(np.float32)
    size = 0.6 * float((high - low).max())
    cells = [(*cell, 0) for cell in np.ndindex(2, 2, 2) if cell != (0, 0, 0)]
    cells += [(*cell, 1) for cell in np.ndindex(2, 2, 2)]
    rows = np.array(cells, np.int32)
    steps = np.array([(i & 1, i >> 1 & 1, i >> 2 & 1) for i in range(8)])
    finest = (rows[:, None, :3] + steps) * np.where(rows[:, 3] == 0, 2, 1)[:, None, None]
    corners, index = np.unique(finest.reshape(-1, 3), axis=0, return_inverse=True)
    places = low + corners * size / 2
    table = index.reshape(len(rows), 8).astype(np.uint32)
    return _probes(places, size, ProbeOctree(low, size, rows, table))


def _probes(places: NDArray, reach: float, structure: ProbeGrid | ProbeOctree) -> ProbeSet:
    n, rng = len(places), Seed(3).numpy()
    coefficients = rng.uniform(-0.2, 0.2, (n, 9, 3))
    coefficients[:, 0] = rng.uniform(0.5, 1.5, (n, 3))
    distance = rng.uniform(0.3, 1.0, (n, 8, 8, 2)) * (reach, 0.2 * reach)
    state = np.array([VALID, VALID, FILLED, VALID, VALID, EMPTY, VALID, VALID], np.uint8)[np.arange(n) % 8]
    return ProbeSet(
        positions=places.astype(np.float32),
        offsets=(rng.uniform(-0.05, 0.05, (n, 3)) * reach).astype(np.float32),
        coefficients=coefficients.astype(np.float32),
        validity=np.ones(n, np.float32),
        state=state,
        sky=np.zeros((n, 4), np.float32),
        distance=distance.astype(np.float32),
        reach=np.full(n, reach, np.float32),
        structure=structure,
    )


def _slanted_view(primitive: Primitive) -> Unwrap:
    positions = primitive.positions.astype(np.float64)
    uv = positions[:, :2] + positions[:, 2:] * (0.37, 0.61) + positions[:, 1::-1] * (0.29, 0.0)
    extent = np.maximum(np.ptp(uv, axis=0), 1e-6)
    inside = 0.05 + 0.9 * (uv - uv.min(axis=0)) / extent
    source = np.arange(len(uv), dtype=np.uint32)
    chart = np.zeros(len(primitive.indices), np.uint32)
    return Unwrap(source, primitive.indices, inside.astype(np.float32), chart)


def read_field(path: Path) -> Field:
    """The field of a file, computed by the reference."""
    return replace(decode_field(path.read_bytes()).field, backend_name="numpy")
