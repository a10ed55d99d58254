"""Files that people drop on the viewer: each does what it is for, and damaged ones say what is wrong."""

from __future__ import annotations

import re

import numpy as np
import pytest

from .viewer_files import CAMERA_EYE
from .viewer_tours import SOURCES, Found, pixels, steps_apart

SUFFIXES = ("safetensors", "safetensors.zst", "bin")
HOSTILE = {  # by file, what the panel says of it
    "cut.glb": r"Expected \d+ bytes at 0, found a file of \d+",
    "no-json.glb": "Its JSON is damaged",
    "light.glb": r"(?s)Expected a KTX 2\.0 texture\..*/extensions/IRRADIA_lighting/lightmap",
    "cut.safetensors": r"Expected \d+ bytes of tensors, found \d+",
    "cut.safetensors.zst": r"Expected \d+ bytes unpacked, found \d+",
    "infinite.safetensors": r"(?s)Some numbers are infinite or not numbers\..*position\.level\.1",
    "cut.bin": r"Expected over 1024 weights, found \d+",
    "cut.hdr": "Expected more pixels, found the end",
    "cut.exr": "Expected an OpenEXR picture in colour, found: invalid zlib data",
    "cut.png": "Expected a PNG or JPEG picture, found damaged bytes",
    "notes.txt": "Expected a file that the viewer knows, found another",
    "empty.glb": r"Expected a \.glb of glTF 2\.0",
}


@pytest.fixture(scope="module")
def drops(tour) -> Found:
    return tour("drops")


@pytest.fixture(scope="module")
def hostile(tour) -> Found:
    return tour("hostile")


def test_an_empty_page_invites_files(drops):
    assert drops["told"]["empty"]["state"] == "empty"
    assert drops["invitation"] == ["Drop a baked scene"]


def test_a_dropped_scene_is_lit_by_all_that_it_holds(drops):
    assert drops["told"]["scene"]["state"] == "ready"
    assert drops["told"]["scene"]["backend"] == "webgpu"
    assert drops["first"]["ids"] == [*SOURCES, "none"]
    assert pixels(drops["first"]["picture"]).std() > 10


def test_a_field_without_a_scene_is_told_what_it_needs(drops):
    assert drops["told"]["early"]["state"] == "error"
    assert "Drop its scene first." in drops["early"][0]


def test_fields_become_sources_whatever_file_they_come_in(drops):
    assert drops["afterFields"] == [*SOURCES, *(f"field:field.{suffix}" for suffix in SUFFIXES), "none"]


def test_renders_become_references(drops):
    assert drops["afterPictures"][-3:] == ["reference", "reference:1", "reference:2"]


def test_a_panorama_is_seen_behind_the_scene(drops):
    assert drops["told"]["sky"]["state"] == "ready"
    (dark, sky) = (pixels(drops[name])[2, 2] for name in ("dark", "sky"))
    assert np.ptp(dark) < 12, "the backdrop is grey"
    assert sky[2] > sky[0] + 20, "the sky is blue"


def test_a_dropped_camera_is_looked_from(drops):
    np.testing.assert_allclose(drops["camera"]["eye"], CAMERA_EYE, atol=1e-6)


def test_good_files_are_no_reason_to_complain(drops):
    assert drops["complaints"] == []


@pytest.mark.parametrize(("file", "words"), HOSTILE.items(), ids=HOSTILE)
def test_a_damaged_file_opens_a_panel_that_says_what_was_found(hostile, file, words):
    panel = hostile["panels"][file]
    assert panel["told"]["state"] == "error"
    assert f"Can't open {file}" in panel["texts"][0]
    assert re.search(words, panel["texts"][0])


def test_each_hostile_file_was_dropped(hostile):
    assert set(hostile["panels"]) == set(HOSTILE)


def test_the_scene_before_outlives_damaged_files(hostile):
    assert steps_apart(pixels(hostile["before"]), pixels(hostile["after"])) <= 1


def test_a_closed_panel_is_gone_and_gives_the_keys_back(hostile):
    assert hostile["closed"] == []
    assert hostile["focused"] == "view"


def test_a_folder_without_a_scene_is_told_as_such(hostile):
    assert len(hostile["folderTexts"]) == 1
    assert "Expected files that the viewer knows, found none." in hostile["folderTexts"][0]


def test_an_address_without_a_file_is_told_as_such(hostile):
    assert hostile["lost"]["state"] == "error"
    assert "404" in hostile["lostTexts"][0]


def test_a_browser_alone_speaks_of_the_missing_file(hostile):
    assert [text for text in hostile["complaints"] if "404" not in text] == []


def test_a_page_that_holds_its_files_opens_them_without_a_server(tour):
    found = tour("kept")
    assert found["told"]["state"] == "ready"
    assert found["choices"] == [*SOURCES, "field:0", "none", "reference"]
    assert found["complaints"] == []


def test_a_kiosk_shows_the_picture_alone_from_the_pose_asked_for(tour):
    found = tour("kept")
    assert found["chrome"] == 0
    np.testing.assert_allclose(found["camera"]["eye"], (0.3, 0.2, -0.5), atol=1e-6)
