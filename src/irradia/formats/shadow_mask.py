"""The shadow mask file: one RGBA PNG per page, ``shadow_mask.png``, ``shadow_mask.1.png``, ….

Eight bits a channel, linear: 255 is all of the light, 0 none. Red is channel 0, alpha channel 3. Alpha
is a light like the others, so readers must not premultiply by it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.formats.lightmap import page_path
from irradia.formats.limits import check_image_size
from irradia.formats.png import encode_png, write_png


def quantise_shadow_mask(pages: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Visibility in [0, 1] to the nearest of 256 steps; 0 and 1 stay what they are."""
    return np.round(np.clip(pages, 0.0, 1.0) * np.float32(255.0)).astype(np.uint8)


def encode_shadow_mask(page: NDArray[np.float32]) -> bytes:
    """The PNG of one page (H, W, 4)."""
    return encode_png(quantise_shadow_mask(page))


def write_shadow_mask(path: Path | str, pages: NDArray[np.float32]) -> tuple[Path, ...]:
    """Writes (P, H, W, 4) visibility, one file per page, and returns their paths, page 0 first."""
    paths = tuple(page_path(path, page) for page in range(len(pages)))
    for file, page in zip(paths, pages, strict=True):
        write_png(file, quantise_shadow_mask(page))
    return paths


def read_shadow_mask(path: Path | str, n_pages: int = 1) -> NDArray[np.float32]:
    """Reads (P, H, W, 4) visibility by its first page; the others lie beside it.

    Raises:
        InputError: A page is missing, damaged, of another size, or has no four 8-bit channels.
    """
    pages = [_read_page(page_path(path, page)) for page in range(n_pages)]
    if len({page.shape for page in pages}) != 1:
        raise InputError("expected pages of one size", where=str(path), fix="Bake again.")
    return np.stack(pages).astype(np.float32) / np.float32(255.0)


def _read_page(path: Path) -> NDArray[np.uint8]:
    from PIL import Image

    try:
        with Image.open(path) as image:
            check_image_size(*image.size, str(path))
            if image.mode != "RGBA":
                raise InputError(f"expected 8-bit RGBA, found mode {image.mode}", where=str(path))
            return np.asarray(image)
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise InputError(f"the image can't be read: {error}", where=str(path)) from error
