"""How large an image may be before a header is taken for damage or for an attack, and how bright a half."""

from __future__ import annotations

from irradia.core.errors import InputError

MAX_SIDE_PX = 32768
MAX_PIXELS = 1 << 28  # 3 GiB as RGB float32
HALF_MAX = 65504.0  # the largest finite half float


def check_image_size(width_px: int, height_px: int, where: str, n_layers: int = 1) -> None:
    """Refuses sizes of zero and absurd ones before memory is asked for.

    Raises:
        InputError: A side is not in 1 … MAX_SIDE_PX, or all layers together are over MAX_PIXELS.
    """
    sides_fit = 0 < width_px <= MAX_SIDE_PX and 0 < height_px <= MAX_SIDE_PX
    if not sides_fit or width_px * height_px * n_layers > MAX_PIXELS:
        raise InputError(
            f"expected an image of at most {MAX_SIDE_PX} pixels a side and {MAX_PIXELS} in all, "
            f"found {width_px} × {height_px} × {n_layers}",
            where=where,
            fix="Scale the image down, or make it again if its header is damaged.",
        )
