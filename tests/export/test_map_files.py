"""Lightmaps in every format: names, values, scale, and readers that aren't ours."""

from __future__ import annotations

import contextlib
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from irradia.core.errors import InputError
from irradia.export.map_files import FORMATS, parse_formats, read_map, write_maps
from irradia.formats.exr import read_exr, write_exr_rgb
from irradia.formats.hdr import write_hdr
from irradia.formats.ktx2 import encode_ktx2
from irradia.formats.lightmap import LightmapFile, make_lightmap, read_lightmap

# Largest error over the texel's largest channel, from what each format's texel can hold.
TOLERANCE = {
    "exr": 0.0,
    "exr-half": 2.0**-11,
    "hdr": 1 / 256,
    "rgbm": 0.02,
    "rgbm-linear": 0.02,
    "ktx2-half": 2.0**-11,
    "ktx2-rgb9e5": 1 / 512,
    "ktx2-bc6h": 0.15,
}


@pytest.fixture
def lightmap() -> LightmapFile:
    """Two pages of soft light around 300, one corner of each empty."""
    y, x = np.mgrid[0:24, 0:20] / 24.0
    light = np.stack([1 + x + y, 1.5 - 0.5 * x, 0.8 + 0.7 * y], axis=-1)
    pages = np.stack([light, light[::-1, ::-1]]) * 200.0
    coverage = np.ones((2, 24, 20), np.float32)
    coverage[:, 15:, 14:] = 0.0
    pages[coverage == 0.0] = 0.0
    return make_lightmap(pages.astype(np.float32), coverage, {"seed": 7})


def test_every_format_has_a_tolerance_here() -> None:
    assert set(TOLERANCE) == set(FORMATS)


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("brightness", [1e-6, 1.0, 1e5])
def test_pages_come_back_whatever_their_brightness(
    tmp_path: Path, lightmap: LightmapFile, name: str, brightness: float
) -> None:
    bright = make_lightmap(lightmap.pages * np.float32(brightness), lightmap.coverage)
    paths = write_maps(tmp_path, bright, (name,))
    assert len(paths) == 2
    for page, path in enumerate(paths):
        found = read_map(path)
        covered = bright.covered[page]
        error = np.abs(found - bright.pages[page])[covered].max(axis=-1)
        largest = bright.pages[page][covered].max(axis=-1)
        assert np.all(error <= TOLERANCE[name] * largest * (1 + 1e-5))
        assert abs(found[covered].mean() / bright.pages[page][covered].mean() - 1.0) < 2e-3


def test_files_are_named_by_format_then_page(tmp_path: Path, lightmap: LightmapFile) -> None:
    paths = write_maps(tmp_path, lightmap, ("ktx2-half", "hdr", "rgbm"))
    assert [path.name for path in paths] == [
        *("lightmap.half.ktx2", "lightmap.half.1.ktx2"),
        *("lightmap.hdr", "lightmap.1.hdr"),
        *("lightmap.rgbm.png", "lightmap.rgbm.1.png"),
    ]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(path.name for path in paths)


def test_formats_never_share_a_file(tmp_path: Path, lightmap: LightmapFile) -> None:
    paths = write_maps(tmp_path, lightmap, tuple(FORMATS))
    assert len(set(paths)) == 2 * len(FORMATS)


@pytest.mark.parametrize("name", FORMATS)
def test_same_lightmap_is_the_same_bytes(tmp_path: Path, lightmap: LightmapFile, name: str) -> None:
    first, second = (write_maps(tmp_path / folder, lightmap, (name,)) for folder in "ab")
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
    assert str(tmp_path).encode() not in first[0].read_bytes()


@pytest.mark.parametrize("name", FORMATS)
def test_every_file_carries_the_power_of_two_scale(tmp_path: Path, lightmap: LightmapFile, name: str) -> None:
    path = write_maps(tmp_path, lightmap, (name,))[0]
    assert math.log2(lightmap.scale) == round(math.log2(lightmap.scale)) != 0
    if path.suffix == ".exr":
        assert read_lightmap(path).scale == lightmap.scale
    else:
        data = path.read_bytes()
        at = data.index(b"irradia:scale")
        assert str(lightmap.scale).encode() in data[at : at + 40]


def test_pillow_decodes_rgbm_by_the_formula(tmp_path: Path, lightmap: LightmapFile) -> None:
    path = write_maps(tmp_path, lightmap, ("rgbm",))[0]
    with Image.open(path) as image:
        texels = np.asarray(image, np.float64) / 255.0
        text = {key: float(image.info[f"irradia:{key}"]) for key in ("rgbm_range", "rgbm_gamma", "unit")}
    over_unit = (text["rgbm_range"] * texels[..., 3:] * texels[..., :3]) ** text["rgbm_gamma"]
    np.testing.assert_allclose(over_unit * text["unit"], read_map(path), rtol=1e-5)


