"""``irradia compare``."""

from __future__ import annotations

import json

import numpy as np
import pytest

from irradia.cli import app
from irradia.export.map_files import FORMATS, write_maps
from irradia.formats.exr import write_exr_rgb
from irradia.formats.lightmap import make_lightmap, write_lightmap


@pytest.fixture
def picture():
    return np.random.default_rng(5).random((24, 32, 3), np.float32) + 0.1


def _compare(capfd, *files):
    code = app.run(["compare", *map(str, files), "--json"])
    return code, json.loads(capfd.readouterr().out)


def test_an_image_equals_itself(tmp_path, capfd, picture):
    write_exr_rgb(tmp_path / "a.exr", picture)
    code, said = _compare(capfd, tmp_path / "a.exr", tmp_path / "a.exr")
    assert code == 0
    assert said["relmse"] == said["smape"] == said["flip"] == 0.0
    assert said["mean_ratio"] == 1.0
    assert said["psnr_db"] is None  # infinite


def test_the_mean_ratio_is_test_over_reference(tmp_path, capfd, picture):
    write_exr_rgb(tmp_path / "a.exr", picture * 1.25)
    write_exr_rgb(tmp_path / "b.exr", picture)
    _, said = _compare(capfd, tmp_path / "a.exr", tmp_path / "b.exr")
    assert said["mean_ratio"] == pytest.approx(1.25, rel=1e-5)
    assert said["n_pixels"] == 24 * 32


def test_only_covered_texels_of_lightmaps_count(tmp_path, capfd, picture):
    pages = picture[None]
    coverage = np.zeros((1, 24, 32), np.float32)
    coverage[0, :10] = 1.0
    other = np.where(coverage[..., None] > 0, pages, 99.0).astype(np.float32)
    write_lightmap(tmp_path / "a.exr", make_lightmap(pages, coverage))
    write_lightmap(tmp_path / "b.exr", make_lightmap(other, coverage))
    _, said = _compare(capfd, tmp_path / "a.exr", tmp_path / "b.exr")
    assert said["n_pixels"] == 320
    assert said["relmse"] == 0.0


@pytest.mark.parametrize("name", FORMATS)
def test_a_lightmap_equals_itself_in_every_format(tmp_path, capfd, name):
    smooth = np.linspace(300.0, 700.0, 24 * 32, dtype=np.float32).reshape(1, 24, 32, 1)
    coverage = np.zeros((1, 24, 32), np.float32)
    coverage[0, :, 4:28] = 1.0
    lightmap = make_lightmap(np.repeat(smooth, 3, axis=-1), coverage)
    stored, exact = write_maps(tmp_path, lightmap, [name, "exr"])
    _, said = _compare(capfd, stored, exact)
    assert said["n_pixels"] == 24 * 24
    assert said["mean_ratio"] == pytest.approx(1.0, abs=5e-3)
    assert said["relmse"] < 1e-4


def test_a_texture_of_another_kind_is_bad_input(tmp_path, capfd, picture):
    write_exr_rgb(tmp_path / "a.exr", picture)
    (tmp_path / "b.ktx2").write_bytes(b"\xabKTX 20\xbb\r\n\x1a\n" + bytes(80))
    assert _compare(capfd, tmp_path / "a.exr", tmp_path / "b.ktx2")[0] == 2


def test_sizes_must_agree(tmp_path, capfd, picture):
    write_exr_rgb(tmp_path / "a.exr", picture)
    write_exr_rgb(tmp_path / "b.exr", picture[:10])
    code, said = _compare(capfd, tmp_path / "a.exr", tmp_path / "b.exr")
    assert code == 2
    assert "one size" in said["error"]["message"]


def test_lightmaps_of_two_sizes_are_bad_input(tmp_path, capfd, picture):
    for name, rows in (("a.exr", 24), ("b.exr", 12)):
        cut = picture[None, :rows]
        write_lightmap(tmp_path / name, make_lightmap(cut, np.ones(cut.shape[:-1], np.float32)))
    assert _compare(capfd, tmp_path / "a.exr", tmp_path / "b.exr")[0] == 2


@pytest.mark.parametrize("content", [b"", b"not a picture at all", b"\x76\x2f\x31\x01truncated"])
def test_a_damaged_file_is_bad_input(tmp_path, capfd, picture, content):
    write_exr_rgb(tmp_path / "a.exr", picture)
    (tmp_path / "b.exr").write_bytes(content)
    assert _compare(capfd, tmp_path / "a.exr", tmp_path / "b.exr")[0] == 2


def test_a_missing_file_is_bad_input(tmp_path, capfd, picture):
    write_exr_rgb(tmp_path / "a.exr", picture)
    assert _compare(capfd, tmp_path / "a.exr", tmp_path / "none.exr")[0] == 2


def test_people_get_a_list(tmp_path, capfd, picture):
    write_exr_rgb(tmp_path / "a.exr", picture)
    assert app.run(["compare", str(tmp_path / "a.exr"), str(tmp_path / "a.exr")]) == 0
    shown = capfd.readouterr().out
    assert "HDR-FLIP" in shown
    assert "mean ratio" in shown
