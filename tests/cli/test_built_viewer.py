"""The viewer itself, as packages hold it: from disk in one file, and in a gallery."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from irradia.bake.lightmap import BakeOptions
from irradia.cli import app
from irradia.cli.bake_job import BakeJob, run_bake
from irradia.cli.bake_views import ViewOptions
from irradia.cli.gallery_browser import open_page
from irradia.cli.gallery_viewer import show, viewer_picture
from irradia.core.progress import silent_progress
from irradia.scene.lightmap_uv.options import LayoutOptions

from .viewing import WEIGHTS

TIMEOUT_S = 240.0


@pytest.fixture(scope="module")
def baked(tmp_path_factory) -> Path:
    """A room with a reference picture, and a field of another room."""
    out = tmp_path_factory.mktemp("baked") / "room"
    views = ViewOptions(reference_spp=16, n_pixels=48 * 48, full_spp=1, baked_spp=1)
    layout, bake = LayoutOptions(resolution=64), BakeOptions(samples=8)
    run_bake(BakeJob("builtin:cornell", out, layout=layout, bake=bake, views=views), silent_progress())
    (out / "other.safetensors").write_bytes(WEIGHTS.read_bytes())
    return out


def pixels(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(float)


@pytest.fixture
def run(capfd):
    def ask(*arguments: Any) -> dict[str, Any]:
        code = app.run([*map(str, arguments), "--json"])
        said = json.loads(capfd.readouterr().out)
        assert code == 0, said
        return said

    return ask


@pytest.mark.parametrize("backend", ["webgl2", "webgpu"])
def test_one_file_shows_the_light_without_a_server(
    run, baked: Path, tmp_path: Path, chromium: str, backend: str
) -> None:
    page_file = tmp_path / "room.html"
    run("export", baked, "--single-file", page_file)
    with open_page(96, 96) as page:
        address = f"{page_file.as_uri()}?kiosk=1&pose=0&renderer={backend}&left="
        pictures = {}
        for source in ("lightmap", "none", "reference"):
            show(page, address + source, TIMEOUT_S)
            assert page.evaluate("document.documentElement.dataset.source") == source
            assert page.evaluate("document.documentElement.dataset.backend") == backend
            assert page.complaints == []
            pictures[source] = pixels(viewer_picture(page, TIMEOUT_S))
    assert pictures["lightmap"].shape == (96, 96, 3)
    assert np.abs(pictures["lightmap"] - pictures["reference"]).mean() < 25.0  # few samples a pixel are noisy
    assert np.abs(pictures["lightmap"] - pictures["none"]).mean() > 25.0


def test_the_gallery_shows_each_field_as_it_is(run, baked: Path, tmp_path: Path, chromium: str) -> None:
    said = run("gallery", baked, "-o", tmp_path / "sheet.html", "--width", 64, "--timeout", TIMEOUT_S)
    assert [each["source"] for each in said["pictures"]] == ["reference", "lightmap", "field:0"]
    page = (tmp_path / "sheet.html").read_text()
    shown = {part.partition('"')[0] for part in page.split("data:image/png;base64,")[1:]}
    assert len(shown) == 3
