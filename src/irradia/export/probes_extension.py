"""Light probes inside IRRADIA_lighting; docs/IRRADIA_lighting/ and docs/probes.md say what readers do."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.export.lighting_extension import NAME, VERSION
from irradia.export.slots import Slots
from irradia.formats.lightmap import power_of_two_scale
from irradia.formats.probes import EMPTY, ProbeGrid, ProbeOctree, ProbeSet, check_structure
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import GltfDocument, Json
from irradia.scene.gltf.view import JsonView

_MAX_SIZE = 64  # texels a side of a probe's octahedral map
_HALF_MAX = 65504.0


def add_probes(json: Json, slots: Slots, probes: ProbeSet) -> None:
    """Adds probes to the document's root.

    Args:
        json: The document being written.
        slots: Where their numbers go, each array in a buffer view of its own.
        probes: At least one.
    """
    scale = power_of_two_scale(probes.coefficients[:, 0])
    shares = probes.distance / probes.reach[:, None, None, None] * 255.0
    arrays: dict[str, NDArray] = {
        "coefficients": np.clip(probes.coefficients / scale, -_HALF_MAX, _HALF_MAX).astype("<f2"),
        "positions": probes.positions.astype("<f4"),
        "offsets": probes.offsets.astype("<f4"),
        "states": probes.state,
        "validities": probes.validity.astype("<f4"),
        "sky": probes.sky.astype("<f4"),
        "reaches": probes.reach.astype("<f4"),
        "distances": np.clip(np.round(shares), 0.0, 255.0).astype(np.uint8),
    }
    entry: Json = {"light": probes.light, "count": len(probes), "scale": scale}
    entry |= {key: _stored(slots, values) for key, values in arrays.items()}
    entry["distances"]["size"] = probes.distance.shape[1]
    entry |= _structure_entry(slots, probes.structure)
    root = json.setdefault("extensions", {}).setdefault(NAME, {"version": VERSION})
    root["probes"] = entry


def read_baked_probes(document: GltfDocument) -> ProbeSet | None:
    """The probes of a baked document, or None where it has none.

    Raises:
        InputError: They are damaged.
    """
    extension = JsonView(document.json).extension(NAME)
    if extension is None or not extension.has("probes"):
        return None
    entry, accessors = extension.object("probes"), Accessors(document)
    n = entry.integer("count", minimum=1)
    size = entry.object("distances").integer("size", minimum=1)
    if size > _MAX_SIZE:
        raise InputError(
            f"expected at most {_MAX_SIZE}, found {size}", where=f"{entry.pointer}/distances/size"
        )

    def read(key: str, dtype: str, *shape: int) -> NDArray:
        return _read(accessors, entry.object(key), dtype, (n, *shape))

    scale, reach = np.float32(entry.number("scale", 1.0)), read("reaches", "<f4")
    state = read("states", "u1")
    if state.max() > EMPTY:
        raise InputError(f"expected states of 0 to {EMPTY}", where=f"{entry.pointer}/states")
    shares = read("distances", "u1", size, size, 2).astype(np.float32) / np.float32(255.0)
    probes = ProbeSet(
        positions=read("positions", "<f4", 3),
        offsets=read("offsets", "<f4", 3),
        coefficients=read("coefficients", "<f2", 9, 3).astype(np.float32) * scale,
        validity=read("validities", "<f4"),
        state=state,
        sky=read("sky", "<f4", 4),
        distance=shares * reach[:, None, None, None],
        reach=reach,
        light="full" if entry.choice("light", ("full", "indirect")) == "full" else "indirect",
        structure=_structure(accessors, entry),
    )
    check_structure(probes.structure, n, entry.pointer)
    return probes


def _structure_entry(slots: Slots, structure: ProbeGrid | ProbeOctree | None) -> Json:
    match structure:
        case ProbeGrid(origin, spacing, shape):
            grid = {"origin": origin.tolist(), "spacing": spacing.tolist(), "shape": list(shape)}
            return {"grid": grid}
        case ProbeOctree(origin, size_m, cells, corners):
            tree: Json = {"origin": origin.tolist(), "size": float(size_m), "count": len(cells)}
            tree["cells"] = _stored(slots, cells.astype("<u2"))
            tree["corners"] = _stored(slots, corners.astype("<u4"))
            return {"octree": tree}
    return {}


def _structure(accessors: Accessors, entry: JsonView) -> ProbeGrid | ProbeOctree | None:
    if entry.has("grid"):
        grid = entry.object("grid")
        origin = np.array(grid.numbers("origin", (0.0,) * 3), np.float32)
        spacing = np.array(grid.numbers("spacing", (1.0,) * 3), np.float32)
        nx, ny, nz = (int(v) for v in grid.numbers("shape", (1.0,) * 3))
        return ProbeGrid(origin, spacing, (nx, ny, nz))
    if entry.has("octree"):
        tree = entry.object("octree")
        n = tree.integer("count", minimum=1)
        return ProbeOctree(
            np.array(tree.numbers("origin", (0.0,) * 3), np.float32),
            tree.number("size", 1.0),
            _read(accessors, tree.object("cells"), "<u2", (n, 4)).astype(np.int32),
            _read(accessors, tree.object("corners"), "<u4", (n, 8)),
        )
    return None


def _stored(slots: Slots, values: NDArray) -> Json:
    """An array in a buffer view of its own, row by row, little-endian."""
    place: Json = {"bufferView": -1}
    slots.add_blob(np.ascontiguousarray(values).tobytes(), lambda view: place.update(bufferView=view))
    return place


def _read(accessors: Accessors, place: JsonView, dtype: str, shape: tuple[int, ...]) -> NDArray:
    """See :func:`_stored`; refuses another size and numbers that aren't finite."""
    data = bytes(accessors.read_view(place.integer("bufferView")))
    expected = math.prod(shape) * np.dtype(dtype).itemsize
    if len(data) != expected:
        raise InputError(f"expected {expected} bytes, found {len(data)}", where=place.pointer)
    values = np.frombuffer(data, dtype).reshape(shape)
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise InputError("expected finite numbers", where=place.pointer)
    return values
