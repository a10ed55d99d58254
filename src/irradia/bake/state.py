"""An interrupted bake on disk, and back.

One uncompressed ``.npz``: sums and counts as they stand on the device, bit for bit, and a JSON
header that says whose they are. It is written under another name and renamed, so that whoever ends
the process, the file is the newest complete one.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.files import write_atomic

if TYPE_CHECKING:
    from irradia.bake.progressive import ProgressiveBake

VERSION = 1
_ANEW = "Bake without --resume."
_SUMS = ("direct", "part", "total")


def save_state(path: Path, bake: ProgressiveBake, identity: dict[str, Any]) -> None:
    """Writes where a bake stands.

    Args:
        path: The file.
        bake: Between two passes.
        identity: Everything that must be the same when it is taken up again; plain JSON values.
    """
    now = bake.progression
    header = {
        "version": VERSION,
        "identity": identity,
        "n_grown": now.n_grown,
        "epochs": [asdict(epoch) for epoch in now.epochs],
        "spent_s": now.spent_s,
        "n_rays": now.n_rays,
    }
    with write_atomic(path) as stream, zipfile.ZipFile(stream, "w") as archive:
        for key, value in _each_array(bake, header):  # as np.savez does, which would need all at once
            with archive.open(f"{key}.npy", "w", force_zip64=True) as entry:
                np.lib.format.write_array(entry, value, allow_pickle=False)


def _each_array(bake: ProgressiveBake, header: dict[str, Any]) -> Iterator[tuple[str, NDArray]]:
    """What is saved, one array after the other: together they are as large as the bake's own."""
    now = bake.progression
    yield "header", np.frombuffer(json.dumps(header).encode(), np.uint8)
    for name in _SUMS:
        for key, value in getattr(now, name).each_array():
            yield f"{name}/{key}", value
    if now.settled is not None:
        yield "settled", np.array(now.settled)
    for key, value in bake.meter.to_arrays().items():
        yield f"meter/{key}", value
    for key, value in bake.rounds.state().items():
        yield f"rounds/{key}", value


def load_state(path: Path, bake: ProgressiveBake, identity: dict[str, Any]) -> None:
    """Puts a bake where :func:`save_state` found it.

    Raises:
        InputError: If the file is damaged, or of another scene or other options.
    """
    from irradia.bake.progressive import Epoch
    from irradia.transport.backend import mi
    from irradia.transport.texel_sums import TexelSums

    header, arrays = _read(path)
    _check_identity(path, header["identity"], identity)
    now = bake.progression
    try:
        for name in _SUMS:
            setattr(now, name, TexelSums.from_arrays(_under(arrays, name)))
        if "settled" in arrays:
            now.settled = mi.Color3f(*[mi.Float(row) for row in arrays["settled"]])
        bake.meter.restore(_under(arrays, "meter"))
        bake.rounds.restore(_under(arrays, "rounds"))
        now.n_grown, now.n_rays = int(header["n_grown"]), int(header["n_rays"])
        now.epochs = [Epoch(**epoch) for epoch in header["epochs"]]
        now.spent_s = float(header["spent_s"])
    except (KeyError, TypeError, ValueError) as error:
        raise _damaged(path) from error


def _under(arrays: dict[str, NDArray], prefix: str) -> dict[str, NDArray]:
    return {key[len(prefix) + 1 :]: value for key, value in arrays.items() if key.startswith(prefix + "/")}


def _read(path: Path) -> tuple[dict[str, Any], dict[str, NDArray]]:
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        header = json.loads(arrays.pop("header").tobytes())
    except FileNotFoundError as error:
        raise InputError("there is no interrupted bake here", where=str(path), fix=_ANEW) from error
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError) as error:
        raise _damaged(path) from error
    if header.get("version") != VERSION:
        raise InputError(
            f"this bake was left by another version (state {header.get('version')}, expected {VERSION})",
            where=str(path),
            fix=_ANEW,
        )
    return header, arrays


def _damaged(path: Path) -> InputError:
    return InputError("the state of the interrupted bake is damaged", where=str(path), fix=_ANEW)


def _check_identity(path: Path, found: dict[str, Any], expected: dict[str, Any]) -> None:
    plain = json.loads(json.dumps(expected))  # as the file's: tuples have become lists
    differing = [key for key in plain if found.get(key) != plain[key]]
    if differing:
        raise InputError(
            f"the interrupted bake differs in: {', '.join(sorted(differing))}",
            where=str(path),
            fix="Give the same scene and options, or bake without --resume.",
        )
