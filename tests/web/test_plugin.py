"""@irradia/three lights a scene in Chromium: the same laws on three.js' three backends."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from irradia.scene.builtin.mesh import look_at
from irradia.scene.types import Camera

from .court import MASK_SHARES, PANE_M, VALIDITIES, court, made_validity, write_court
from .made_light import PAGE_PX
from .pixels import BACKENDS, view_of

WIDTH_PX, HEIGHT_PX = 96, 64
CLOSE = 1e-5  # sums and products in another order
MAGENTA = (1.0, 0.0, 1.0)
OUTSIDE, HIDDEN, WHOLE = np.array([(0.08, 0.13, 0.24), (0.75, 0.03, 0.02), (0.38, 0.48, 0.4)])
FILES: dict[str, dict[str, Any]] = {
    "plain": {},
    "instanced": {"instanced": True},
    "live": {"torch": "realtime"},
    "masked": {"torch": "mixed"},
    "direct": {"direct": True},
    "sunless": {"sun": "realtime"},
}
BALL = {"centre": [0.0, 0.9, 0.4], "radius": 0.3, "isLit": True}  # against the void
# By name: file, plugins, and by name the steps before each picture.
JOBS: dict[str, tuple[str, str, dict[str, dict[str, Any]]]] = {
    "plain": (
        "plain",
        "irradia",
        {
            "lightmap": {"use": "lightmap"},
            "irradiance": {"view": "irradiance"},
            "albedo": {"view": "albedo"},
            "field": {"view": None, "use": "field"},
            "probes": {"use": "probes"},
            "again": {"use": "lightmap"},
            "bright": {"intensity": 2},
            "occluded": {"intensity": 1, "occlusion": 0.25},
            "surrounded": {"occlusion": 1, "surroundings": 0.5},
            "black paint": {"black": True},
        },
    ),
    "both": ("plain", "both", {"lightmap": {}}),
    "instanced": (
        "instanced",
        "irradia",
        {"lightmap": {}, "field": {"use": "field"}},
    ),
    "live": (
        "live",
        "irradia",
        {"lightmap": {}, "none": {"use": "none"}, "field": {"use": "field"}},
    ),
    "masked": (
        "masked",
        "irradia",
        {"none": {"use": "none"}, "lightmap": {"use": "lightmap"}, "again": {"use": "none"}},
    ),
    "direct": ("direct", "irradia", {"irradiance": {"view": "irradiance", "use": "field"}}),
    "without map": ("plain", "irradia", {"irradiance": {"view": "irradiance", "use": "field"}}),
    "ball": (
        "plain",
        "irradia",
        {
            "void": {},
            "lit": {"ball": BALL},
            "by probes": {"dynamicSource": "probes"},
            "by probes in live lights": {"use": "field"},
            "in live lights": {"dynamicSource": "field"},
            "unlit": {"use": "lightmap", "dynamicSource": None},
            "disposed": {"dispose": True},
        },
    ),
    "ball beside map": ("direct", "irradia", {"lit": {"use": "field", "ball": BALL}}),
    "below": (
        "plain",
        "irradia",
        {"normal": {"view": "normal"}, "irradiance": {"view": "irradiance", "use": "probes"}},
    ),
    "validity": (
        "plain",
        "irradia",
        {
            "lightmap": {"view": "validity"},
            "normal": {"view": "normal"},
            "uv": {"view": "lightmap-uv"},
            "field": {"view": "validity", "use": "field"},
        },
    ),
    "sunless": ("sunless", "irradia", {"lightmap": {}}),
    "damaged": ("damaged", "irradia", {}),
}
BELOW = Camera(look_at((0.0, -2.0, 0.1), (0.0, 0.0, 0.0)), yfov_rad=0.5, name="below")


@dataclass(frozen=True)
class Shot:
    """A drawing: (H, W, 3) linear, row 0 the top, and what the light said of itself."""

    pixels: NDArray[np.float32]
    told: dict[str, Any]


@pytest.fixture(scope="session")
def files(tmp_path_factory) -> dict[str, Path]:
    """Courts by name."""
    folder = tmp_path_factory.mktemp("courts")
    paths = {name: folder / f"{name}.glb" for name in (*FILES, "damaged")}
    for name, kind in FILES.items():
        write_court(paths[name], **kind)
    whole = paths["plain"].read_bytes()
    assert b'"page":1' in whole
    paths["damaged"].write_bytes(whole.replace(b'"page":1', b'"page":7', 1))
    return paths


@pytest.fixture(scope="session", params=BACKENDS)
def reports(web_check, chromium: str, files: dict[str, Path], tmp_path_factory, request) -> dict[str, Any]:
    """What the page answers to all jobs on one backend."""
    cameras = {"below": BELOW}
    usual = court(instanced=False, torch="baked").cameras[0]
    views = {name: view_of(cameras.get(name, usual), WIDTH_PX, HEIGHT_PX) for name in JOBS}
    asked = [
        {"backend": request.param, "scene": f"/{file}.glb", "view": views[name], "plugins": plugins}
        | {"steps": list(steps.values())}
        for name, (file, plugins, steps) in JOBS.items()
    ]
    jobs = tmp_path_factory.mktemp("jobs") / "jobs.json"
    jobs.write_text(json.dumps(asked))
    served = [f"/{name}.glb={path}" for name, path in files.items()]
    found = dict(zip(JOBS, web_check("plugin", jobs, chromium, *served), strict=True))
    assert {report["backend"] for report in found.values()} == {request.param}
    return found


@pytest.fixture
def shots(reports: dict[str, Any]) -> dict[str, dict[str, Shot]]:
    """By job, by step."""
    return {
        job: dict(zip(JOBS[job][2], map(shot_of, report["shots"]), strict=True))
        for job, report in reports.items()
        if "refusal" not in report
    }


def shot_of(told: dict[str, Any]) -> Shot:
    rgba = np.frombuffer(base64.b64decode(told["picture"]), "<f4").reshape(HEIGHT_PX, WIDTH_PX, 4)
    return Shot(rgba[..., :3], told)


def opaque() -> NDArray[np.bool_]:
    """(H, W) pixels that don't show the pane."""
    camera = court(instanced=False, torch="baked").cameras[0]
    corners = np.concatenate([PANE_M, np.ones((4, 1))], axis=1) @ np.linalg.inv(camera.world_from_camera).T
    assert camera.yfov_rad is not None
    scale = 0.5 * HEIGHT_PX / np.tan(0.5 * camera.yfov_rad)
    columns = 0.5 * WIDTH_PX + scale * corners[:, 0] / -corners[:, 2]
    rows = 0.5 * HEIGHT_PX - scale * corners[:, 1] / -corners[:, 2]
    row, column = np.mgrid[:HEIGHT_PX, :WIDTH_PX] + 0.5
    margin = 2
    is_beside = (column < columns.min() - margin) | (column > columns.max() + margin)
    return is_beside | (row < rows.min() - margin) | (row > rows.max() + margin)


