"""Arrays as pictures inside the page: display pixels, false colour, data URIs."""

from __future__ import annotations

import base64
import io

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import picture_srgb8

U8 = NDArray[np.uint8]
F32 = NDArray[np.float32]

MAX_PAGE_PX = 1024  # a lightmap page's picture is no larger
CHECKER_SRGB8 = (38, 52)  # texels that no chart covers

# Dark where images agree, bright where they differ; lightness grows evenly along the way.
_ERROR_STOPS_SRGB8 = np.array(
    [
        (4, 4, 10),
        (44, 18, 92),
        (112, 30, 124),
        (186, 54, 102),
        (240, 106, 68),
        (252, 176, 92),
        (252, 246, 196),
    ],
    np.float32,
)


def display(radiance: F32, exposure_ev: float) -> U8:
    """8-bit sRGB pixels of (H, W, 3) linear radiance."""
    return picture_srgb8(np.nan_to_num(radiance, nan=0.0, posinf=0.0, neginf=0.0), exposure_ev)


def error_colours(error: F32) -> U8:
    """(H, W) errors in [0, 1] in false colour."""
    place = np.clip(np.nan_to_num(error, nan=1.0), 0.0, 1.0) * (len(_ERROR_STOPS_SRGB8) - 1)
    low = np.minimum(place.astype(np.int64), len(_ERROR_STOPS_SRGB8) - 2)
    share = (place - low)[..., None]
    mixed = _ERROR_STOPS_SRGB8[low] * (1.0 - share) + _ERROR_STOPS_SRGB8[low + 1] * share
    return np.round(mixed).astype(np.uint8)


def error_gradient_css() -> str:
    """The colours of :func:`error_colours` as a CSS gradient, for the scale beside the map."""
    stops = ", ".join(f"rgb({r:.0f} {g:.0f} {b:.0f})" for r, g, b in _ERROR_STOPS_SRGB8)
    return f"linear-gradient(to right, {stops})"


def page_display(page: F32, coverage: F32, exposure_ev: float) -> U8:
    """A lightmap page as people look at it: scaled down, a checkerboard where no chart is."""
    step = _page_step(page)
    return _on_board(display(page[::step, ::step], exposure_ev), coverage[::step, ::step] > 0)


def map_display(pixels: U8, coverage: F32) -> U8:
    """(H, W, 3) pixels of a map like :func:`page_display`."""
    step = _page_step(pixels)
    return _on_board(pixels[::step, ::step], coverage[::step, ::step] > 0)


def _page_step(page: NDArray) -> int:
    return -(-max(page.shape[:2]) // MAX_PAGE_PX)


def _on_board(pixels: U8, covered: NDArray[np.bool_]) -> U8:
    rows, columns = np.indices(covered.shape)
    board = np.where((rows // 8 + columns // 8) % 2 == 0, *map(np.uint8, CHECKER_SRGB8))
    return np.where(covered[..., None], pixels, board[..., None]).astype(np.uint8)


def data_uri(pixels: U8, *, lossless: bool = True) -> str:
    """(H, W, 3) pixels as a WebP data URI."""
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "WEBP", lossless=lossless, quality=80 if lossless else 92, method=3)
    return "data:image/webp;base64," + base64.b64encode(stream.getvalue()).decode("ascii")
