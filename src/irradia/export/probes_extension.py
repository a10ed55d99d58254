"""Light probes inside IRRADIA_lighting; docs/IRRADIA_lighting/ and docs/probes.md say what readers do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.export.lighting_extension import NAME, VERSION
from irradia.export.slots import Slots
from irradia.formats.lightmap import power_of_two_scale
from irradia.formats.probes import EMPTY, ProbeGrid, ProbeLight, ProbeOctree, ProbeSet, check_structure
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import GltfDocument, Json
from irradia.scene.gltf.view import JsonView

_NUMBERS = 27
_MAX_SIZE = 64  # texels a side of a probe's octahedral map


def add_probes(json: Json, slots: Slots, probes: ProbeSet) -> None:
    """Adds probes to the document's root.

    Args:
        json: The document being written.
        slots: Where their numbers go.
        probes: At least one.
    """
    scale = power_of_two_scale(probes.coefficients[:, 0])
    entry: Json = {
        "light": probes.light,
        "count": len(probes),
        "scale": scale,
        "coefficients": -1,
        "positions": slots.add_table(probes.positions, "VEC3"),
        "states": slots.add_table(probes.state[:, None], "SCALAR"),
        "validities": slots.add_table(probes.validity[:, None], "SCALAR"),
        "sky": slots.add_table(probes.sky, "VEC4"),
        "reaches": slots.add_table(probes.reach[:, None], "SCALAR"),
        "distances": {"size": probes.distance.shape[1], "bufferView": -1},
    }
    if probes.offsets.any():
        entry["offsets"] = slots.add_table(probes.offsets, "VEC3")
    series = _halfs(probes.coefficients / np.float32(scale))
    slots.add_blob(series, lambda view: entry.update(coefficients=view))
    distances: Json = entry["distances"]
    shares = np.clip(np.round(probes.distance / probes.reach[:, None, None, None] * 255.0), 0.0, 255.0)
    slots.add_blob(shares.astype(np.uint8).tobytes(), lambda view: distances.update(bufferView=view))
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
    scale = np.float32(entry.number("scale", 1.0))
    distances = entry.object("distances")
    size = distances.integer("size", minimum=1)
    if size > _MAX_SIZE:
        raise InputError(f"expected at most {_MAX_SIZE}, found {size}", where=f"{distances.pointer}/size")
    reach = _table(accessors, entry, "reaches", n, 1)[:, 0]
    series = _read_halfs(accessors, entry, "coefficients", n * _NUMBERS)
    stored = _read_exactly(accessors, distances, "bufferView", n * size * size * 2)
    shares = np.frombuffer(stored, np.uint8).astype(np.float32) / np.float32(255.0)
    probes = ProbeSet(
        positions=_table(accessors, entry, "positions", n, 3),
        offsets=_table(accessors, entry, "offsets", n, 3)
        if entry.has("offsets")
        else np.zeros((n, 3), np.float32),
        coefficients=series.reshape(n, 9, 3) * scale,
        validity=_table(accessors, entry, "validities", n, 1)[:, 0],
        state=_states(accessors, entry, n),
        sky=_table(accessors, entry, "sky", n, 4),
        distance=shares.reshape(n, size, size, 2) * reach[:, None, None, None],
        reach=reach,
        light=_light(entry),
        structure=_structure(accessors, entry),
    )
    check_structure(probes.structure, n, entry.pointer)
    return probes


def _light(entry: JsonView) -> ProbeLight:
    return "full" if entry.choice("light", ("full", "indirect")) == "full" else "indirect"


def _structure_entry(slots: Slots, structure: ProbeGrid | ProbeOctree | None) -> Json:
    match structure:
        case ProbeGrid(origin, spacing, shape):
            grid = {"origin": origin.tolist(), "spacing": spacing.tolist(), "shape": list(shape)}
            return {"grid": grid}
        case ProbeOctree(origin, size_m, cells, corners):
            tables = {
                "cells": slots.add_table(cells.astype(np.uint16), "VEC4"),
                "corners": slots.add_table(np.ascontiguousarray(corners.reshape(-1, 1)), "SCALAR"),
            }
            return {"octree": {"origin": origin.tolist(), "size": float(size_m), **tables}}
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
        cells = accessors.read(tree.integer("cells"))
        corners = accessors.read(tree.integer("corners"))
        if cells.values.shape[1] != 4 or len(corners) != 8 * len(cells):
            raise InputError("expected eight corners for each cell", where=tree.pointer)
        return ProbeOctree(
            np.array(tree.numbers("origin", (0.0,) * 3), np.float32),
            tree.number("size", 1.0),
            cells.values.astype(np.int32),
            corners.values.astype(np.uint32).reshape(-1, 8),
        )
    return None


def _states(accessors: Accessors, entry: JsonView, n: int) -> NDArray[np.uint8]:
    stored = accessors.read(entry.integer("states"))
    if stored.values.shape != (n, 1) or stored.values.dtype.kind != "u" or stored.values.max() > EMPTY:
        raise InputError(f"expected {n} states of 0 to {EMPTY}", where=stored.pointer)
    return stored.values[:, 0].astype(np.uint8)


def _table(accessors: Accessors, entry: JsonView, key: str, n: int, width: int) -> NDArray[np.float32]:
    stored = accessors.read(entry.integer(key))
    if len(stored) != n:
        raise InputError(f"expected {n} rows of {key}, found {len(stored)}", where=stored.pointer)
    return stored.floats(width)


def _halfs(values: NDArray[np.float32]) -> bytes:
    """Little-endian halfs; what is too large for one becomes the largest."""
    return np.clip(values, -65504.0, 65504.0).astype("<f2").tobytes()


def _read_halfs(accessors: Accessors, entry: JsonView, key: str, count: int) -> NDArray[np.float32]:
    values = np.frombuffer(_read_exactly(accessors, entry, key, 2 * count), "<f2").astype(np.float32)
    if not np.isfinite(values).all():
        raise InputError("expected finite numbers", where=f"{entry.pointer}/{key}")
    return values


def _read_exactly(accessors: Accessors, entry: JsonView, key: str, n_bytes: int) -> bytes:
    data = bytes(accessors.read_view(entry.integer(key)))
    if len(data) != n_bytes:
        raise InputError(f"expected {n_bytes} bytes, found {len(data)}", where=f"{entry.pointer}/{key}")
    return data