def matte(albedo: Shot) -> NDArray[np.bool_]:
    """(H, W) pixels of the floor, the only grey thing."""
    return (albedo.pixels > 0.7).all(axis=-1) & opaque()


def test_a_file_has_the_sources_that_were_put_in(reports) -> None:
    names = ["lightmap", "field", "probes", "three-probes", "none"]
    found = reports["plain"]["sources"]
    assert [source["name"] for source in found] == names
    assert [source["quantity"] for source in found][:3] == ["full", "indirect", "full"]
    assert [source["name"] for source in found if source["isDynamic"]] == ["field", "probes"]


def test_matte_paint_shows_its_colour_times_its_irradiance_over_pi(shots) -> None:
    plain = shots["plain"]
    floor = matte(plain["albedo"])
    assert floor.sum() > 1000
    expected = plain["albedo"].pixels * plain["irradiance"].pixels
    np.testing.assert_allclose(plain["lightmap"].pixels[floor], expected[floor], atol=CLOSE)


def test_coming_back_to_a_source_gives_its_picture_and_makes_nothing_new(shots) -> None:
    plain = shots["plain"]
    np.testing.assert_array_equal(plain["again"].pixels, plain["lightmap"].pixels)
    assert np.abs(plain["probes"].pixels - plain["lightmap"].pixels).max() > 0.1
    for what in ("nMaterials", "nCompiled", "bytes"):
        assert plain["again"].told[what] == plain["probes"].told[what] > 0
    assert plain["probes"].told["nCompiled"] > plain["field"].told["nCompiled"]


