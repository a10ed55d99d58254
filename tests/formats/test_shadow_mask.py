"""Shadow masks on disk."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from irradia.core.errors import InputError
from irradia.formats.shadow_mask import encode_shadow_mask, read_shadow_mask, write_shadow_mask


def _pages(n_pages: int) -> np.ndarray:
    pages = np.random.default_rng(3).random((n_pages, 9, 13, 4), np.float32)
    pages[0, 0, 0], pages[0, 0, 1] = 0.0, 1.0
    return pages


def test_pages_come_back_to_the_nearest_step(tmp_path):
    pages = _pages(2)
    files = write_shadow_mask(tmp_path / "shadow_mask.png", pages)
    assert [file.name for file in files] == ["shadow_mask.png", "shadow_mask.1.png"]
    back = read_shadow_mask(files[0], n_pages=2)
    np.testing.assert_allclose(back, pages, atol=0.5 / 255 + 1e-6)
    assert (back[0, 0, 0] == 0.0).all()
    assert (back[0, 0, 1] == 1.0).all()


def test_another_reader_finds_the_channels_in_order():
    page = np.tile(np.float32([0.0, 1 / 255, 0.5, 1.0]), (4, 5, 1))
    with Image.open(io.BytesIO(encode_shadow_mask(page))) as image:
        assert image.mode == "RGBA"
        assert image.getpixel((2, 3)) == (0, 1, 128, 255)


def test_values_out_of_range_are_clipped():
    page = np.full((2, 2, 4), 1.0 + 1e-6, np.float32)
    with Image.open(io.BytesIO(encode_shadow_mask(page))) as image:
        assert image.getextrema() == ((255, 255),) * 4


def test_a_missing_page_or_another_image_is_bad_input(tmp_path):
    path = write_shadow_mask(tmp_path / "shadow_mask.png", _pages(1))[0]
    with pytest.raises(InputError, match=r"shadow_mask\.1\.png"):
        read_shadow_mask(path, n_pages=2)
    Image.new("RGB", (4, 4)).save(tmp_path / "shadow_mask.1.png")
    with pytest.raises(InputError, match="expected 8-bit RGBA, found mode RGB"):
        read_shadow_mask(path, n_pages=2)
    Image.new("RGBA", (4, 4)).save(tmp_path / "shadow_mask.1.png")
    with pytest.raises(InputError, match="pages of one size"):
        read_shadow_mask(path, n_pages=2)
    data = path.read_bytes()
    for length in (4, 40, len(data) // 2):
        path.write_bytes(data[:length])
        with pytest.raises(InputError):
            read_shadow_mask(path)
