"""Bakes that are killed, that meet another, or that run out of disk leave no damaged file."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from irradia.cli import app
from irradia.cli.staging import STAGING
from irradia.formats.lightmap import read_lightmap

_SMALL = ["--no-report", "--no-denoise", "--resolution", "48", "--samples", "4"]
_ENDLESS = ["--no-report", "--no-denoise", "--resolution", "64", "--samples", "1000000"]
_LITTLE_ROOM = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), resource.RLIM_INFINITY))
sys.argv = sys.argv[1:]
from irradia.cli import main
main()
"""


def _bake(out: Path, *options: str) -> int:
    return app.run(["bake", "builtin:cornell", "-o", str(out), *_SMALL, *options])


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@contextmanager
def _endless_bake(out: Path) -> Iterator[subprocess.Popen[str]]:
    """A bake in another process that has begun to trace."""
    command = [sys.executable, "-m", "irradia", "bake", "builtin:cornell", "-o", str(out), *_ENDLESS]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as running:
        try:
            assert running.stderr is not None
            while "ray tracing set-up" not in (line := running.stderr.readline()):
                assert line, "it ended before it traced"
            yield running
        finally:
            running.kill()


def test_a_killed_bake_leaves_the_earlier_results_and_the_next_one_clears_up(tmp_path):
    out = tmp_path / "out"
    assert _bake(out) == 0
    before = _contents(out)
    with _endless_bake(out) as running:
        running.kill()
        running.wait()
    assert _contents(out) == before
    assert (out / STAGING).is_dir()
    assert _bake(out, "--seed", "5") == 0
    assert not (out / STAGING).exists()
    assert set(_contents(out)) == set(before)
    assert _contents(out)["lightmap.exr"] != before["lightmap.exr"]


def test_a_second_bake_into_one_folder_is_refused_while_the_first_goes_on(tmp_path, capfd):
    out = tmp_path / "out"
    with _endless_bake(out) as running:
        assert _bake(out, "--json") == 2
        said = capfd.readouterr()
        assert running.poll() is None
    error = json.loads(said.out)["error"]
    assert error["where"] == str(out)
    assert f"process {running.pid} " in error["message"]
    assert "another -o" in said.err
    assert _bake(out) == 0


@pytest.mark.skipif(sys.platform == "win32", reason="limits the size of files as POSIX systems can")
def test_a_disk_that_takes_no_more_is_said_and_leaves_the_earlier_results(tmp_path):
    out = tmp_path / "out"
    assert _bake(out) == 0
    before = _contents(out)
    options = ["--no-report", "--no-denoise", "--resolution", "512", "--samples", "1"]
    command = ["500000", "bake", "builtin:cornell", "-o", str(out), *options]
    done = subprocess.run(
        [sys.executable, "-c", _LITTLE_ROOM, *command], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2, done.stderr
    assert "larger than the system allows" in done.stderr
    assert "Traceback" not in done.stderr
    assert _contents(out) == before
    assert [path for path in out.iterdir() if path.is_dir()] == []
    read_lightmap(out / "lightmap.exr")
