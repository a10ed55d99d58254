"""Whatever is written to a full disk: a clear error, and exit code 2."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from irradia.cli import app

_FULL = Path("/dev/full")
pytestmark = pytest.mark.skipif(not _FULL.exists(), reason="this system has no device that is always full")


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_full_stdout_is_said(options):
    # Python's own buffer is part of the matter: it is written once more at the end.
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    with _FULL.open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "irradia", "info", "builtin:plane-point", *options],
            stdout=full,
            stderr=subprocess.PIPE,
            env=buffered,
            text=True,
            check=False,
        )
    assert done.returncode == 2
    assert "the disk is full" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_picture_that_does_not_fit_is_said_with_its_name(tmp_path, monkeypatch, capfd):
    def fill(path, *_):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr("irradia.formats.png.write_png", fill)
    out = tmp_path / "image.png"
    arguments = ["render", "builtin:plane-point", "-o", str(out), "--spp", "1"]
    assert app.run([*arguments, "--width", "16", "--height", "16", "--json"]) == 2
    said = capfd.readouterr()
    assert json.loads(said.out)["error"]["where"] == str(out)
    assert "the disk is full" in said.err
    assert list(tmp_path.iterdir()) == []
