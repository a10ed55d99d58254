"""What browsers drew and how they were driven, once for all tests of a session: that takes the time."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from .drawn import Drawn, MadeScene, draw_scene, make_scene
from .viewer_files import write_files, write_kept_page


@pytest.fixture(scope="session")
def built_viewer(web_check, repo_root: Path, tmp_path_factory) -> Path:
    """A folder with index.html, viewer.js and viewer.css, built from the sources as they stand."""
    folder = tmp_path_factory.mktemp("viewer")
    build = repo_root / "web" / "viewer" / "build.js"
    subprocess.run(["node", build, "--out", folder], check=True)
    return folder


@pytest.fixture(scope="session")
def tour(web_check, built_viewer: Path, chromium: str, tmp_path_factory) -> Callable[[str], dict[str, Any]]:
    """``tour("sides")`` drives a browser as viewer/tours.ts says, once, and gives what it found."""
    files = write_files(tmp_path_factory.mktemp("files"))
    kept = tmp_path_factory.mktemp("kept") / "index.html"
    write_kept_page((built_viewer / "index.html").read_text(encoding="utf-8"), files, kept)
    served = {f"/files/{name}": path for name, path in files.items()}
    for path in built_viewer.iterdir():
        served |= {f"/built/{path.name}": path, f"/kept/{path.name}": path}
    served["/kept/index.html"] = kept

    @cache
    def run(name: str) -> dict[str, Any]:
        return web_check("viewer", name, chromium, *(f"{url}={path}" for url, path in served.items()))

    return run


@pytest.fixture(scope="session")
def draw(web_check, chromium: str, tmp_path_factory) -> Callable[[str, str], Drawn]:
    """``draw("cornell", "webgpu")``: a built-in scene in made-up light, by a backend."""

    @cache
    def made(name: str) -> MadeScene:
        return make_scene(name, tmp_path_factory.mktemp(name))

    @cache
    def drawn(name: str, backend: str) -> Drawn:
        folder = tmp_path_factory.mktemp(f"{name}-{backend}")
        return draw_scene(made(name), backend, web_check, chromium, folder)

    return drawn
