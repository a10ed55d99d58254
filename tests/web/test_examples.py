"""Examples of @irradia/three run as they are printed, and bring along only what they use."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from .court import write_court

PACKAGE = Path(__file__).resolve().parents[2] / "web" / "packages" / "three"
EXAMPLES = sorted((PACKAGE / "examples").glob("*.html"))
MAX_LINES = 40
CONTEXTS = {"webgl": "webgl2", "webgpu": "webgpu"}


def test_there_is_one_for_each_renderer() -> None:
    assert [path.stem for path in EXAMPLES] == sorted(CONTEXTS)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_shows_the_scene_in_every_light(
    web_check, chromium, tmp_path: Path, example: Path
) -> None:
    assert len(example.read_text(encoding="utf-8").splitlines()) <= MAX_LINES
    write_court(tmp_path / "scene.baked.glb")
    found = web_check("example", example, chromium, tmp_path / "scene.baked.glb", tmp_path)
    assert found["context"] == CONTEXTS[example.stem]
    assert found["sources"] == ["lightmap", "field", "probes", "three-probes", "none"]
    pictures = [shown(tmp_path / f"{name}.png") for name in found["sources"]]
    *lit, dark = pictures
    assert dark.max() == 0.0
    for picture in lit:
        assert (picture.max(axis=-1) > 20).mean() > 0.2
    means = [picture.mean() for picture in lit]
    assert np.diff(sorted(means)).min() > 0.1  # each its own


def shown(path: Path) -> NDArray[np.float64]:
    """(H, W, 3) of a screenshot, below the menu."""
    return np.asarray(Image.open(path).convert("RGB"), np.float64)[30:]


@pytest.fixture(scope="module")
def bundles(web_check) -> dict:
    return web_check("bundle", PACKAGE / "README.md")


def test_a_page_gets_only_its_own_renderers_part(bundles) -> None:
    classic, webgpu = (" ".join(bundles[name]["modules"]) for name in ("example", "webgpuExample"))
    assert "three/dist/webgl/" in classic
    assert "webgpu" not in classic
    assert "three/dist/webgpu/" in webgpu
    assert "three/dist/webgl/" not in webgpu


@pytest.mark.parametrize("name", ["name", "webgpuName"])
def test_a_name_costs_nothing_but_itself(bundles, name: str) -> None:
    assert bundles[name]["nBytes"] < 300
