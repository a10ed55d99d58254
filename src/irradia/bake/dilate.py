"""Fills what has no light of its own, so that neither filtering nor mip maps meet black."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.bake.texels import TexelSet
from irradia.scene.types import F32

_GUTTER_PX = 4  # rings round each chart that take its own colour before the rest of the page is smoothed


def fill_invalid(values: F32, valid: NDArray[np.bool_], texels: TexelSet) -> F32:
    """Gives invalid texels the light of the nearest valid ones on their chart, ring by ring.

    Charts without a valid texel lie inside something and become black.

    Args:
        values: (N, 3).
        valid: (N,) whether a texel's value counts.
        texels: Where they lie.
    """
    if valid.all():
        return values
    from irradia.bake.dilate_kernels import KNOWN, NEVER, WANTED, grow

    pages = texels.to_pages(np.where(valid[:, None], values, np.float32(0)))
    state = texels.to_pages(np.where(valid, KNOWN, WANTED).astype(np.uint8), fill=NEVER)
    chart = texels.to_pages(texels.chart.astype(np.int64), fill=-1)
    for page in range(texels.n_pages):
        grow(pages[page], state[page], chart[page], -1)
    return pages.reshape(-1, 3)[texels.pixel]


def dilate(values: F32, texels: TexelSet) -> F32:
    """Pages on which every texel has a colour; covered ones keep theirs exactly.

    A few rings round each chart continue it, for bilinear filtering and block compression; beyond,
    each page is filled smoothly from all its charts (push-pull), so that coarse mip levels hold no black.

    Args:
        values: (N, 3) of the covered texels.
        texels: Where they lie.

    Returns:
        (pages, height, width, 3).
    """
    from irradia.bake.dilate_kernels import KNOWN, WANTED, grow

    pages = texels.to_pages(values)
    state = texels.to_pages(np.full(len(values), KNOWN, np.uint8), fill=WANTED)
    nothing = np.zeros(state.shape[1:], np.int64)
    for page in range(texels.n_pages):
        grow(pages[page], state[page], nothing, _GUTTER_PX)
        pages[page] = _push_pull(pages[page], state[page] == KNOWN)
    return pages


def _push_pull(image: F32, known: NDArray[np.bool_]) -> F32:
    """Fills unknown texels with averages over ever larger squares."""
    if known.all() or not known.any():
        return image
    coarse, coarse_known = _halve(image, known)
    coarse = _push_pull(coarse, coarse_known)
    return np.where(known[..., None], image, _double(coarse, image.shape[:2]))


def _halve(image: F32, known: NDArray[np.bool_]) -> tuple[F32, NDArray[np.bool_]]:
    """Means over the known texels of each 2 × 2 square."""
    height, width = known.shape
    pad = ((0, height % 2), (0, width % 2))
    weight = np.pad(known, pad).astype(np.float32)
    weighted = np.pad(image, (*pad, (0, 0))) * weight[..., None]
    quarters = [(dy, dx) for dy in (0, 1) for dx in (0, 1)]
    total = np.sum([weighted[dy::2, dx::2] for dy, dx in quarters], axis=0)
    count = np.sum([weight[dy::2, dx::2] for dy, dx in quarters], axis=0)
    return total / np.maximum(count, 1)[..., None], count > 0


def _double(image: F32, shape: tuple[int, int]) -> F32:
    """Bilinear magnification by two, cut to ``shape``."""
    for axis in (0, 1):
        edge = [(1, 1) if k == axis else (0, 0) for k in range(3)]
        padded = np.moveaxis(np.pad(image, edge, mode="edge"), axis, 0)
        n = image.shape[axis]
        doubled = np.empty((2 * n, *padded.shape[1:]), np.float32)
        doubled[0::2] = 0.75 * padded[1:-1] + 0.25 * padded[:-2]
        doubled[1::2] = 0.75 * padded[1:-1] + 0.25 * padded[2:]
        image = np.moveaxis(doubled, 0, axis)
    return image[: shape[0], : shape[1]]
