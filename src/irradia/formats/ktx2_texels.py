"""What a KTX2 level holds: texels of each encoding, from and to linear pages; and smaller mip levels."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from irradia.formats.bands import map_bands
from irradia.formats.bc6h import block_count, blocks_from_bytes, decode_bc6h, encode_bc6h
from irradia.formats.bc6h_tables import BLOCK_BYTES
from irradia.formats.limits import HALF_MAX
from irradia.formats.rgb9e5 import pack_rgb9e5, unpack_rgb9e5

Encoding = Literal["half", "rgb9e5", "bc6h"]
# VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_E5B9G9R9_UFLOAT_PACK32, VK_FORMAT_BC6H_UFLOAT_BLOCK
VK_FORMAT: dict[Encoding, int] = {"half": 97, "rgb9e5": 123, "bc6h": 143}
TYPE_BYTES: dict[Encoding, int] = {"half": 2, "rgb9e5": 4, "bc6h": 1}
_BAND_TEXELS = 1 << 18


def level_bytes(encoding: Encoding, n_pages: int, height: int, width: int) -> int:
    """Size of a level that is not supercompressed."""
    if encoding == "bc6h":
        return n_pages * block_count(height) * block_count(width) * BLOCK_BYTES
    return n_pages * height * width * (8 if encoding == "half" else 4)


def encode_level(pages: NDArray, encoding: Encoding, weights: NDArray | None = None) -> bytes:
    """(P, H, W, 3) linear values ≥ 0 as stored, page by page.

    Args:
        pages: The values; what is over the encoding's largest is clamped to it.
        encoding: How.
        weights: (P, H, W), by how much errors count, where an encoding weighs them (``bc6h``).
    """
    if encoding == "bc6h":
        weighed = [None] * len(pages) if weights is None else weights
        return b"".join(encode_bc6h(page, w).tobytes() for page, w in zip(pages, weighed, strict=True))
    n_pages, height, width = pages.shape[:3]
    texels = np.empty((n_pages * height, width), "<u4" if encoding == "rgb9e5" else ("<f2", (4,)))
    rows = pages.reshape(n_pages * height, width, 3)

    def encode(band: slice) -> None:
        if encoding == "rgb9e5":
            texels[band] = pack_rgb9e5(rows[band])
        else:
            texels[band, :, :3] = np.nan_to_num(np.clip(rows[band], 0.0, HALF_MAX))
            texels[band, :, 3] = 1.0

    # RGB9E5 takes 100 bytes a texel on the way.
    map_bands(encode, len(rows), max(_BAND_TEXELS // width, 1))
    return texels.tobytes()


def decode_level(
    raw: bytes, encoding: Encoding, n_pages: int, height: int, width: int
) -> NDArray[np.float32]:
    """(P, H, W, 3) float32 of a level of the size that :func:`level_bytes` gives."""
    if encoding == "bc6h":
        size = len(raw) // n_pages
        stored = [raw[size * page : size * (page + 1)] for page in range(n_pages)]
        return np.stack([decode_bc6h(blocks_from_bytes(s, height, width), height, width) for s in stored])
    if encoding == "rgb9e5":
        rgb = unpack_rgb9e5(np.frombuffer(raw, "<u4"))
    else:
        rgb = np.frombuffer(raw, "<f2").reshape(-1, 4)[:, :3].astype(np.float32)
    return rgb.reshape(n_pages, height, width, 3)


def half_size(pages: NDArray, weights: NDArray) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The next smaller mip level, each side halved and rounded down, and its weights.

    A box filter; where sides are odd, three texels share in one. Texels count by their weights, so that
    what lies between charts doesn't darken them; where all are 0 they count alike.

    Args:
        pages: (P, H, W, 3).
        weights: (P, H, W), not negative.
    """
    weighted = np.concatenate([pages * weights[..., None], pages, weights[..., None]], axis=-1)
    small = _halve(_halve(weighted.astype(np.float32), 1), 2)
    weight = small[..., 6]
    mean = small[..., :3] / np.where(weight > 0.0, weight, 1.0)[..., None]
    return np.where(weight[..., None] > 0.0, mean, small[..., 3:6]), weight


def _halve(values: NDArray[np.float32], axis: int) -> NDArray[np.float32]:
    """Means of pairs, or of three with the weights by which an odd side's texels are cut."""
    n = values.shape[axis]
    if n == 1:
        return values
    rows = np.moveaxis(values, axis, 0)
    k = n // 2
    first, second = rows[0 : 2 * k : 2], rows[1 : 2 * k : 2]
    if n % 2 == 0:
        return np.moveaxis((first + second) * np.float32(0.5), 0, axis)
    i = np.arange(k, dtype=np.float32).reshape(-1, *[1] * (rows.ndim - 1))
    mean = ((k - i) * first + k * second + (i + 1) * rows[2 : 2 * k + 1 : 2]) / np.float32(n)
    return np.moveaxis(mean, 0, axis)
