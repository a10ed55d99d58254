"""Datasets that stream: golden bytes, growth that a reader sees, and damage that is refused."""

from __future__ import annotations

import json
import math
import struct
import threading
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.core.lock import acquire_lock
from irradia.formats.samples import (
    SampleInfo,
    SampleWriter,
    count_samples,
    is_being_written,
    open_samples,
    part_path,
    validation_path,
)
from irradia.formats.samples_bin import write_samples_bin

BOX = ((-1.0, 0.0, 0.0), (1.0, 2.0, 4.0))
SURFACE = SampleInfo("surface", BOX, "indirect", samples_per_point=64, provenance={"seed": 7})
ROWS = np.array(
    [(-1, 2, 3, 0, 1, 0, 0.5, 0.25, 8, 0.125), (1, 0, 4, 0, 0, -1, 1, 2, 3, 0)],
    np.float32,
)
TEXT = (
    b'{"aabb": [[-1.0, 0.0, 0.0], [1.0, 2.0, 4.0]], "kind": "surface", "n_coefficients": 0,'
    b' "provenance": {"seed": 7}, "quantity": "indirect", "samples_per_point": 64}'
)
GOLDEN = (
    (b"\x93SAMPLES" + struct.pack("<IIQII", 1, 10, 2, 4096, len(TEXT)) + TEXT).ljust(4096, b"\0")
    + struct.pack("<10f", -1, 2, 3, 0, 1, 0, 0.5, 0.25, 8, 0.125)
    + struct.pack("<10f", 1, 0, 4, 0, 0, -1, 1, 2, 3, 0)
)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "room.samples"


def write(path: Path, info: SampleInfo = SURFACE, rows: np.ndarray = ROWS) -> Path:
    with SampleWriter(path, info) as writer:
        writer.append(rows)
    return path


def test_bytes_are_golden(path: Path) -> None:
    assert write(path).read_bytes() == GOLDEN


def test_samples_come_back(path: Path) -> None:
    found = open_samples(write(path))
    assert found.finished
    assert found.info == SURFACE
    assert len(found) == 2
    np.testing.assert_array_equal(found.rows, ROWS)
    np.testing.assert_array_equal(found.positions, ROWS[:, :3])
    np.testing.assert_array_equal(found.normals, ROWS[:, 3:6])
    np.testing.assert_array_equal(found.values, ROWS[:, 6:9])
    np.testing.assert_array_equal(found.variance, ROWS[:, 9])
    np.testing.assert_array_equal(found.aabb, BOX)


@pytest.mark.parametrize(("n_coefficients", "n_values"), [(4, 12), (9, 27)])
def test_probes_have_coefficients_and_no_normal(path: Path, n_coefficients: int, n_values: int) -> None:
    rows = np.linspace(0.0, 1.0, 3 * (4 + n_values), dtype=np.float32).reshape(3, -1)
    found = open_samples(write(path, SampleInfo("sh", BOX, n_coefficients=n_coefficients), rows))
    assert found.normals is None
    np.testing.assert_array_equal(found.values, rows[:, 3:-1])
    np.testing.assert_array_equal(found.variance, rows[:, -1])


def test_provenance_of_any_length_fits(path: Path) -> None:
    info = SampleInfo("surface", BOX, provenance={"note": "x" * 9000})
    found = open_samples(write(path, info))
    assert found.info == info
    np.testing.assert_array_equal(found.rows, ROWS)
    assert path.stat().st_size == 3 * 4096 + 80


def test_growing_file_shows_its_whole_rows(path: Path) -> None:
    writer = SampleWriter(path, SURFACE)
    before = open_samples(path)
    assert (len(before), before.finished) == (0, False)
    writer.append(ROWS)
    with part_path(path).open("ab") as stream:
        stream.write(b"half a row")
    during = before.grown()
    assert (len(during), during.finished) == (2, False)
    np.testing.assert_array_equal(during.rows, ROWS)
    assert is_being_written(path)
    writer.abandon()
    assert not is_being_written(path)
    assert not path.exists()
    assert len(open_samples(path)) == 2


