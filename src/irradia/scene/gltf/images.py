"""Decodes PNG, JPEG and WebP to 8-bit RGBA."""

from __future__ import annotations

import io
import warnings

import numpy as np
from PIL import Image as PillowImage

from irradia.core.errors import InputError
from irradia.scene.types import U8, Image

MAX_SIDE_PX = 16384
"""Images of this width or height, or more, are refused before they are decoded."""

_FORMATS = ("PNG", "JPEG", "WEBP")


def decode_image(data: bytes, name: str, pointer: str) -> Image:
    """Decodes an image as it is stored: no colour conversion, 16 bits reduced to 8.

    Args:
        data: The encoded file.
        name: What the image is called.
        pointer: JSON pointer for errors.

    Raises:
        InputError: It is no PNG, JPEG or WebP, is damaged, or is 16k or more on a side.
    """
    try:
        with warnings.catch_warnings():
            # Pillow warns of large images that our own limit below allows.
            warnings.simplefilter("ignore", PillowImage.DecompressionBombWarning)
            with PillowImage.open(io.BytesIO(data), formats=_FORMATS) as picture:
                _check_size(picture.size, pointer)
                pixels = _rgba8(picture)
    except PillowImage.UnidentifiedImageError as error:
        raise InputError(
            f"expected a PNG, JPEG or WebP image, found bytes {data[:8]!r}",
            where=pointer,
            fix="KTX2 textures are turned into PNG by: npx @gltf-transform/cli ktxdecompress in.glb out.glb",
        ) from error
    except PillowImage.DecompressionBombError as error:
        raise _too_large(str(error), pointer) from error
    except (OSError, SyntaxError, ValueError) as error:
        raise InputError(f"this image is damaged: {error}", where=pointer) from error
    return Image(name=name, pixels=pixels)


def _check_size(size: tuple[int, int], pointer: str) -> None:
    if max(size) >= MAX_SIDE_PX:
        raise _too_large(f"found {size[0]} × {size[1]}", pointer)


def _too_large(found: str, pointer: str) -> InputError:
    return InputError(
        f"expected an image below {MAX_SIDE_PX} pixels on each side, {found}",
        where=pointer,
        fix="Reduce it with: npx @gltf-transform/cli resize --width 4096 --height 4096 in.glb out.glb",
    )


def _rgba8(picture: PillowImage.Image) -> U8:
    if picture.mode.startswith("I"):  # 16-bit grey, which Pillow would clip instead of scaling
        grey = np.asarray(picture).astype(np.uint32)
        level = ((grey * 255 + 32895) >> 16).astype(np.uint8)  # round(grey / 257)
        return np.dstack([level, level, level, np.full_like(level, 255)])
    return np.array(picture.convert("RGBA"))