def test_what_rgbm_cannot_hold_is_counted(tmp_path: Path, lightmap: LightmapFile) -> None:
    pages = lightmap.pages.copy()
    pages[0, 3, 4] = 65.0 * lightmap.scale
    bright = replace(lightmap, pages=pages)
    for name, clipped in (("rgbm", "1"), ("rgbm-linear", "1")):
        path = write_maps(tmp_path, bright, (name,))[0]
        with Image.open(path) as image:
            assert image.info["irradia:rgbm_clipped"] == clipped
        assert read_map(path)[3, 4].max() == pytest.approx((64.0 if name == "rgbm" else 8.0) * lightmap.scale)


def test_only_texels_that_charts_reach_are_spent_on(tmp_path: Path) -> None:
    """A chart in a dilated page: its texels and two around them are kept, blocks beyond are black."""
    coverage = np.zeros((1, 32, 32), np.float32)
    coverage[0, 12:20, 13:18] = 0.1
    pages = np.full((1, 32, 32, 3), 0.7, np.float32)
    path = write_maps(tmp_path, make_lightmap(pages, coverage), ("ktx2-bc6h",))[0]
    kept = read_map(path).max(axis=-1) > 0.0
    assert kept[10:22, 11:20].all()
    assert kept.sum() == 16 * 12  # whole blocks: rows 8 to 23, columns 8 to 19


def test_empty_part_of_a_page_costs_bc6h_nothing(tmp_path: Path, lightmap: LightmapFile) -> None:
    full = np.stack([lightmap.pages[0], lightmap.pages[0]])
    full[:, 15:, 14:] = full[:, 14:15, 14:]
    rim = np.s_[12:15, 12:20]
    errors = []
    for pages, coverage in ((full, np.ones_like(lightmap.coverage)), (lightmap.pages, lightmap.coverage)):
        path = write_maps(tmp_path, make_lightmap(pages, coverage), ("ktx2-bc6h",))[0]
        errors.append(np.abs(read_map(path) / np.maximum(pages[0], 1e-9) - 1.0)[rim].max())
    assert errors[1] < 1.5 * errors[0] + 0.01


def test_browser_samples_stored_values(
    web_check, chromium: str, tmp_path: Path, lightmap: LightmapFile
) -> None:
    paths = write_maps(tmp_path, lightmap, ("ktx2-half", "ktx2-rgb9e5", "ktx2-bc6h"), n_levels=3)
    for path, found in zip(paths, web_check("sample-ktx2", chromium, *paths), strict=True):
        theirs = np.array(found["pixels"]).reshape(24, 20, 4)[..., :3] * lightmap.scale
        np.testing.assert_allclose(theirs, read_map(path), rtol=1e-6)


def test_formats_are_parsed_in_order_and_once() -> None:
    assert parse_formats(" ktx2-BC6H,exr,, exr ") == ("ktx2-bc6h", "exr")


def test_unknown_format_names_the_nearest(tmp_path: Path, lightmap: LightmapFile) -> None:
    with pytest.raises(InputError, match="Did you mean ktx2-bc6h"):
        parse_formats("exr,ktx2-bc6")
    with pytest.raises(InputError, match="at least one"):
        parse_formats(" , ")
    with pytest.raises(InputError, match="Choose of exr"):
        write_maps(tmp_path, lightmap, ("exr", "tga"))
    assert not list(tmp_path.iterdir())  # nothing is written before all are known


def test_plain_pictures_are_no_maps(tmp_path: Path) -> None:
    rgb = np.ones((8, 8, 3), np.float32)
    write_exr_rgb(tmp_path / "a.exr", rgb)
    write_hdr(tmp_path / "a.hdr", rgb)
    (tmp_path / "a.ktx2").write_bytes(encode_ktx2(rgb[None]))
    (tmp_path / "a.jpg").write_bytes(b"")
    assert read_exr(tmp_path / "a.exr").shape == (8, 8, 3)
    for name in ("a.exr", "a.hdr", "a.ktx2", "a.jpg", "none.ktx2", "none.hdr", "none.exr", "none.png"):
        with pytest.raises(InputError, match=name):
            read_map(tmp_path / name)


@pytest.mark.parametrize("name", FORMATS)
def test_damaged_files_are_input_errors_or_decode(tmp_path: Path, lightmap: LightmapFile, name: str) -> None:
    small = make_lightmap(lightmap.pages[:1, :9, :8], lightmap.coverage[:1, :9, :8])
    path = write_maps(tmp_path, small, (name,))[0]
    data = path.read_bytes()
    rng = np.random.default_rng(51)
    for _ in range(150):
        bad = bytearray(data[: rng.integers(len(data) // 2, len(data) + 1)])
        for at in rng.integers(len(bad), size=rng.integers(1, 5)):
            bad[at] = rng.integers(256)
        path.write_bytes(bad)
        with contextlib.suppress(InputError):
            assert read_map(path).shape[-1] == 3
