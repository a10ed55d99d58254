"""A bake divided among machines: each traces some slices of the last epoch, one joins them.

Every machine traces the early epochs itself, which costs it a few samples a texel and makes it need
nothing from the others: the same seed gives the same cache. The slices are then summed as an
undivided bake sums them, each from nothing and in order, so the joined map has the same bytes.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.files import write_atomic

if TYPE_CHECKING:
    from irradia.bake.progressive import ProgressiveBake
    from irradia.transport.texel_sums import TexelSums

VERSION = 1


@dataclass(frozen=True)
class Shard:
    """One machine's part.

    Attributes:
        number, count: Which of how many, counted from 1.
        job: The bake's choices, as plain values.
        identity: What all parts must have in common.
        cache_hash: Of the frozen cache; parts that gathered from another don't belong together.
        direct: Sums before the last epoch, by name.
        slices: Sums of each slice, by name.
        spent_s: Tracing time.
    """

    number: int
    count: int
    job: dict[str, Any]
    identity: dict[str, Any]
    cache_hash: str
    direct: dict[str, NDArray]
    slices: tuple[dict[str, NDArray], ...]
    spent_s: float = 0.0


def write_shard(path: Path, shard: Shard) -> None:
    """Writes a part as one ``.npz``."""
    header = {
        "version": VERSION,
        "number": shard.number,
        "count": shard.count,
        "job": shard.job,
        "identity": shard.identity,
        "cache_hash": shard.cache_hash,
        "n_slices": len(shard.slices),
        "spent_s": shard.spent_s,
    }
    arrays: dict[str, NDArray] = {"header": np.frombuffer(json.dumps(header).encode(), np.uint8)}
    arrays |= {f"direct/{key}": value for key, value in shard.direct.items()}
    for i, sums in enumerate(shard.slices):
        arrays |= {f"slice-{i}/{key}": value for key, value in sums.items()}
    with write_atomic(path) as stream:
        np.savez(stream, **arrays)  # type: ignore[arg-type]


def read_shard(path: Path) -> Shard:
    """Reads a part.

    Raises:
        InputError: The file is missing, damaged, or of another version.
    """
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        header = json.loads(arrays.pop("header").tobytes())
        if header["version"] != VERSION:
            raise InputError(f"shard of version {header['version']}, expected {VERSION}", where=str(path))
        return Shard(
            int(header["number"]),
            int(header["count"]),
            header["job"],
            header["identity"],
            header["cache_hash"],
            _under(arrays, "direct"),
            tuple(_under(arrays, f"slice-{i}") for i in range(header["n_slices"])),
            float(header["spent_s"]),
        )
    except FileNotFoundError as error:
        raise InputError("there is no such file", where=str(path)) from error
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile, EOFError) as error:
        raise InputError("this is no shard, or a damaged one", where=str(path)) from error


def _under(arrays: dict[str, NDArray], prefix: str) -> dict[str, NDArray]:
    return {key[len(prefix) + 1 :]: value for key, value in arrays.items() if key.startswith(prefix + "/")}


def in_order(shards: Sequence[Shard]) -> list[Shard]:
    """Sorts the parts of one bake.

    Raises:
        InputError: A part is missing, there twice, or of another bake.
    """
    first = shards[0]
    for shard in shards[1:]:
        differing = [k for k in first.identity if shard.identity.get(k) != first.identity[k]]
        if differing or shard.count != first.count:
            what = ", ".join(sorted(differing)) or "number of shards"
            raise InputError(f"shards {first.number} and {shard.number} differ in: {what}")
        if shard.cache_hash != first.cache_hash:
            raise InputError(
                f"shards {first.number} and {shard.number} gathered from different light",
                fix="Trace them with one version of Irradia on one kind of CPU.",
            )
    numbers = sorted(shard.number for shard in shards)
    expected = list(range(1, first.count + 1))
    if numbers != expected:
        missing = sorted(set(expected) - set(numbers))
        what = f"missing {', '.join(map(str, missing))}" if missing else "some are there twice"
        raise InputError(f"expected shards 1 to {first.count}: {what}")
    return sorted(shards, key=lambda shard: shard.number)


def join(bake: ProgressiveBake, shards: Sequence[Shard], identity: dict[str, Any]) -> None:
    """Puts a fresh bake where tracing all slices of the shards would have brought it.

    Raises:
        InputError: The shards are of another scene.
    """
    plain = json.loads(json.dumps(identity))  # as the files': tuples have become lists
    differing = [k for k in plain if shards[0].identity.get(k) != plain[k]]
    if differing:
        raise InputError(f"the shards were traced with another: {', '.join(sorted(differing))}")
    from irradia.transport.texel_sums import TexelSums

    def load(arrays: dict[str, NDArray]) -> TexelSums:
        try:
            sums = TexelSums.from_arrays(arrays)
        except (KeyError, TypeError, ValueError) as error:
            raise InputError("a shard is damaged") from error
        if len(sums.rays) != bake.light.n_texels:
            raise InputError(f"expected sums of {bake.light.n_texels} texels, found {len(sums.rays)}")
        return sums

    bake.take(load(shards[0].direct), (load(part) for shard in shards for part in shard.slices))
    bake.progression.spent_s = sum(shard.spent_s for shard in shards)
