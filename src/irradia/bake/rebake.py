"""Baking again after an edit: only what the edit has changed.

A finished bake leaves what it knew of its texels: their light, and a coarse pass over all of them.
The next one traces the coarse pass again, with the same random numbers, so that the two differ only
where light does. Texels of changed objects, and those whose light has moved by more than 1 %, are
baked anew; the others keep their light and are marked stale where anything has moved at all. What is
compared is always the light that a texel was last baked in, so that many small edits add up.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.bake.texels import TexelSet
from irradia.core.colour import luminance
from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.scene.fingerprint import SceneChanges, compare_fingerprints
from irradia.scene.types import F32, U32

VERSION = 1
MOVED = 0.01  # of a texel's light: what calls for new samples
_STALE = 1e-4
_SUMS = ("gathered", "arrived", "rays", "samples")


@dataclass(frozen=True)
class Memory:
    """What a bake knew.

    Attributes:
        fingerprint: Of the scene; see :mod:`irradia.scene.fingerprint`.
        settings: What must be the same for the coarse passes to be comparable; plain values.
        pixel: (N,) the texels.
        coarse: (N, 3) the pass that changes are found by, as it was when each texel was last baked.
        sums: All samples that make the result; see :meth:`TexelSums.to_arrays`.
    """

    fingerprint: Mapping[str, Any]
    settings: Mapping[str, Any]
    pixel: U32
    coarse: F32
    sums: Mapping[str, NDArray]


@dataclass(frozen=True)
class Update:
    """What an edit asks for.

    Attributes:
        rebake: (N,) texels that need new samples.
        stale: (N,) texels that keep their light although it has moved a little.
        changes: Objects, lights and environment that differ.
    """

    rebake: NDArray[np.bool_]
    stale: NDArray[np.bool_]
    changes: SceneChanges


def write_memory(path: Path, memory: Memory) -> None:
    """Writes one ``.npz``."""
    header = {
        "version": VERSION,
        "fingerprint": memory.fingerprint,
        "settings": memory.settings,
    }
    arrays = {
        "header": np.frombuffer(json.dumps(header).encode(), np.uint8),
        "pixel": memory.pixel,
        "coarse": memory.coarse,
        **{f"sums/{name}": array for name, array in memory.sums.items()},
    }
    with write_atomic(path) as stream:
        np.savez(stream, **arrays)


def read_memory(path: Path) -> Memory | None:
    """What an earlier bake left, or None where there is nothing.

    Raises:
        InputError: The file is damaged or of another version.
    """
    if not path.exists():
        return None
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            header = json.loads(file["header"].tobytes())
            if header["version"] != VERSION:
                raise InputError(f"left by another version ({header['version']})", where=str(path))
            return Memory(
                header["fingerprint"],
                header["settings"],
                file["pixel"],
                file["coarse"],
                {name: file[f"sums/{name}"] for name in _SUMS},
            )
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile, EOFError) as error:
        raise InputError(
            "what the last bake knew is damaged", where=str(path), fix="Bake without --update."
        ) from error


def reason_to_start_over(memory: Memory, pixel: U32, settings: Mapping[str, Any]) -> str | None:
    """Why a memory is of no use, in words for the user, or None."""
    differing = sorted(key for key in settings if memory.settings.get(key) != settings[key])
    if differing:
        return f"the last bake had another {', '.join(differing)}"
    if not np.array_equal(memory.pixel, pixel):
        return "objects lie elsewhere on the pages than in the last bake"
    return None


def plan_update(
    memory: Memory,
    fingerprint: Mapping[str, Any],
    coarse: F32,
    texels: TexelSet,
    own: Mapping[str, NDArray[np.bool_]],
) -> Update:
    """Finds the texels that an edit has touched.

    Args:
        memory: Of the bake before.
        fingerprint: Of the scene now.
        coarse: (N, 3) its coarse pass.
        texels: Its texels.
        own: (N,) for each object's name, which texels are its.
    """
    changes = compare_fingerprints(memory.fingerprint, fingerprint)
    before, now = luminance(memory.coarse), luminance(coarse)
    floor = 0.01 * float(np.median(before)) if len(before) else 0.0
    moved = np.abs(now - before) / np.maximum(before + floor, 1e-30)
    rebake = _with_neighbours(moved > MOVED, texels)
    for name in (*changes.instances.changed, *changes.instances.added):
        if name in own:
            rebake |= own[name]
    return Update(rebake, ~rebake & (moved > _STALE), changes)


def _with_neighbours(chosen: NDArray[np.bool_], texels: TexelSet) -> NDArray[np.bool_]:
    """Adds the 3 × 3 around each texel: a coarse pass may miss by one."""
    from scipy.ndimage import maximum_filter

    pages = texels.to_pages(chosen.astype(np.uint8))
    grown = np.stack([maximum_filter(page, size=3) for page in pages])
    return grown.reshape(-1)[texels.pixel] > 0
