"""What ``irradia demo`` tells at its end; the bake itself has its own tests."""

from __future__ import annotations

import shlex
from pathlib import Path

from irradia.cli import demo


def test_it_ends_with_the_command_that_opens_the_viewer(monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setattr(demo.shutil, "which", lambda name: f"/bin/{name}")
    out = tmp_path / "my demo"
    assert shlex.split(demo.view_command(out)) == ["irradia", "view", str(out)]


def test_a_program_that_is_not_on_the_path_is_named_as_it_was_called(monkeypatch) -> None:
    monkeypatch.setattr(demo.shutil, "which", lambda name: None)
    monkeypatch.setattr(demo.sys, "argv", [".venv/bin/irradia", "demo"])
    assert demo.view_command(Path("out")) == ".venv/bin/irradia view out"