def test_reader_follows_a_file_until_it_has_its_name(path: Path) -> None:
    writer = SampleWriter(path, SURFACE)
    writer.append(ROWS[:1])
    seen = open_samples(path)
    writer.append(ROWS[1:])
    writer.close()
    writer.close()
    seen = seen.grown()
    assert (len(seen), seen.finished, seen.path) == (2, True, path)
    assert seen.grown() is seen
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_earlier_dataset_stays_until_the_new_one_is_whole(path: Path) -> None:
    write(path)
    with pytest.raises(InputError):
        write(path, rows=np.vstack([ROWS[:1], ROWS * np.nan]))
    assert path.read_bytes() == GOLDEN
    assert part_path(path).exists()
    write(path, rows=ROWS[:1])
    assert len(open_samples(path)) == 1
    assert not part_path(path).exists()


def test_reader_notices_that_another_dataset_took_the_place(path: Path) -> None:
    writer = SampleWriter(path, SURFACE)
    writer.append(ROWS)
    seen = open_samples(path)
    writer.abandon()
    write(path, rows=ROWS[:1])
    with pytest.raises(InputError, match="another dataset"):
        seen.grown()


def test_two_writers_of_one_file_are_refused(path: Path) -> None:
    with SampleWriter(path, SURFACE) as writer:
        writer.append(ROWS)
        with pytest.raises(InputError, match="is being written"):
            SampleWriter(path, SURFACE)
    assert len(open_samples(path)) == 2


def test_closed_writer_takes_no_more(path: Path) -> None:
    with SampleWriter(path, SURFACE) as writer:
        writer.append(ROWS)
    with pytest.raises(InputError, match="closed"):
        writer.append(ROWS)


def with_value(row: int, column: int, value: float) -> np.ndarray:
    rows = ROWS.copy()
    rows[row, column] = value
    return rows


BAD_ROWS = [
    (with_value(1, 7, math.nan), "finite numbers, but row 1"),
    (with_value(0, 0, math.inf), "finite numbers, but row 0"),
    (with_value(1, 2, 4.5), "positions in the AABB, but row 1"),
    (with_value(1, 5, -1.1), "normals of length 1, but row 1"),
    (with_value(0, 4, 1e30), "normals of length 1, but row 0"),
    (with_value(1, 9, -0.1), "variances of 0 or more, but row 1"),
]


