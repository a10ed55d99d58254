"""Fills what has no light of its own, so that neither filtering nor mip maps meet black."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from irradia.bake.texels import TexelSet
from irradia.scene.types import F32, U32

GUTTER_PX = 4  # rings round each chart that take its own colour before the rest of the page is smoothed


def fill_invalid(values: F32, valid: NDArray[np.bool_], texels: TexelSet, region: U32 | None = None) -> F32:
    """Gives invalid texels the light of the nearest valid ones on their chart, ring by ring.

    Where rings of two regions meet, each keeps to its side. Charts without a valid texel lie inside
    something and become black.

    Args:
        values: (N, C).
        valid: (N,) whether a texel's value counts.
        texels: Where they lie.
        region: (N,) of valid texels, finer than charts; a chart is one region by default.
    """
    if valid.all():
        return values
    from irradia.bake.dilate_kernels import fill_rings

    region = texels.chart if region is None else region
    known = np.where(valid, region.astype(np.int64), -1)
    filled = np.where(valid[:, None], values, np.float32(0.0))
    for page, own in _pages(texels):
        pixel = texels.pixel[own].astype(np.int64) - page * texels.height_px * texels.width_px
        if not valid[own].all():
            texel_at = np.full(texels.height_px * texels.width_px, -1, np.int32)
            texel_at[pixel] = np.arange(len(pixel), dtype=np.int32)
            grid = texel_at.reshape(texels.height_px, texels.width_px)
            fill_rings(filled[own], known[own], texels.chart[own], pixel, grid)
    return filled


def dilate(values: F32, texels: TexelSet) -> F32:
    """Pages on which every texel has a colour; covered ones keep theirs exactly.

    A few rings round each chart continue it, for bilinear filtering and block compression; beyond,
    each page is filled smoothly from all its charts (push-pull), so that coarse mip levels hold no black.

    Args:
        values: (N, C) of the covered texels.
        texels: Where they lie.

    Returns:
        (pages, height, width, C).
    """
    pages = texels.to_pages(values)
    state = page_state(texels)
    add_rings(pages, state, GUTTER_PX)
    fill_rest(pages, state)
    return pages


def page_state(texels: TexelSet) -> NDArray[np.uint8]:
    """(P, H, W) KNOWN where a texel is covered, WANTED elsewhere."""
    from irradia.bake.dilate_kernels import KNOWN, WANTED

    return texels.to_pages(np.full(len(texels.pixel), KNOWN, np.uint8), fill=WANTED)


def add_rings(pages: F32, state: NDArray[np.uint8], n_rings: int) -> None:
    """Continues what is known by a few rings, in place."""
    from irradia.bake.dilate_kernels import grow

    for page, own_state in zip(pages, state, strict=True):
        grow(page, own_state, n_rings)


def fill_rest(pages: F32, state: NDArray[np.uint8]) -> None:
    """Fills all that is still unknown, in place, with averages over ever larger squares."""
    from irradia.bake.dilate_kernels import KNOWN

    for page, own_state in zip(pages, state, strict=True):
        _push_pull(page, own_state == KNOWN)


def _push_pull(image: F32, known: NDArray[np.bool_]) -> None:
    from irradia.bake.dilate_kernels import fill_from, halve

    if known.all() or not known.any():
        return
    coarse, coarse_known = halve(image, known)
    _push_pull(coarse, coarse_known)
    fill_from(coarse, image, known)


def _pages(texels: TexelSet) -> Iterator[tuple[int, slice]]:
    """Each page and its part of the list."""
    size = texels.height_px * texels.width_px
    first = np.searchsorted(texels.pixel, np.arange(texels.n_pages + 1, dtype=np.int64) * size)
    for page in range(texels.n_pages):
        yield page, slice(int(first[page]), int(first[page + 1]))
