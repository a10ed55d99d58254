"""Links to views, hands on the picture, other browsers, and the size of it all."""

from __future__ import annotations

import gzip
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from .viewer_tours import SOURCES, Found, pixels, steps_apart

MAX_BYTES = 400_000  # packed
LOW_ROOM = 0.6  # share of a low room at which eyes are
DEPTH_M = 0.5592  # of the room, from the camera on


@pytest.fixture(scope="module")
def links(tour) -> Found:
    return tour("links")


@pytest.fixture(scope="module")
def hands(tour) -> Found:
    return tour("hands")


@pytest.fixture(scope="module")
def fingers(tour) -> Found:
    return tour("fingers")


@pytest.fixture(scope="module")
def webgl2(tour) -> Found:
    return tour("webgl2")


def test_a_link_shows_what_its_sender_saw(links):
    assert links["after"]["state"] == links["before"]["state"]
    assert steps_apart(pixels(links["after"]["picture"]), pixels(links["before"]["picture"])) <= 1
    assert links["complaints"] == []


def test_a_link_names_only_what_is_unusual(links):
    keys = set(re.findall(r"(\w+)=", links["hash"]))
    assert keys == {
        "left",
        "right",
        "compare",
        "split",
        "tone",
        "ev",
        "camera",
        "object",
        "place",
        "panel",
    }


def test_a_link_without_a_camera_shows_the_scene_through_its_own(links):
    assert "plain" not in links, "undefined in JSON"
    assert steps_apart(pixels(links["home"]), pixels(links["fresh"])) <= 1


def test_files_dropped_while_a_scene_is_read_belong_to_it(links):
    assert links["dropped"]["ids"] == [*SOURCES, "field:field.safetensors", "none", "reference"]
    assert links["dropped"]["told"]["state"] == "ready"


def test_a_scene_that_takes_anothers_place_is_seen_through_its_own_camera(links):
    assert "kept" not in links["dropped"], "undefined in JSON"
    assert "place" not in links["dropped"]


def test_an_object_goes_where_it_is_dragged(hands):
    (x0, y0, _), (x1, y1, _) = hands["places"]
    assert abs(x1 - x0) > 0.02
    assert abs(y1 - y0) < 0.02
    assert "still" not in hands, "the camera stays where it is"


def test_dragging_beside_it_orbits(hands):
    eye, target = (np.array(hands["orbited"][key]) for key in ("eye", "target"))
    assert np.linalg.norm(eye - target) == pytest.approx(0.8 + 0.2796, abs=0.03)
    assert abs(eye[0] - 0.278) > 0.05


def test_the_right_button_walks_on_without_turning(hands):
    before, after = hands["flown"], hands["strode"]
    way = np.subtract(after["eye"], before["eye"])
    ahead = np.subtract(before["target"], before["eye"])
    assert np.linalg.norm(way) > 0.005
    assert way @ ahead / np.linalg.norm(way) / np.linalg.norm(ahead) > 0.99


def test_arrows_on_the_splitter_move_the_splitter_alone(hands):
    assert hands["split"] == pytest.approx(0.52)
    assert hands["afterArrow"] == hands["walked"]


def test_keys_work_after_a_click_on_a_setting(hands):
    assert hands["afterRadio"]["navigation"] == "fly"
    assert hands["afterRadio"]["view"] == "irradiance"


def test_one_finger_turns_two_walk(fingers):
    start = {"eye": np.array([0.28, 0.27, -0.3]), "target": np.array([0.28, 0.27, 0.2])}
    orbited, looked, strode = (
        {key: np.array(fingers[name][key]) for key in start} for name in ("orbited", "looked", "strode")
    )
    assert np.linalg.norm(orbited["eye"] - start["eye"]) > 0.02
    np.testing.assert_allclose(orbited["target"], start["target"], atol=1e-6)
    np.testing.assert_allclose(looked["eye"], start["eye"], atol=1e-6)
    assert np.linalg.norm(looked["target"] - start["target"]) > 0.02
    way = strode["eye"] - start["eye"]
    assert way[2] > 0.005
    assert np.abs(way[:2]).max() < 1e-3
    np.testing.assert_allclose(strode["target"] - strode["eye"], [0, 0, 0.5], atol=1e-3)


