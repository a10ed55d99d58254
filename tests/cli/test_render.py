"""``irradia render``."""

from __future__ import annotations

import json

import numpy as np
import pytest

from irradia.cli import app
from irradia.formats.image import read_image

SMALL = ["--width", "40", "--height", "32", "--spp", "16"]


def _render(*arguments):
    return app.run(["render", *map(str, arguments), *SMALL])


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    path = tmp_path_factory.mktemp("render") / "cornell.exr"
    assert _render("builtin:cornell", "-o", path) == 0
    return read_image(path)


def test_an_exr_is_linear_radiance_of_the_size_asked_for(reference):
    assert reference.shape == (32, 40, 3)
    assert reference.dtype == np.float32
    assert reference.mean() > 0.01


def test_the_same_seed_gives_the_same_pixels(reference, tmp_path):
    assert _render("builtin:cornell", "-o", tmp_path / "again.exr") == 0
    assert np.array_equal(read_image(tmp_path / "again.exr"), reference)


def test_another_seed_gives_other_noise_about_the_same_mean(reference, tmp_path):
    assert _render("builtin:cornell", "-o", tmp_path / "other.exr", "--seed", "9") == 0
    other = read_image(tmp_path / "other.exr")
    assert not np.array_equal(other, reference)
    assert other.mean() == pytest.approx(reference.mean(), rel=0.1)


def test_a_png_is_a_picture_at_the_exposure_asked_for(tmp_path, capfd):
    for name, exposure in (("dark.png", "-4"), ("bright.png", "4")):
        assert _render("builtin:cornell", "-o", tmp_path / name, "--exposure", exposure, "--json") == 0
        assert json.loads(capfd.readouterr().out)["exposure_ev"] == float(exposure)
    assert read_image(tmp_path / "dark.png").mean() < read_image(tmp_path / "bright.png").mean() / 4


def test_a_saved_camera_gives_the_same_picture(reference, tmp_path):
    camera = tmp_path / "camera.json"
    assert _render("builtin:cornell", "-o", tmp_path / "a.exr", "--save-camera", camera) == 0
    assert _render("builtin:cornell", "-o", tmp_path / "b.exr", "--camera", camera) == 0
    assert np.allclose(read_image(tmp_path / "b.exr"), reference, rtol=1e-3, atol=1e-4)


def test_the_baked_file_shows_its_own_light(reference, tmp_path):
    bake = ["bake", "builtin:cornell", "-o", str(tmp_path / "out"), "--resolution", "128", "--no-report"]
    assert app.run([*bake]) == 0
    baked = tmp_path / "out" / "scene.baked.glb"
    assert _render(baked, "--baked", "-o", tmp_path / "baked.exr") == 0
    image = read_image(tmp_path / "baked.exr")
    assert image.mean() == pytest.approx(reference.mean(), rel=0.05)
    assert np.corrcoef(image.ravel(), reference.ravel())[0, 1] > 0.95


def test_an_image_without_the_directional_maps_inside_says_so(tmp_path, capfd):
    bake = ["bake", "builtin:cornell", "-o", str(tmp_path), "--resolution", "64", "--samples", "8"]
    assert app.run([*bake, "--no-report", "--directional", "sh"]) == 0
    assert "maps inside" not in capfd.readouterr().err
    assert _render(tmp_path / "scene.baked.glb", "--baked", "-o", tmp_path / "image.exr") == 0
    assert "the sh maps inside" in capfd.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        ["-o", "image.gif"],
        ["-o", "image.exr", "--camera", "77"],
        ["-o", "image.exr", "--camera", "absent.json"],
        ["-o", "image.exr", "--baked"],
        ["-o", "image.exr", "--baked", "--transport", "full"],
        ["-o", "image.exr", "--exposure", "nan"],
    ],
)
def test_bad_input_leaves_no_image(arguments, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert _render("builtin:cornell", *arguments) == 2
    assert capfd.readouterr().err
    assert list(tmp_path.iterdir()) == []
