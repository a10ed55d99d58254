"""A file is whole or absent, whatever happens to the disk."""

from __future__ import annotations

import errno
import os

import pytest

from irradia.core import files
from irradia.core.files import disk_problem, place_problem, write_atomic, write_text_atomic


class _SmallDisk:
    """A stream that holds ten bytes."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor, self._room = descriptor, 10

    def __enter__(self) -> _SmallDisk:
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._descriptor)

    def write(self, data: bytes) -> int:
        written = os.write(self._descriptor, data[: self._room])
        self._room -= written
        if written < len(data):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return written


@pytest.fixture
def small_disk(monkeypatch):
    monkeypatch.setattr(files.os, "fdopen", lambda descriptor, mode: _SmallDisk(descriptor))


@pytest.mark.usefixtures("small_disk")
def test_a_full_disk_leaves_the_old_file_and_nothing_else(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(OSError, match=r"a\.txt") as raised:
        write_text_atomic(tmp_path / "a.txt", "new and longer than the disk")
    assert raised.value.errno == errno.ENOSPC
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


def test_what_fits_is_written(tmp_path):
    write_text_atomic(tmp_path / "deep" / "a.txt", "new")
    assert (tmp_path / "deep" / "a.txt").read_text() == "new"
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["a.txt"]


def test_an_error_of_the_writer_leaves_nothing(tmp_path):
    def fail():
        with write_atomic(tmp_path / "a.bin") as stream:
            stream.write(b"half")
            raise ValueError("half-way")

    with pytest.raises(ValueError, match="half-way"):
        fail()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EFBIG, errno.EIO])
def test_trouble_with_the_disk_is_explained(number):
    problem = disk_problem(OSError(number, os.strerror(number), "out/lightmap.exr"))
    assert problem is not None
    assert problem.exit_code == 2
    assert problem.where == "out/lightmap.exr"
    assert problem.fix is not None


@pytest.mark.parametrize("place", ["text.txt/deep/x.bin", "folder"])
def test_a_name_that_is_taken_is_explained(tmp_path, place):
    (tmp_path / "text.txt").write_text("a file")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError, match=r"exists|directory") as caught, write_atomic(tmp_path / place):
        pass
    problem = place_problem(caught.value)
    assert problem is not None
    assert "stands where" in problem.message


def test_other_errors_are_not_the_disks():
    assert disk_problem(FileNotFoundError(errno.ENOENT, "no such file", "a")) is None
    assert disk_problem(OSError("without a number")) is None
