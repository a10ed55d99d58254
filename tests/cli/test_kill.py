"""Bakes that are killed, that meet another, or that run out of disk leave no damaged file."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from irradia.cli import app
from irradia.cli.bake_trace import STATE
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


def _kill_after_saves(command: list[str], out: Path, n_saves: int) -> None:
    """Runs a bake and kills it when it has saved its state anew so many times."""
    seen = {_stamp(out / STATE)}
    with subprocess.Popen([sys.executable, "-m", "irradia", *command, str(out)]) as running:
        while len(seen) <= n_saves:
            assert running.poll() is None, "it ended before it saved its state"
            seen.add(_stamp(out / STATE))
            time.sleep(0.002)
        running.kill()
    assert not (out / "lightmap.exr").exists(), "it ended before it was killed"


def _stamp(path: Path) -> int:
    return path.stat().st_mtime_ns if path.exists() else 0


def test_a_bake_that_is_killed_and_resumed_gives_the_bytes_of_one_that_ran_through(tmp_path):
    options = ["--no-report", "--resolution", "32", "--samples", "4096", "--checkpoint", "0.001"]
    command = ["bake", "builtin:cornell", *options, "-o"]
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    assert app.run([*command, str(whole)]) == 0
    _kill_after_saves(command, killed, 1)
    _kill_after_saves(["bake", "--resume", *command[1:]], killed, 3)
    assert app.run([*command, str(killed), "--resume"]) == 0
    for name in ("lightmap.exr", "preview.png", "scene.baked.glb"):
        assert (killed / name).read_bytes() == (whole / name).read_bytes(), name
    assert {path.name for path in killed.iterdir()} == {path.name for path in whole.iterdir()}
