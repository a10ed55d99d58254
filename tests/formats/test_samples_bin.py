"""The Unity project's datasets: golden bytes, the layout that is found out, damage that is refused."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.probes_bin import read_probes_bin, write_probes_bin
from irradia.formats.samples import SampleFile, SampleInfo, open_samples
from irradia.formats.samples_bin import BinOptions, read_samples_bin, write_samples_bin

BOX = ((-1.0, 0.0, 0.0), (1.0, 2.0, 4.0))
HEADER = struct.pack("<I6fI", 2, -1, 0, 0, 1, 2, 4, 1)
POSITIONS = struct.pack("<6f", -1, 2, 3, 1, 0.5, 4)
NORMALS = struct.pack("<6f", 0, 1, 0, 0, 0, -1)
VALUES = struct.pack("<6f", 0.5, 0.25, 8, 10, 20, 30)
PLANAR = HEADER + POSITIONS + NORMALS + VALUES
INTERLEAVED = HEADER + b"".join(p[i : i + 12] for i in (0, 12) for p in (POSITIONS, NORMALS, VALUES))
ROWS = np.array(
    [(-1, 2, 3, 0, 1, 0, 0.5, 0.25, 8, 0), (1, 0.5, 4, 0, 0, -1, 10, 20, 30, 0)],
    np.float32,
)
SURFACE = SampleFile(Path("room.samples"), SampleInfo("surface", BOX), ROWS)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "room.bin"


def test_bytes_of_version_1_are_golden(path: Path) -> None:
    write_samples_bin(path, SURFACE)
    assert path.read_bytes() == PLANAR
    assert len(PLANAR) == 32 + 36 * 2


@pytest.mark.parametrize(("data", "layout"), [(PLANAR, "planar"), (INTERLEAVED, "interleaved")])
def test_layout_of_version_1_is_found_out_and_named(path: Path, data: bytes, layout: str) -> None:
    path.write_bytes(data)
    found = open_samples(path)
    np.testing.assert_array_equal(found.rows, ROWS)
    assert found.info.kind == "surface"
    assert found.info.provenance["layout"] == layout
    np.testing.assert_array_equal(found.aabb, BOX)


def probes(n_coefficients: int) -> SampleFile:
    values = np.arange(2 * n_coefficients * 3, dtype=np.float32).reshape(2, -1)
    rows = np.hstack([ROWS[:, :3], values, np.ones((2, 1), np.float32)])
    return SampleFile(Path("p.samples"), SampleInfo("sh", BOX, n_coefficients=n_coefficients), rows)


@pytest.mark.parametrize("n_coefficients", [4, 9])
@pytest.mark.parametrize("coefficients", ["radiance", "irradiance"])
def test_version_2_is_the_format_of_probes(path: Path, n_coefficients: int, coefficients) -> None:
    samples = probes(n_coefficients)
    write_samples_bin(path, samples, coefficients=coefficients)
    written = path.read_bytes()
    series = samples.values.reshape(2, -1, 3)
    write_probes_bin(path, samples.positions, series, aabb=samples.aabb, quantity=coefficients)
    assert written == path.read_bytes()
    found = open_samples(path, BinOptions(coefficients=coefficients))
    np.testing.assert_allclose(found.values, samples.values[:, :12], rtol=1e-6)
    np.testing.assert_array_equal(found.positions, samples.positions)
    np.testing.assert_array_equal(found.variance, 0.0)
    assert found.normals is None
    assert read_probes_bin(path, quantity=coefficients).coefficients.shape == (2, 4, 3)


def test_options_say_what_the_file_does_not(path: Path) -> None:
    path.write_bytes(PLANAR)
    assert read_samples_bin(path, BinOptions(quantity="indirect")).info.quantity == "indirect"


def test_large_datasets_are_written_in_blocks(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_samples_bin(path, probes(4))
    whole = path.read_bytes()
    monkeypatch.setattr("irradia.formats.samples_bin.BLOCK_ROWS", 1)
    write_samples_bin(path, probes(4))
    assert path.read_bytes() == whole


def patched(offset: int, kind: str, *values: float) -> bytes:
    data = bytearray(PLANAR)
    struct.pack_into(f"<{kind}", data, offset, *values)
    return bytes(data)


@pytest.mark.parametrize(
    ("data", "complaint"),
    [
        (b"", "header of 32 bytes, found 0"),
        (b"x y z nx ny nz r g b\n", "header of 32 bytes"),
        (b"position normal irradiance, as text that is long enough\n", "expected version"),
        (PLANAR[:-1], "104 bytes for 2 samples, found 103"),
        (PLANAR + b"\0", "found 105"),
        (patched(0, "I", 0xFFFFFFFF), "4294967295 samples"),
        (HEADER.replace(b"\2", b"\0", 1), "0 samples"),
        (patched(28, "I", 3), "expected version 1"),
        (patched(4, "f", math.nan), "AABB"),
        (patched(16, "f", -9), "AABB"),
        (patched(40, "f", math.nan), "planar: expected finite"),
        (patched(56 + 24, "f", math.inf), "finite"),
        (patched(56, "f", 2.0), "planar: expected normals .* interleaved: expected"),
        (patched(32, "f", 2.0), "planar: expected positions"),
        (struct.pack("<I6fI", 0, *[0.0] * 6, 2), "probes, found none"),
    ],
)
def test_damage_is_refused_with_file_and_reason(path: Path, data: bytes, complaint: str) -> None:
    path.write_bytes(data)
    with pytest.raises(InputError, match=complaint) as caught:
        open_samples(path)
    assert caught.value.where == str(path)


def test_missing_file_is_an_input_error(path: Path) -> None:
    with pytest.raises(InputError):
        open_samples(path)


def test_more_samples_than_the_header_counts_are_refused(path: Path) -> None:
    rows = np.broadcast_to(ROWS[:1], (1 << 32, 10))
    with pytest.raises(InputError, match=r"2\^32"):
        write_samples_bin(path, SampleFile(path, SURFACE.info, rows))
    assert not path.exists()
