"""Results appear whole or not at all."""

from __future__ import annotations

import pytest

from irradia.cli.staging import staged_folder
from irradia.core.errors import InputError


def _names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_files_arrive_when_the_block_ends(tmp_path):
    with staged_folder(tmp_path / "out") as work:
        (work / "a.txt").write_text("a")
        assert not (tmp_path / "out").exists()
    assert _names(tmp_path) == ["out"]
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