def test_intensity_is_a_factor(shots) -> None:
    plain = shots["plain"]
    where = opaque()
    np.testing.assert_allclose(plain["bright"].pixels[where], 2 * plain["lightmap"].pixels[where], atol=CLOSE)


def test_occlusion_maps_take_nothing_from_light_that_holds_occlusion(shots) -> None:
    where = opaque()
    plain = shots["plain"]
    np.testing.assert_allclose(plain["occluded"].pixels[where], plain["lightmap"].pixels[where], atol=CLOSE)


def test_of_the_surroundings_only_reflections_are_added(shots) -> None:
    plain, where = shots["plain"], opaque()
    reflections = plain["black paint"].pixels
    expected = plain["lightmap"].pixels + reflections
    np.testing.assert_allclose(plain["surrounded"].pixels[where], expected[where], atol=2 * CLOSE)
    floor = matte(plain["albedo"])
    assert reflections[floor].max() < CLOSE
    assert reflections[where].max() > 0.01  # on the glossy cubes


def test_another_plugin_for_lightmaps_adds_no_light(shots) -> None:
    np.testing.assert_array_equal(shots["both"]["lightmap"].pixels, shots["plain"]["lightmap"].pixels)


@pytest.mark.parametrize("source", ["lightmap", "field"])
def test_instances_are_lit_like_nodes(shots, source: str) -> None:
    difference = np.abs(shots["instanced"][source].pixels - shots["plain"][source].pixels)
    assert difference.max() < CLOSE


def test_lights_that_stay_live_shine_on_top_of_the_lightmap(shots) -> None:
    where, live = opaque(), shots["live"]
    shine = live["lightmap"].pixels - shots["plain"]["lightmap"].pixels
    np.testing.assert_allclose(shine[where], live["none"].pixels[where], atol=CLOSE)
    assert shine[where].max() > 0.1
    assert [live[name].told["shining"] for name in ("lightmap", "none")] == [[True] * 3 + [False]] * 2


def test_live_lights_have_their_baked_shadows(shots) -> None:
    where, masked = opaque(), shots["masked"]
    unmasked = shots["live"]["none"].pixels
    share = masked["none"].pixels[where] / np.maximum(unmasked[where], 1e-6)
    lit = unmasked[where] > 1e-3
    by_page = np.abs(share[lit][:, None] - MASK_SHARES)
    assert by_page.min(axis=1).max() < 0.5 / 255 + 1e-4
    assert (by_page < 0.01).sum(axis=0).min() > 30  # both pages are seen
    expected = masked["none"].pixels + shots["plain"]["lightmap"].pixels
    np.testing.assert_allclose(masked["lightmap"].pixels[where], expected[where], atol=CLOSE)
    np.testing.assert_array_equal(masked["again"].pixels, masked["none"].pixels)


def test_each_light_shines_only_where_its_first_bounce_is_missing(shots) -> None:
    told = {
        (job, name): (shot.told["directFrom"], sum(shot.told["shining"]))
        for job, steps in shots.items()
        for name, shot in steps.items()
    }
    assert told["plain", "lightmap"] == ("source", 0)
    assert told["plain", "field"] == ("lights", 4)
    assert told["live", "field"] == ("lights", 4)
    assert told["plain", "probes"] == ("source", 0)  # of all light
    assert told["direct", "irradiance"] == ("map", 0)


def test_a_map_of_direct_light_is_added_to_a_field_of_indirect_light(shots, reports) -> None:
    added = shots["direct"]["irradiance"].pixels - shots["without map"]["irradiance"].pixels
    hit = matte(shots["plain"]["albedo"])
    assert added[hit].min() > 0.19  # the map goes from 0.2 to 0.6
    assert added[hit].max() < 0.61
    assert np.ptp(added[hit]) > 0.2


