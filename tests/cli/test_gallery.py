"""``irradia gallery``: pictures from a real browser, and what becomes of fields that can't be shown."""

from __future__ import annotations

import io
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from irradia.cli import app, gallery_job
from irradia.cli.gallery_browser import BrowserError, open_page
from irradia.cli.gallery_shots import find_shots
from irradia.core.errors import MissingDependencyError
from irradia.export.web_folder import collect

from .viewing import WEIGHTS, glb, viewer, write_results

__all__ = ["viewer"]
# Shows each source as a colour, and its exposure as green.
PAINTER = """
const asked = new URLSearchParams(location.search);
const root = document.documentElement;
const colours = { reference: [200, 0, 0], "field:0": [0, 0, 200] };
const canvas = new OffscreenCanvas(innerWidth, innerHeight);
const context = canvas.getContext("2d");
async function show() {
  const manifest = await (await fetch("manifest.json")).json();
  const field = manifest.scenes[0].fields[0];
  if (manifest.scenes[0].fields.length > 1) throw new Error("more than it needs");
  if (field && field.name === "slow") return new Promise(() => {});
  if (field && field.name === "refused") throw new Error("this field is not for me");
  if (asked.get("kiosk") !== "1") throw new Error("not alone");
  const ev = asked.has("ev") ? Number(asked.get("ev")) : 3.5;
  const [r, g, b] = colours[asked.get("left")];
  context.fillStyle = `rgb(${r} ${Math.round(10 * ev)} ${b})`;
  context.fillRect(0, 0, innerWidth, innerHeight);
  root.dataset.ev = String(ev);
  root.dataset.camera = asked.get("camera") ?? asked.get("pose");
}
root.dataset.state = "loading";
const ready = show().then(
  () => { root.dataset.state = "ready"; },
  (error) => { root.dataset.message = error.message; root.dataset.state = "error"; },
);
globalThis.irradiaViewer = { ready, picture: () => canvas.convertToBlob() };
"""


@pytest.fixture
def gallery(capfd, chromium: str):
    def run(*arguments: Any) -> tuple[int, dict[str, Any]]:
        code = app.run(["gallery", "--width", "64", *map(str, arguments), "--json"])
        return code, json.loads(capfd.readouterr().out)

    return run


@pytest.fixture
def painter(viewer: Path) -> None:
    (viewer / "viewer.js").write_text(PAINTER)


@pytest.fixture
def baked(painter: None, tmp_path: Path) -> Path:
    return write_results(tmp_path / "out")


def cells(sheet: Path) -> set[tuple[int, ...]]:
    """The colours of which a sheet has many pixels."""
    pixels = np.asarray(Image.open(sheet).convert("RGB")).reshape(-1, 3)
    found, counts = np.unique(pixels, axis=0, return_counts=True)
    return {tuple(map(int, colour)) for colour, count in zip(found, counts, strict=True) if count > 1500}


def test_every_source_is_on_the_sheet_at_one_exposure(gallery, baked: Path, tmp_path: Path) -> None:
    code, said = gallery(baked, "-o", tmp_path / "sheet.png")
    assert code == 0, said
    assert [each["name"] for each in said["pictures"]] == ["reference", "field"]
    assert said["exposure_ev"] == 3.5
    assert {(200, 35, 0), (0, 35, 200)} <= cells(tmp_path / "sheet.png")


def test_an_exposure_that_is_given_holds(gallery, baked: Path, tmp_path: Path) -> None:
    gallery(baked, "-o", tmp_path / "sheet.png", "--ev", 2)
    assert {(200, 20, 0), (0, 20, 200)} <= cells(tmp_path / "sheet.png")


def test_fields_that_cannot_be_shown_are_told_of_and_the_rest_is_there(
    gallery, baked: Path, tmp_path: Path
) -> None:
    (baked / "cut.safetensors").write_bytes(WEIGHTS.read_bytes()[:-100])
    for name in ("refused", "slow", "z"):
        shutil.copyfile(WEIGHTS, baked / f"{name}.safetensors")
    code, said = gallery(baked, "-o", tmp_path / "sheet.html", "--timeout", 2)
    assert code == 2
    assert not said["ok"]
    errors = {each["name"]: each["error"] for each in said["pictures"]}
    assert errors["reference"] is errors["field"] is errors["z"] is None
    assert "damaged" in errors["cut"]
    assert errors["refused"] == "this field is not for me"
    assert "isn't ready after" in errors["slow"]
    page = (tmp_path / "sheet.html").read_text()
    assert page.count("data:image/png;base64,") == 3
    assert "this field is not for me" in page


