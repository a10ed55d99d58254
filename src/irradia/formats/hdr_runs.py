"""Run-length encoding of Radiance scanlines, the new way: four planes, each of runs and literals.

A count byte over 128 repeats the next byte count − 128 times; another is followed by that many bytes.
Everything is done on whole bands of rows at once, because a loop over bytes takes a second per megapixel.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

U8 = NDArray[np.uint8]
I64 = NDArray[np.int64]
WIDTHS = range(8, 32768)  # for which this encoding exists
_MIN_RUN = 4  # shorter ones cost as much as they save
_MAX_RUN, _MAX_LITERAL = 127, 128
_RUN_FLAG = 128


def encode_scanlines(rgbe: U8) -> bytes:
    """(H, W, 4) pixels, W in ``WIDTHS``, as H scanlines behind one another."""
    height, width = rgbe.shape[:2]
    planes = np.ascontiguousarray(rgbe.swapaxes(1, 2)).reshape(-1)
    start, length, is_run = _chunks(planes, width)
    size = np.where(is_run, 2, 1 + length)
    # Each scanline's four planes follow a mark and the width.
    scanline = start // (4 * width)
    at = np.cumsum(size) - size + 4 * (scanline + 1)
    out = np.empty(int(size.sum()) + 4 * height, np.uint8)
    first = np.searchsorted(scanline, np.arange(height))
    out[(at[first] - 4)[:, None] + np.arange(4)] = (2, 2, width >> 8, width & 255)
    out[at] = np.where(is_run, _RUN_FLAG + length, length)
    out[at[is_run] + 1] = planes[start[is_run]]
    literal, n_bytes = ~is_run, length[~is_run]
    step = np.arange(int(n_bytes.sum())) - np.repeat(np.cumsum(n_bytes) - n_bytes, n_bytes)
    out[np.repeat(at[literal] + 1, n_bytes) + step] = planes[np.repeat(start[literal], n_bytes) + step]
    return out.tobytes()


def _chunks(planes: U8, width: int) -> tuple[I64, I64, NDArray[np.bool_]]:
    """Where each count byte's bytes start, how many they are, and whether they are all the same."""
    changes = np.ones(len(planes), np.bool_)
    np.not_equal(planes[1:], planes[:-1], out=changes[1:])
    changes[::width] = True
    start = np.flatnonzero(changes)
    is_run = np.diff(start, append=len(planes)) >= _MIN_RUN
    # Short runs join into one literal, up to a long run or the end of the plane's line.
    after_run = np.concatenate([[True], is_run[:-1]])
    keep = is_run | after_run | (start % width == 0)
    start, is_run = start[keep], is_run[keep]
    length = np.diff(start, append=len(planes))
    limit = np.where(is_run, _MAX_RUN, _MAX_LITERAL)
    n_chunks = -(-length // limit)
    number = np.arange(int(n_chunks.sum())) - np.repeat(np.cumsum(n_chunks) - n_chunks, n_chunks)
    done = number * np.repeat(limit, n_chunks)
    return (
        np.repeat(start, n_chunks) + done,
        np.minimum(np.repeat(length, n_chunks) - done, np.repeat(limit, n_chunks)),
        np.repeat(is_run, n_chunks),
    )