def test_what_moves_is_lit_by_the_dynamic_source(shots) -> None:
    void, lit, by_probes, unlit = (
        shots["ball"][name].pixels for name in ("void", "lit", "by probes", "unlit")
    )
    ball = (void.max(axis=-1) == 0.0) & (lit.min(axis=-1) > 0.05)
    assert ball.sum() > 50
    assert by_probes[ball].min() > 0.05
    assert np.abs(lit - by_probes)[ball].max() > 0.01
    assert unlit[ball].max() == 0.0


def test_what_moves_has_each_first_bounce_once_wherever_surfaces_have_it_from(shots) -> None:
    """From live lights, from the lightmap, or from a map of direct light; there by lights of its own."""
    ball, beside_map = shots["ball"], shots["ball beside map"]["lit"]
    where = (ball["void"].pixels.max(axis=-1) == 0.0) & (ball["lit"].pixels.min(axis=-1) > 0.05)
    in_live_lights = ball["in live lights"].pixels[where]
    assert [sum(shot.told["shining"]) for shot in (ball["in live lights"], ball["lit"], beside_map)] == [
        4,
        0,
        0,
    ]
    for shot in (ball["lit"], beside_map):
        np.testing.assert_allclose(shot.pixels[where], in_live_lights, rtol=1e-4, atol=CLOSE)
    taken_away = ball["by probes in live lights"].pixels[where]
    np.testing.assert_allclose(taken_away, ball["by probes"].pixels[where], rtol=1e-4, atol=CLOSE)


def test_texels_show_their_own_validity_unmixed(shots) -> None:
    seen, normal, uv = (shots["validity"][name].pixels for name in ("lightmap", "normal", "uv"))
    floor = matte(shots["plain"]["albedo"])
    place = PAGE_PX * uv[floor][:, :2] / (2.0 * uv[floor][:, 2:])  # undoes the checker
    column, row = np.floor(place).astype(int).T
    inside = (np.abs(place - np.round(place)) > 0.01).all(axis=1)
    expected = validity_colour(made_validity()[0, row, column], normal[floor][:, 1])
    np.testing.assert_allclose(seen[floor][inside], expected[inside], atol=1e-3)
    assert inside.sum() > 1000

    cubes = opaque() & ~floor & (normal.max(axis=-1) > 0.0)
    codes = np.array(VALIDITIES).ravel()
    colours = validity_colour(codes[:, None], normal[cubes][:, 1])
    nearest = np.abs(colours - seen[cubes]).max(axis=-1)
    assert nearest.min(axis=0).max() < 1e-3
    assert np.bincount(nearest.argmin(axis=0), minlength=len(codes)).min() > 10


def validity_colour(codes: NDArray, height: NDArray) -> NDArray:
    """What the view shows of codes, by the green of the view of normals."""
    share = (codes[..., None] - 1.0) / 254.0
    colour = np.where(codes[..., None] == 0, OUTSIDE, HIDDEN + (WHOLE - HIDDEN) * share)
    return colour * (0.6 + 0.4 * height[..., None])


def test_a_source_without_validity_shows_that_it_lacks_it(shots) -> None:
    field = shots["validity"]["field"].pixels[matte(shots["plain"]["albedo"])]
    np.testing.assert_allclose(field, np.broadcast_to(MAGENTA, field.shape), atol=CLOSE)


def test_a_lightmap_without_its_sun_says_so(reports, shots) -> None:
    quantities = {source["name"]: source["quantity"] for source in reports["sunless"]["sources"]}
    assert quantities["lightmap"] == "indirect"
    told = shots["sunless"]["lightmap"].told
    assert (told["directFrom"], any(told["shining"])) == ("none", False)


def test_disposing_of_the_light_leaves_the_scene_as_it_came(shots) -> None:
    assert shots["ball"]["disposed"].pixels.max() == 0.0


def test_the_back_of_a_double_sided_surface_is_lit_from_its_own_side(shots) -> None:
    normal = shots["below"]["normal"].pixels
    np.testing.assert_allclose(normal, np.broadcast_to((0.5, 0.0, 0.5), normal.shape), atol=CLOSE)
    assert shots["below"]["irradiance"].pixels.min() > 0.0


def test_damage_is_refused_with_its_place(reports) -> None:
    assert "/extensions/IRRADIA_lighting/primitives/0/page" in reports["damaged"]["refusal"]
