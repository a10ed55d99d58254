"""RGB9E5: three 9-bit mantissas under one 5-bit exponent, 4 bytes a texel, no sign.

This work is based on: EXT_texture_shared_exponent, OpenGL registry, 2004 (the conversion in its
section 3.8.x); the bit order is Vulkan's VK_FORMAT_E5B9G9R9_UFLOAT_PACK32.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MANTISSA_BITS = 9
EXPONENT_BIAS = 15
MAX_EXPONENT = 31
MAX_VALUE = (2.0**MANTISSA_BITS - 1.0) * 2.0 ** (MAX_EXPONENT - EXPONENT_BIAS - MANTISSA_BITS)  # 65408


def pack_rgb9e5(rgb: NDArray) -> NDArray[np.uint32]:
    """(…, 3) linear values to (…) words, rounded to nearest (halves up), clamped to [0, 65408].

    NaN becomes 0, as the specification has it. The error is at most half a step of the largest
    channel: 1/512 of it.
    """
    # In double precision adding 0.5 to a mantissa is exact, so the floor below never misrounds.
    values = np.asarray(rgb, np.float64)
    clamped = np.clip(np.where(np.isnan(values), 0.0, values), 0.0, MAX_VALUE)
    largest = clamped.max(axis=-1)
    # frexp's exponent is floor(log2) + 1; zero has exponent 0 there, so it is masked.
    floor_log2 = np.where(largest > 0.0, np.frexp(largest)[1] - 1, -EXPONENT_BIAS - 1)
    exponent = np.maximum(floor_log2, -EXPONENT_BIAS - 1) + 1 + EXPONENT_BIAS
    exponent += np.floor(_mantissa(largest, exponent) + 0.5) == 2.0**MANTISSA_BITS
    mantissas = np.floor(_mantissa(clamped, exponent[..., None]) + 0.5).astype(np.uint32)
    red, green, blue = np.moveaxis(mantissas, -1, 0)
    return (exponent.astype(np.uint32) << 27) | (blue << 18) | (green << 9) | red


def unpack_rgb9e5(words: NDArray[np.uint32]) -> NDArray[np.float32]:
    """(…) words to (…, 3) float32, exactly."""
    mantissas = np.stack([(words >> shift) & 0x1FF for shift in (0, 9, 18)], axis=-1)
    exponent = (words >> 27).astype(np.int32) - EXPONENT_BIAS - MANTISSA_BITS
    return np.ldexp(mantissas.astype(np.float32), exponent[..., None])


def _mantissa(values: NDArray, exponent: NDArray) -> NDArray:
    """Values in units of the exponent's step."""
    return np.ldexp(values, EXPONENT_BIAS + MANTISSA_BITS - exponent)