def test_a_folder_of_weights_is_seen_in_a_scene_from_elsewhere(gallery, baked: Path, tmp_path: Path) -> None:
    for run in ("a", "b"):
        (tmp_path / "sweep" / run).mkdir(parents=True)
        shutil.copyfile(WEIGHTS, tmp_path / "sweep" / run / "field.safetensors")
    code, said = gallery(tmp_path / "sweep", "--scene", baked, "-o", tmp_path / "sheet.png")
    assert code == 0
    names = [each["name"] for each in said["pictures"]]
    assert names == ["reference", "a/field.safetensors", "b/field.safetensors"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("-o", "sheet.jpg"), ".png or .html"),
        (("-o", "sheet.png", "--camera", "nowhere.json"), "expected a saved camera"),
        (("-o", "sheet.png", "--width", "3"), "expected 64"),
    ],
)
def test_choices_that_are_wrong_are_refused(
    gallery, baked, tmp_path, monkeypatch, arguments: tuple[str, ...], message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    code, said = gallery(baked, *arguments)
    assert code == 2
    assert message in said["error"]["message"]


def test_a_folder_without_weights_is_refused(gallery, baked: Path, tmp_path: Path) -> None:
    (baked / "field.safetensors").unlink()
    code, said = gallery(baked, "-o", tmp_path / "sheet.png")
    assert (code, said["error"]["message"].splitlines()[0].endswith("found no weights")) == (2, True)


def test_one_scene_at_a_time(gallery, baked: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.glb").write_bytes(glb())
    shutil.copyfile(WEIGHTS, tmp_path / "field.safetensors")
    code, said = gallery(tmp_path, "-o", tmp_path / "sheet.png")
    assert code == 2
    assert "expected one scene, found a, b" in said["error"]["message"]


def test_without_a_browser_it_says_so(baked: Path, monkeypatch) -> None:
    monkeypatch.setenv("IRRADIA_CHROMIUM", str(baked / "nowhere"))
    with pytest.raises(MissingDependencyError, match="IRRADIA_CHROMIUM"), open_page(8, 8):
        pass


def test_a_browser_that_ends_at_once_is_told_of(chromium: str) -> None:
    with pytest.raises(BrowserError, match="ended with"), open_page(8, 8, program=shutil.which("false")):
        pass


def test_a_page_tells_of_its_complaints_and_its_picture(chromium: str) -> None:
    with open_page(32, 16) as page:
        page.go("data:text/html,<body style='background:rgb(10 20 30)'><script>console.warn('odd')</script>")
        with pytest.raises(BrowserError, match=r"ready after 2 s; it says: odd"):
            page.wait_for("false", 2.0)
        with pytest.raises(BrowserError, match="nothing is not defined"):
            page.evaluate("nothing")
        assert page.evaluate("'ü'.repeat(100000)") == "ü" * 100_000
        picture = Image.open(io.BytesIO(page.picture()))
    assert picture.size == (32, 16)
    assert picture.convert("RGB").getpixel((31, 15)) == (10, 20, 30)


def test_a_saved_camera_is_handed_on(baked: Path, tmp_path: Path) -> None:
    from irradia.cli.gallery_job import GalleryJob
    from irradia.scene.framing import look_at
    from irradia.scene.types import Camera

    job = GalleryJob(baked, tmp_path / "a.png", camera="a.json")
    eye, target = np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 0.0])
    pose = gallery_job._pose(job, Camera(look_at(eye, target), np.pi / 3))
    assert pose == {"camera": "1,2,3,1,2,2,60"}


def test_a_camera_of_one_s_own_leaves_the_reference_out(baked: Path) -> None:
    (scene,) = collect([baked]).scenes
    assert [shot.source for shot in find_shots(scene)] == ["reference", "field:0"]
    assert [shot.source for shot in find_shots(scene, with_reference=False)] == ["field:0"]
