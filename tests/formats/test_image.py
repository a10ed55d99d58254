"""Pictures by their ending."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irradia.core.colour import srgb_from_linear
from irradia.core.errors import InputError
from irradia.formats.exr import write_exr_rgb
from irradia.formats.hdr import write_hdr
from irradia.formats.image import read_image
from irradia.formats.png import write_png


def test_one_picture_in_three_formats_is_the_same_light(tmp_path: Path) -> None:
    linear = np.random.default_rng(15).random((8, 12, 3)).astype(np.float32)
    write_exr_rgb(tmp_path / "a.exr", linear)
    write_hdr(tmp_path / "a.HDR", linear)
    write_png(tmp_path / "a.png", np.round(srgb_from_linear(linear) * 255).astype(np.uint8))
    for name, tolerance in (("a.exr", 0.0), ("a.HDR", 2.0**-8), ("a.png", 0.005)):
        np.testing.assert_allclose(read_image(tmp_path / name), linear, atol=tolerance)


def test_unknown_ending_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.bmp"):
        read_image(tmp_path / "a.bmp")