def test_a_finger_drags_the_splitter(fingers):
    assert fingers["split"] == pytest.approx(0.75, abs=0.02)


def test_fingers_are_no_reason_to_complain(fingers):
    assert fingers["complaints"] == []


def test_w_flies_forward(hands):
    before, after = (np.array(hands[key]["eye"]) for key in ("orbited", "flown"))
    ahead = np.array(hands["orbited"]["target"]) - before
    way = after - before
    assert np.linalg.norm(way) > 0.005
    assert way @ ahead / np.linalg.norm(way) / np.linalg.norm(ahead) > 0.99


def test_who_walks_stands_on_the_floor_and_stops_at_walls(hands):
    _, y, z = hands["walked"]["eye"]
    assert y == pytest.approx(0.55 * LOW_ROOM, abs=0.03)
    assert 0.16 < z < DEPTH_M - 0.02


def test_keys_do_what_the_help_says(hands):
    assert hands["isHelpOpen"]
    assert hands["compare"] == "split"
    assert hands["navigation"] == "walk"


def test_the_picture_fills_windows_of_any_size(hands):
    assert hands["size"]["layout"] == [200, 300 - 44]
    assert hands["size"]["canvas"] == [200, 300 - 44]


def test_the_canvas_has_the_pixels_of_the_display(hands):
    assert hands["dense"]["layout"] == [200, 300 - 44]
    assert hands["dense"]["canvas"] == [400, 2 * (300 - 44)]


def test_on_narrow_screens_the_panel_lies_below_the_picture(hands):
    assert hands["panel"]["width"] == 200
    assert hands["panel"]["y"] > 100


def test_statistics_name_what_costs(hands):
    labels = {row["label"] for row in hands["statistics"]}
    assert labels >= {"Backend", "Picture", "Triangles", "File"}
    assert labels >= {"Light on the wire", "Light on GPU", "Work", "Fetches"}


def test_hands_are_no_reason_to_complain(hands):
    assert hands["complaints"] == []


def test_a_browser_without_webgpu_draws_with_webgl2(webgl2):
    assert webgl2["told"]["backend"] == "webgl2"
    assert webgl2["told"]["state"] == "ready"
    assert pixels(webgl2["before"]).std() > 10
    assert 0 < webgl2["difference"]["flip"] < 1
    assert webgl2["complaints"] == []


def test_a_lost_context_is_told_and_replaced(webgl2):
    assert any("lost" in message for message in webgl2["messages"])
    assert webgl2["recovered"]["state"] == "ready"
    assert steps_apart(pixels(webgl2["after"]), pixels(webgl2["before"])) <= 1


def test_a_lost_device_of_webgpu_is_told_and_replaced(tour):
    found = tour("crash")
    assert found["told"]["backend"] == "webgpu"
    assert any("lost" in message for message in found["messages"])
    assert found["recovered"]["state"] == "ready"
    assert steps_apart(pixels(found["after"]), pixels(found["before"])) <= 1
    assert all("Instance reference" in words for words in found["complaints"]), "Chromium's own words"


def test_the_page_is_three_files_that_name_each_other_relatively(built_viewer: Path):
    assert {path.name for path in built_viewer.iterdir()} == {"index.html", "viewer.js", "viewer.css"}
    page = (built_viewer / "index.html").read_text(encoding="utf-8")
    assert page.count('<link rel="stylesheet" href="./viewer.css">') == 1
    assert page.count('<script type="module" src="./viewer.js"></script>') == 1
    assert page.count('<meta charset="utf-8">') == 1


def test_all_code_is_at_most_400_kb_packed(built_viewer: Path):
    packed = sum(len(gzip.compress(path.read_bytes(), 9)) for path in built_viewer.iterdir())
    assert packed <= MAX_BYTES


def test_state_files_and_exposure_hold_to_their_laws_in_node(web_check, repo_root: Path):
    folder = repo_root / "web" / "viewer"
    subprocess.run(["npx", "tsc", "--project", folder / "test"], cwd=folder, check=True)
    done = subprocess.run(
        ["node", "--test", "build/"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout
