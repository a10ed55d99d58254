"""probes.npz: what goes in comes out, the same bytes each time; damage is refused."""

from __future__ import annotations

import hashlib
import io
import zipfile
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.probes import NO_PROBE, ProbeGrid, ProbeOctree, ProbeSet, read_probes, write_probes


def exact(*shape: int) -> np.ndarray:
    """Numbers of no pattern between −0.75 and 0.82 that are the same on every machine."""
    return (((np.arange(np.prod(shape)) * 37 + 11) % 101).reshape(shape) / 64 - 0.75).astype(np.float32)


def made(n: int = 12, **changes: object) -> ProbeSet:
    probes = ProbeSet(
        positions=exact(n, 3),
        offsets=exact(n, 3) / 8,
        coefficients=exact(n, 9, 3),
        validity=np.abs(exact(n)) / 2,
        state=(np.arange(n) % 3).astype(np.uint8),
        sky=exact(n, 4),
        distance=np.abs(exact(n, 4, 4, 2)),
        reach=np.abs(exact(n)) + 1,
        light="indirect",
        structure=ProbeGrid(np.float32([1, 2, 3]), np.float32([0.5, 0.5, 0.25]), (2, 3, 2)),
        provenance={"seed": 7},
    )
    return replace(probes, **changes)  # type: ignore[arg-type]


OCTREE = ProbeOctree(
    np.float32([0, 1, 2]),
    2.0,
    np.array([(0, 0, 0, 0), (2, 0, 1, 1)], np.int32),
    np.array([range(8), [NO_PROBE, *range(4, 11)]], np.uint32),
)


def same(a: ProbeSet, b: ProbeSet) -> bool:
    def equal(x: object, y: object) -> bool:
        if isinstance(x, ProbeGrid | ProbeOctree):
            return type(x) is type(y) and all(
                equal(getattr(x, f.name), getattr(y, f.name)) for f in fields(x)
            )
        return bool(np.array_equal(x, y))  # type: ignore[arg-type]

    return all(equal(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))


@pytest.mark.parametrize("structure", [made().structure, OCTREE, None])
def test_probes_come_back_bit_for_bit(tmp_path: Path, structure) -> None:
    probes = made(structure=structure)
    write_probes(tmp_path / "probes.npz", probes)
    assert same(read_probes(tmp_path / "probes.npz"), probes)


def test_the_same_probes_give_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_probes(tmp_path / name, made())
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_layout_of_version_1_is_golden(tmp_path: Path) -> None:
    """Names, types, shapes and bytes of every array: a change of any needs a new version."""
    write_probes(tmp_path / "probes.npz", made())
    digest = hashlib.sha256()
    with np.load(tmp_path / "probes.npz") as archive:
        for name in sorted(archive.files):
            values = archive[name]
            digest.update(f"{name} {values.dtype.str} {values.shape}".encode() + values.tobytes())
    assert digest.hexdigest()[:16] == "8138a61fd9218700"


@pytest.mark.parametrize("keep", [0, 10, 200, 0.5, 0.99])
def test_file_cut_short_is_refused(tmp_path: Path, keep: float) -> None:
    path = tmp_path / "probes.npz"
    write_probes(path, made())
    data = path.read_bytes()
    path.write_bytes(data[: int(keep * len(data)) if isinstance(keep, float) else keep])
    with pytest.raises(InputError):
        read_probes(path)


def test_single_flipped_bytes_never_crash(tmp_path: Path) -> None:
    path = tmp_path / "probes.npz"
    write_probes(path, made())
    data = path.read_bytes()
    refused = 0
    for place in range(0, len(data), 41):
        path.write_bytes(data[:place] + bytes([data[place] ^ 0xFF]) + data[place + 1 :])
        try:
            read_probes(path)
        except InputError:
            refused += 1
    assert refused > 20


def rewrite(path: Path, **changes: object) -> None:
    with np.load(path) as archive:
        arrays = dict(archive)
    for name, value in changes.items():
        arrays.pop(name)
        if value is not None:
            arrays[name] = np.asarray(value)
    np.savez(path, **arrays)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"version": 2}, "version 1"),
        ({"offsets": None}, "'offsets'"),
        ({"offsets": np.zeros((11, 3), np.float32)}, "'offsets'"),
        ({"sky": np.full((12, 4), np.nan, np.float32)}, "finite"),
        ({"light": "diffuse"}, "full or indirect"),
        ({"light": 3}, "'light'"),
        ({"grid_shape": [2, 3, 3]}, "grid of 12 probes"),
        ({"grid_shape": [-2, -3, 2]}, "grid of 12 probes"),
        ({"grid_spacing": [0.0, 1.0, 1.0]}, "spacing"),
        ({"distance": np.zeros((12, 4, 5, 2), np.float32)}, "'distance'"),
        ({"provenance": "[1"}, "JSON"),
        ({"state": np.full(12, 9, np.uint8)}, "state"),
    ],
)
def test_arrays_that_do_not_fit_together_are_named(tmp_path: Path, change, complaint) -> None:
    path = tmp_path / "probes.npz"
    write_probes(path, made())
    rewrite(path, **change)
    with pytest.raises(InputError, match=complaint):
        read_probes(path)


def test_corners_beyond_the_last_probe_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "probes.npz"
    write_probes(path, made(structure=replace(OCTREE, corners=OCTREE.corners + np.uint32(2))))
    with pytest.raises(InputError, match="corners below 12"):
        read_probes(path)


def test_header_that_claims_more_than_the_file_holds_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "probes.npz"
    header = io.BytesIO()
    fake = {"descr": "<f4", "fortran_order": False, "shape": (1 << 40, 3)}
    np.lib.format.write_array_header_1_0(header, fake)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("positions.npy", header.getvalue())
    with pytest.raises(InputError, match="size"):
        read_probes(path)


def test_pickles_are_not_opened(tmp_path: Path) -> None:
    path = tmp_path / "probes.npz"
    np.savez(path, positions=np.array([{"a": 1}], object))
    with pytest.raises(InputError):
        read_probes(path)
