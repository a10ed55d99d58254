"""The built viewer travels with the package."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest


@pytest.fixture
def checkout(repo_root: Path, tmp_path: Path) -> Path:
    """As much of a checkout as building needs, with a viewer in it."""
    folder = tmp_path / "checkout"
    (folder / "src" / "irradia").mkdir(parents=True)
    (folder / "scripts").mkdir()
    for name in ("pyproject.toml", "README.md", "LICENSE", ".gitignore", "src/irradia/__init__.py"):
        shutil.copyfile(repo_root / name, folder / name)
    shutil.copyfile(repo_root / "scripts" / "hatch_build.py", folder / "scripts" / "hatch_build.py")
    built = folder / "web" / "viewer" / "dist"
    built.mkdir(parents=True)
    for name in ("index.html", "viewer.js", "viewer.css", "viewer.js.map"):
        (built / name).write_text(name)
    return folder


def build(folder: Path, kind: str) -> tuple[list[str], str]:
    """Names in the package, and what was said."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", "out"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True, timeout=60)
    (made,) = (folder / "out").iterdir()
    if kind == "wheel":
        return zipfile.ZipFile(made).namelist(), done.stderr + done.stdout
    with tarfile.open(made) as archive:
        return archive.getnames(), done.stderr + done.stdout


def test_a_wheel_holds_the_viewer(checkout: Path) -> None:
    names, _ = build(checkout, "wheel")
    viewer = {name for name in names if name.startswith("irradia/viewer/")}
    assert viewer == {f"irradia/viewer/{name}" for name in ("index.html", "viewer.js", "viewer.css")}


def test_a_wheel_can_be_made_from_the_source_package(checkout: Path) -> None:
    names, _ = build(checkout, "sdist")
    there = {name.partition("/")[2] for name in names}
    assert {"web/viewer/dist/index.html", "scripts/hatch_build.py"} <= there


def test_a_wheel_without_the_viewer_says_so(checkout: Path) -> None:
    shutil.rmtree(checkout / "web")
    names, said = build(checkout, "wheel")
    assert not [name for name in names if "viewer" in name]
    assert "make viewer" in said
