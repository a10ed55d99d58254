"""Surfaces as the bake saw them: three.js then draws what `irradia render` and `irradia eval` draw."""

from __future__ import annotations

import base64
import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from irradia.transport.gbuffer import picture_under
from irradia.transport.render import RenderOptions

from .pixels import BACKENDS, ask, view_of
from .swatches import COLUMNS, light_of, means, swatches, write_swatches

WIDTH_PX, HEIGHT_PX = 176, 44
SPP = 256
BAKED = {"use": "field", "surfacesAs": "baked"}
STEPS: dict[str, dict[str, dict[str, Any]]] = {
    "dark": {
        "baked": BAKED,
        "by another": {"use": "lightmap"},
        "again": BAKED,
        "surrounded": {"surroundings": 0.5},
    },
    "lit": {"baked": BAKED},
    # What three.js draws behind glass, WebGPURenderer can't in floats on WebGL2.
    "without panes": {
        "materials": {"use": "field"},
        "baked": BAKED,
        "as before": {"surfacesAs": "materials"},
        "again": BAKED,
    },
}


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("swatches")
    paths = {name: folder / f"{name}.glb" for name in STEPS}
    write_swatches(paths["dark"])
    write_swatches(paths["lit"], "realtime")
    write_swatches(paths["without panes"], has_panes=False)
    return paths


@pytest.fixture(scope="module", params=BACKENDS)
def shots(web_check, chromium: str, files: dict[str, Path], tmp_path_factory, request) -> dict[str, Any]:
    """Pictures and what else the page said, by scene and step."""
    view = view_of(swatches().cameras[0], WIDTH_PX, HEIGHT_PX)
    jobs = tmp_path_factory.mktemp("jobs") / "jobs.json"
    asked = [
        {"backend": request.param, "scene": f"/{name.split()[0]}.glb", "view": view, "plugins": "irradia"}
        | {"steps": list(STEPS[name].values())}
        for name in files
    ]
    jobs.write_text(json.dumps(asked))
    served = [f"/{name.split()[0]}.glb={path}" for name, path in files.items()]
    found = dict(zip(files, web_check("plugin", jobs, chromium, *served), strict=True))
    return {
        name: dict(zip(STEPS[name], map(_shot, report["shots"]), strict=True))
        for name, report in found.items()
    }


@pytest.fixture(scope="module")
def reference() -> NDArray[np.float64]:
    """Mean colours of the squares in the light of the field, by the renderer."""
    return _reference(None)


def _reference(lamp: Any) -> NDArray[np.float64]:
    scene = swatches(lamp)
    light = partial(_irradiance, light_of(scene))
    return means(picture_under(scene, scene.cameras[0], RenderOptions(WIDTH_PX, HEIGHT_PX, SPP), light))


def _irradiance(field: Any, positions: NDArray, normals: NDArray) -> NDArray:
    return field.irradiance(positions, normals).astype(np.float32)


def _shot(told: dict[str, Any]) -> dict[str, Any]:
    rgba = np.frombuffer(base64.b64decode(told["picture"]), "<f4").reshape(HEIGHT_PX, WIDTH_PX, 4)
    return {**told, "picture": rgba[..., :3]}


def test_every_paint_reflects_what_the_bake_lets_it(shots, reference) -> None:
    found = means(shots["dark"]["baked"]["picture"])
    np.testing.assert_allclose(found[1], reference[1], rtol=0.003)


def test_panes_tint_what_is_behind_them_and_add_their_own_light(shots, reference) -> None:
    found = means(shots["dark"]["baked"]["picture"])
    assert found.shape[1] == COLUMNS
    np.testing.assert_allclose(found[0], reference[0], rtol=0.03, atol=0.003)  # the reference is noisy here
    np.testing.assert_allclose(found[0].mean(), reference[0].mean(), rtol=0.01)


def test_live_lights_are_reflected_as_evenly(shots) -> None:
    np.testing.assert_allclose(
        means(shots["lit"]["baked"]["picture"])[1], _reference("realtime")[1], rtol=0.01
    )


@pytest.mark.parametrize("backend", BACKENDS)
def test_passes_over_the_screen_see_through_panes(
    files, web_check, chromium: str, tmp_path: Path, backend: str
) -> None:
    kinds = ("inline", "full", "half")
    request = {
        "backend": backend,
        "scene": "/dark.glb",
        "view": view_of(swatches().cameras[0], WIDTH_PX, HEIGHT_PX),
        "channels": [],
        "fields": {},
        "pictures": {how: {"source": "field", "how": how, "surfacesAs": "baked"} for how in kinds},
    }
    (answer,) = ask(web_check, chromium, tmp_path, [request], {"/dark.glb": files["dark"]})
    inline, full, half = (means(answer.pictures[how][..., :3].astype(np.float32)) for how in kinds)
    assert inline.min() > 0.005
    np.testing.assert_allclose(full, inline, rtol=1e-3)
    np.testing.assert_allclose(half, inline, rtol=0.01)


def test_full_materials_are_darker_and_come_back_unchanged(shots, reference) -> None:
    plain = shots["without panes"]
    assert means(plain["materials"]["picture"])[1, 1].max() < 0.1 * reference[1, 1].max()  # metal
    np.testing.assert_array_equal(plain["as before"]["picture"], plain["materials"]["picture"])


def test_coming_back_compiles_nothing_and_makes_no_materials(shots) -> None:
    for name, before in (("dark", "by another"), ("without panes", "as before")):
        shot = shots[name]
        np.testing.assert_array_equal(shot["again"]["picture"], shot["baked"]["picture"])
        for what in ("nMaterials", "nCompiled", "bytes"):
            assert shot["again"][what] == shot[before][what] > 0


def test_the_sky_counts_once(shots) -> None:
    dark = shots["dark"]
    np.testing.assert_allclose(dark["surrounded"]["picture"], dark["again"]["picture"], atol=1e-4)
