"""PNG files of textures, as small as they can be without loss."""

from __future__ import annotations

import io

import numpy as np

from irradia.scene.types import U8


def encode_png(pixels: U8) -> bytes:
    """PNG bytes of (H, W, 3) or (H, W, 4) 8-bit values; the same pixels give the same bytes.

    Up to 256 opaque colours are written as a palette, which halves the file.
    """
    from PIL import Image as PilImage

    stream = io.BytesIO()
    image = PilImage.fromarray(pixels)
    if pixels.shape[2] == 3:
        packed = pixels.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
        colours, index = np.unique(packed, return_inverse=True)
        if len(colours) <= 256:
            image = PilImage.fromarray(index.reshape(packed.shape).astype(np.uint8), "P")
            image.putpalette(colours.astype(">u4").tobytes(), "XRGB")
    image.save(stream, "PNG", compress_level=9)
    return stream.getvalue()
