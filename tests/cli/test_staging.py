"""Results appear whole or not at all."""

from __future__ import annotations

import errno
import json

import pytest

from irradia.cli.staging import STAGING, staged_folder
from irradia.core.errors import InputError


def _names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_files_arrive_when_the_block_ends(tmp_path):
    with staged_folder(tmp_path / "out") as work:
        (work / "a.txt").write_text("a")
        assert not (tmp_path / "out" / "a.txt").exists()
    assert _names(tmp_path) == ["out"]
    assert _names(tmp_path / "out") == ["a.txt"]
    assert (tmp_path / "out" / "a.txt").read_text() == "a"


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_after_an_error_nothing_is_left(tmp_path, error):
    def fail():
        with staged_folder(tmp_path / "deep" / "er" / "out") as work:
            (work / "a.txt").write_text("a")
            raise error

    with pytest.raises(error):
        fail()
    assert _names(tmp_path) == []


def test_an_error_leaves_earlier_results_as_they_were(tmp_path):
    (tmp_path / "a.txt").write_text("old")

    def fail():
        with staged_folder(tmp_path, stale=["*.txt"]) as work:
            (work / "a.txt").write_text("new")
            raise ValueError("stopped half-way")

    with pytest.raises(ValueError, match="half-way"):
        fail()
    assert (tmp_path / "a.txt").read_text() == "old"


def test_results_of_an_earlier_run_do_not_stand_beside_new_ones(tmp_path):
    for name in ("lightmap.exr", "lightmap.1.exr", "notes.md"):
        (tmp_path / name).write_text("old")
    with staged_folder(tmp_path, stale=["lightmap*.exr"]) as work:
        (work / "lightmap.exr").write_text("new")
    assert _names(tmp_path) == ["lightmap.exr", "notes.md"]
    assert (tmp_path / "lightmap.exr").read_text() == "new"


def test_a_file_in_the_folders_place_is_bad_input(tmp_path):
    (tmp_path / "out").write_text("a file")
    with pytest.raises(InputError, match="found a file"), staged_folder(tmp_path / "out"):
        pytest.fail("the block must not run")


def test_a_file_above_the_folder_is_bad_input(tmp_path):
    (tmp_path / "file").write_text("a file")
    with pytest.raises(InputError, match="can't make this folder"), staged_folder(tmp_path / "file" / "out"):
        pytest.fail("the block must not run")


def test_two_at_once_are_refused_and_the_first_goes_on(tmp_path):
    with staged_folder(tmp_path) as work:
        (work / "a.txt").write_text("first")
        with (
            pytest.raises(InputError, match=r"another bake is writing.*process \d+"),
            staged_folder(tmp_path),
        ):
            pytest.fail("the block must not run")
        assert (work / "a.txt").read_text() == "first"
    assert _names(tmp_path) == ["a.txt"]


def test_folders_beside_each_other_are_free(tmp_path):
    with staged_folder(tmp_path / "a"), staged_folder(tmp_path / "b"), staged_folder(tmp_path / "a" / "c"):
        pass
    assert _names(tmp_path) == ["a", "b"]


def test_leftovers_of_a_killed_process_are_cleared_away(tmp_path):
    files = tmp_path / STAGING / "files"
    files.mkdir(parents=True)
    (files / "lightmap.exr").write_text("half")
    (tmp_path / STAGING / "lock").write_text("process 1 on a machine since long ago")
    (tmp_path / "lightmap.exr").write_text("old")
    with staged_folder(tmp_path) as work:
        assert list(work.iterdir()) == []
        (work / "bake.json").write_text("new")
    assert _names(tmp_path) == ["bake.json", "lightmap.exr"]
    assert (tmp_path / "lightmap.exr").read_text() == "old"


def test_results_that_were_complete_when_their_process_was_killed_arrive(tmp_path):
    files = tmp_path / STAGING / "files"
    files.mkdir(parents=True)
    for name in ("a.txt", "b.txt", "old.txt"):
        (tmp_path / name).write_text("old")
    (files / "b.txt").write_text("new")  # a.txt had been moved already
    (tmp_path / "a.txt").write_text("new")
    (tmp_path / STAGING / "ready.json").write_text(json.dumps({"obsolete": ["gone.txt", "old.txt"]}))

    def fail():
        with staged_folder(tmp_path):
            raise ValueError("stopped half-way")

    with pytest.raises(ValueError, match="half-way"):
        fail()
    assert _names(tmp_path) == ["a.txt", "b.txt"]
    assert {path.read_text() for path in tmp_path.iterdir()} == {"new"}


def test_results_that_can_not_be_moved_are_kept_for_the_next_run(tmp_path):
    (tmp_path / "a.txt").mkdir()  # in the way, as an open file is on Windows

    def bake():
        with staged_folder(tmp_path) as work:
            (work / "a.txt").write_text("new")

    with pytest.raises(OSError, match=r"a\.txt"):
        bake()
    (tmp_path / "a.txt").rmdir()
    with staged_folder(tmp_path):
        assert (tmp_path / "a.txt").read_text() == "new"
    assert _names(tmp_path) == ["a.txt"]


def test_a_full_disk_is_the_users_to_mend_and_leaves_all_as_it_was(tmp_path):
    (tmp_path / "a.txt").write_text("old")

    def fill():
        with staged_folder(tmp_path) as work:
            (work / "a.txt").write_text("half")
            raise OSError(errno.ENOSPC, "No space left on device")

    with pytest.raises(InputError, match="the disk is full") as raised:
        fill()
    assert raised.value.where == str(tmp_path)
    assert _names(tmp_path) == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"
