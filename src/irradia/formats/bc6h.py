"""BC6H (unsigned): HDR colour in one byte a texel, which GPUs since Direct3D 11 sample as it is.

Blocks of 4 × 4 texels of half floats; see ``bc6h_tables`` for the format, ``bc6h_decode`` for the
reference decoder and ``bc6h_kernels`` for how blocks are fitted.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.formats.bands import map_bands
from irradia.formats.bc6h_decode import half_bits_from_blocks
from irradia.formats.bc6h_tables import BLOCK_BYTES
from irradia.formats.limits import HALF_MAX

# Where errors turn from relative to absolute: darker than this an eighth of a stop no longer counts in full.
DARK = 2.0**-8
DEFAULT_PARTITIONS = 4
_BAND_BLOCKS = 1 << 14


def encode_bc6h(
    rgb: NDArray,
    weights: NDArray | None = None,
    *,
    n_partitions: int = DEFAULT_PARTITIONS,
    dark: float = DARK,
) -> NDArray[np.uint8]:
    """Encodes one image as (blocks down, blocks across, 16) bytes.

    The squared error of the half floats' bits (nearly of the logarithm) is made small; by a channel of
    value v it is weighted with (v / (v + dark))², so that black isn't infinitely far from almost black.

    Args:
        rgb: (H, W, 3) linear, the brightest near 1; clamped to [0, 65504], NaN becomes 0.
        weights: (H, W), by how much a texel's error counts; 0 for texels that nothing shows. All equal
            if absent.
        n_partitions: How many two-region partitions a block tries, 0 to 32: more is better and slower.
        dark: See above.
    """
    from irradia.formats.bc6h_kernels import encode_blocks

    height, width = rgb.shape[:2]
    blocks = np.zeros((block_count(height), block_count(width), BLOCK_BYTES), np.uint8)

    def encode(band: slice) -> None:
        rows = slice(4 * band.start, min(4 * band.stop, height))
        half = np.nan_to_num(np.clip(rgb[rows], 0.0, HALF_MAX)).astype(np.float16)
        metric = _metric(half, None if weights is None else weights[rows], dark)
        texels = _texel_blocks(half.view(np.uint16), "edge")
        encode_blocks(texels, _texel_blocks(metric, "constant"), n_partitions, _flat(blocks[band]))

    map_bands(encode, len(blocks), max(_BAND_BLOCKS // blocks.shape[1], 1))
    return blocks


def decode_bc6h(blocks: NDArray[np.uint8], height: int, width: int) -> NDArray[np.float32]:
    """Decodes (blocks down, blocks across, 16) bytes to (H, W, 3); what pads the last blocks is cut off."""
    down, across = blocks.shape[:2]
    rgb = np.empty((4 * down, 4 * across, 3), np.float32)

    def decode(band: slice) -> None:
        texels = half_bits_from_blocks(_flat(blocks[band])).view(np.float16)
        rows = texels.reshape(-1, across, 4, 4, 3).swapaxes(1, 2)
        rgb[4 * band.start : 4 * band.stop] = rows.reshape(-1, 4 * across, 3)

    map_bands(decode, down, max(_BAND_BLOCKS // across, 1))
    return np.ascontiguousarray(rgb[:height, :width])


def block_count(side_px: int) -> int:
    """Blocks that cover a side."""
    return -(-side_px // 4)


def blocks_from_bytes(data: bytes, height: int, width: int) -> NDArray[np.uint8]:
    """Stored blocks as :func:`decode_bc6h` takes them.

    Raises:
        InputError: There are more or fewer bytes than the size needs.
    """
    shape = (block_count(height), block_count(width), BLOCK_BYTES)
    if len(data) != int(np.prod(shape)):
        raise InputError(f"expected {int(np.prod(shape))} bytes of BC6H blocks, found {len(data)}")
    return np.frombuffer(data, np.uint8).reshape(shape)


def _metric(half: NDArray[np.float16], weights: NDArray | None, dark: float) -> NDArray[np.float32]:
    """(H, W, 3) weights of squared errors."""
    value = half.astype(np.float32)
    # Never quite 0: a black texel that counts must stay dark, if not to the last bit.
    metric = np.square((value + np.float32(dark / 64)) / (value + np.float32(dark)))
    return metric if weights is None else metric * np.asarray(weights, np.float32)[..., None]


def _texel_blocks(texels: NDArray, mode: str) -> NDArray:
    """(H, W, C) as (N, 16, C), padded to whole blocks in NumPy's ``mode``."""
    height, width, n_channels = texels.shape
    rest = ((0, -height % 4), (0, -width % 4), (0, 0))
    whole = np.pad(texels, rest, mode) if height % 4 or width % 4 else texels  # pyright: ignore[reportCallIssue, reportArgumentType]
    across = whole.shape[1] // 4
    rows = whole.reshape(-1, 4, across, 4, n_channels).swapaxes(1, 2)
    return np.ascontiguousarray(rows).reshape(-1, 16, n_channels)


def _flat(blocks: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """A view of rows of blocks as (N, 16)."""
    return blocks.reshape(-1, BLOCK_BYTES)
