"""Reference pictures in a folder of results: an .hdr for each camera, and what the record says of it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.scene.framing import camera_from_record, camera_record
from irradia.scene.types import Camera

PATTERN = "view*.reference.hdr"
KEY = "views"


@dataclass(frozen=True)
class StoredView:
    """A reference picture in a folder.

    Attributes:
        path: The .hdr: linear radiance, diffuse transport.
        camera: That it was seen through.
        width, height: In pixels.
        spp: Samples per pixel.
    """

    path: Path
    camera: Camera
    width: int
    height: int
    spp: int


def write_views(
    folder: Path, cameras: Sequence[Camera], references: Sequence[NDArray[np.float32]], spp: int
) -> list[dict[str, Any]]:
    """Writes a picture for each camera; returns what the folder's record is to hold under ``KEY``.

    Args:
        folder: Where to.
        cameras: As many as ``references``.
        references: (H, W, 3) linear radiance each.
        spp: Samples per pixel.
    """
    from irradia.formats.hdr import write_hdr

    records = []
    for number, (camera, picture) in enumerate(zip(cameras, references, strict=True)):
        name = PATTERN.replace("*", str(number))
        write_hdr(folder / name, picture)
        height, width = picture.shape[:2]
        record = {"file": name, "width": width, "height": height, "spp": spp, "camera": camera_record(camera)}
        records.append(record)
    return records


def read_record(path: Path) -> Mapping[str, Any]:
    """A folder's ``bake.json`` or ``eval.json``; nothing where there is none.

    Raises:
        InputError: It isn't a JSON object.
    """
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise InputError(f"it can't be read: {error}", where=str(path)) from error
    if not isinstance(record, dict):
        raise InputError("expected a JSON object", where=str(path))
    return record


def read_views(folder: Path, record: Mapping[str, Any], where: str) -> tuple[StoredView, ...]:
    """The references that a folder's record speaks of and that are there.

    Args:
        folder: Where they lie.
        record: From :func:`read_record`.
        where: What an error names.

    Raises:
        InputError: What the record says of them is wrong.
    """
    entries = record.get(KEY, [])
    if not isinstance(entries, list):
        raise InputError(f"expected a list under {KEY!r}", where=where)
    views = (_view(folder, entry, f"{where} /{KEY}/{i}") for i, entry in enumerate(entries))
    return tuple(view for view in views if view.path.is_file())


def _view(folder: Path, entry: Any, where: str) -> StoredView:
    try:
        name, sizes = str(entry["file"]), [int(entry[key]) for key in ("width", "height", "spp")]
        camera = entry["camera"]
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"expected a reference picture, found: {error!r}", where=where) from error
    if PurePath(name).name != name:
        raise InputError(f"expected a file beside it, found {name!r}", where=where)
    return StoredView(folder / name, camera_from_record(camera, where), *sizes)
