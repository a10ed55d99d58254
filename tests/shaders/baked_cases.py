"""Lightmaps of every kind, probes in grids and octrees, and a field with a direct map."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from irradia.bake.directional_modes import MODES
from irradia.bake.probes.neighbours import NOBODY, probes_around
from irradia.export.read_baked import read_baked
from irradia.field.native_fields import decode_field
from irradia.formats.probes import ProbeGrid, ProbeSet

from .baked import (
    N_PAGES,
    directional_irradiance,
    grid_probes,
    lightmap_irradiance,
    octree_probes,
    probes_irradiance,
    write_baked,
)
from .cases import Case, Questions, bilinear, made_questions
from .field_cases import VECTORS

N_QUESTIONS = 300
PROBES = {"grid": grid_probes((4, 3, 5)), "flat": grid_probes((3, 1, 4)), "octree": octree_probes()}


def baked_cases(folder: Path) -> Iterator[Case]:
    """All of them, each in a .glb of its own in ``folder``."""
    yield from _map_cases(folder)
    for name, probes in PROBES.items():
        yield from _probe_cases(folder, name, probes)
    yield _direct_case(folder)


def _map_cases(folder: Path) -> Iterator[Case]:
    asked = made_questions(N_QUESTIONS, np.zeros(3), np.ones(3), N_PAGES)
    for encoding in ("rgb9e5", "half"):
        path = write_baked(folder / f"plain-{encoding}.glb", encoding=encoding)
        expected = lightmap_irradiance(read_baked(str(path)), asked)
        yield Case(f"lightmap-{encoding}", path, "lightmap", asked, expected)
    for mode in MODES:
        path = write_baked(folder / f"{mode}.glb", mode)
        expected = directional_irradiance(read_baked(str(path)), asked)
        yield Case(f"directional-{mode}", path, "directional", asked, expected)


def _probe_cases(folder: Path, name: str, probes: ProbeSet) -> Iterator[Case]:
    path = write_baked(folder / f"{name}.glb", probes=probes)
    asked = _in_cells(probes)
    for lit in ("probes", "things"):
        expected = probes_irradiance(path, asked, on_surface=lit == "probes")
        yield Case(f"{name}-{lit}", path, lit, asked, expected)


def probe_view_cases(folder: Path) -> Iterator[Case]:
    """The validity of the probes around."""
    for name, probes in PROBES.items():
        asked = _in_cells(probes)
        path = write_baked(folder / f"{name}-validity.glb", probes=probes)
        index, share = probes_around(probes, np.float64(asked.position))
        known = share * (index != NOBODY)
        mixed = (known * probes.validity[index]).sum(axis=1) / known.sum(axis=1)
        shown = np.tile(mixed[:, None], 3)
        yield Case(f"{name}-validity", path, "probes", asked, shown, "validity", everywhere=False)


def _in_cells(probes: ProbeSet) -> Questions:
    """Places in cells of an octree, or anywhere around a grid."""
    low, high = probes.positions.min(axis=0), probes.positions.max(axis=0)
    structure = probes.structure
    if isinstance(structure, ProbeGrid):
        return made_questions(N_QUESTIONS, low - 0.5, high + 0.5)
    assert structure is not None
    asked = made_questions(N_QUESTIONS, np.zeros(3), np.ones(3))
    cell = structure.cells[np.arange(N_QUESTIONS) % len(structure.cells)]
    edge = structure.size_m * 0.5 ** cell[:, 3:]
    place = structure.origin + (cell[:, :3] + 0.01 + 0.98 * asked.position) * edge
    return replace(asked, position=np.float32(place))


def _direct_case(folder: Path) -> Case:
    """Indirect light of a field, and the map of what lights themselves give."""
    data = (VECTORS / "hash-int8.safetensors").read_bytes()
    path = write_baked(folder / "direct.glb", direct=True, field=data)
    field = replace(decode_field(data).field, backend_name="numpy")
    asked = made_questions(N_QUESTIONS, *field.frame.aabb, N_PAGES)
    direct = read_baked(str(path)).direct
    assert direct is not None
    light = field.irradiance(asked.position, asked.normal)
    expected = light + math.pi * bilinear(direct, asked.uv, asked.page)
    return Case("direct", path, "direct", asked, expected)