@pytest.mark.parametrize(("rows", "complaint"), BAD_ROWS)
def test_rows_that_cannot_be_samples_are_refused_both_ways(path: Path, rows, complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        write(path, rows=rows)
    path.write_bytes(GOLDEN[:4096] + rows.tobytes())
    with pytest.raises(InputError, match=complaint):
        open_samples(path)


def test_row_number_counts_from_the_start_of_the_file(path: Path) -> None:
    with SampleWriter(path, SURFACE) as writer:
        writer.append(ROWS)
        with pytest.raises(InputError, match="row 3 "):
            writer.append(BAD_ROWS[0][0])


def test_rows_of_another_width_are_refused(path: Path) -> None:
    with pytest.raises(InputError, match="rows of 10, found 2 × 9"):
        write(path, rows=ROWS[:, :9])


def header(start: int, kind: str, value: object, text: bytes = TEXT) -> bytes:
    data = bytearray(GOLDEN[:32] + text.ljust(4096 - 32, b"\0") + GOLDEN[4096:])
    struct.pack_into("<I", data, 28, len(text))
    struct.pack_into(f"<{kind}", data, start, value)
    return bytes(data)


def info(**changes: object) -> bytes:
    return header(8, "I", 1, json.dumps(json.loads(TEXT) | changes).encode())


BAD_FILES = [
    (b"", "an empty file"),
    (b"position,normal\n", "found text"),
    (b"\0" * 5000, "bytes that begin 00"),
    (GOLDEN[:20], "expected a dataset"),
    (GOLDEN[:40], "damaged"),
    (GOLDEN[:4096], "found 0 bytes"),
    (GOLDEN[:-1], "found 79 bytes"),
    (GOLDEN + b"\0", "found 81 bytes"),
    (header(8, "I", 2), "version 1, found 2"),
    (header(12, "I", 9), "10 columns, found 9"),
    (header(12, "I", 0xFFFFFFFF), "10 columns"),
    (header(16, "Q", 3), "expected 3 rows"),
    (header(16, "Q", (1 << 64) - 2), "rows of 40 bytes"),
    (header(16, "Q", 0)[:4096], "expected samples, found none"),
    (header(24, "I", 0), "damaged"),
    (header(24, "I", 4100), "damaged"),
    (header(24, "I", 0xFFFFF000), "expected 2 rows"),
    (header(28, "I", 0xFFFFFFFF), "damaged"),
    (header(28, "I", 12), "damaged"),
    (header(8, "I", 1, b"[" * 4000), "damaged"),
    (header(8, "I", 1, b"[]"), "damaged"),
    (header(8, "I", 1, b"\xff"), "damaged"),
    (info(kind="lamp"), "kind of surface, volume, sh"),
    (info(lamp=1), "damaged"),
    (info(quantity="some"), "full or indirect"),
    (info(n_coefficients=9), "can't have 9 coefficients"),
    (info(aabb=[[0, 0, 0]]), "damaged"),
    (info(aabb=[[0, 0, 0], [1, -1, 1]]), "expected an AABB"),
    (info(aabb=[[0, 0, 0], [1, 1, 1e300]]), "expected an AABB"),
    (info(aabb=[[0, 0, 0], [1, 1, 1 << 2000]]), "damaged"),
    (info(aabb=[[0, 0, 0], [1, "a", 1]]), "damaged"),
    (info(samples_per_point=-1), "samples a point"),
    (info(provenance=[]), "provenance"),
]


@pytest.mark.parametrize(("data", "complaint"), BAD_FILES)
def test_damage_is_refused_with_file_and_reason(path: Path, data: bytes, complaint: str) -> None:
    path.write_bytes(data)
    with pytest.raises(InputError, match=complaint) as caught:
        open_samples(path)
    assert caught.value.where == str(path)


def test_missing_file_is_an_input_error(path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        open_samples(path)


def test_validation_samples_lie_beside_those_of_training() -> None:
    assert validation_path(Path("a/room.samples")) == Path("a/room.validation.samples")
    assert validation_path(Path("room.bin")) == Path("room.validation.bin")


def test_any_flipped_byte_of_the_header_is_refused_or_harmless(path: Path) -> None:
    for at in range(32 + len(TEXT)):
        for flip in (0x01, 0x20, 0x80, 0xFF):
            damaged = bytearray(GOLDEN)
            damaged[at] ^= flip
            path.write_bytes(damaged)
            try:
                found = open_samples(path)
            except InputError:
                continue
            np.testing.assert_array_equal(found.rows, ROWS[: len(found)])


def test_readers_that_ask_for_a_writer_keep_none_from_starting(tmp_path: Path) -> None:
    path = tmp_path / "room.samples"
    for count in range(3):
        probe = acquire_lock(tmp_path / f".{path.name}.lock")  # as `is_being_written` does
        assert probe is not None
        asked = threading.Timer(0.1, probe.release)
        asked.start()
        with SampleWriter(path, SURFACE) as writer:
            writer.append(ROWS)
        asked.join()
        assert len(open_samples(path)) == 2, count


def test_a_dataset_may_take_another_name_in_the_end(tmp_path: Path) -> None:
    path, other = tmp_path / "room.samples", tmp_path / "other.samples"
    for name in (None, other):
        with SampleWriter(path, SURFACE) as writer:
            writer.append(ROWS[: 2 if name is None else 1])
            writer.close(name)
    assert (len(open_samples(path)), len(open_samples(other))) == (2, 1)
    assert not part_path(path).exists()
    assert not is_being_written(path)


def test_samples_are_counted_without_being_read(tmp_path: Path) -> None:
    path = tmp_path / "room.samples"
    assert count_samples(path) == 0
    with SampleWriter(path, SURFACE) as writer:
        writer.append(ROWS)
        assert count_samples(part_path(path)) == 0  # it grows
    assert count_samples(path) == 2
    write_samples_bin(tmp_path / "room.bin", open_samples(path))
    assert count_samples(tmp_path / "room.bin") == 2
    path.write_bytes(b"damaged")
    assert count_samples(path) == 0
