"""Where each instance's charts lie in the lightmap: the hand-over between unwrapping and baking."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import F32, U32


@dataclass(frozen=True)
class Unwrap:
    """A primitive's second uv set, with the vertex splits it needed.

    Attributes:
        vertex_source: (V',) vertex of the primitive that each new vertex copies.
        indices: (T, 3) into the new vertices, triangles in the primitive's order.
        uv: (V', 2) in the unit square of the primitive's rectangle, origin top left.
        chart: (T,) chart of each triangle, from 0.
    """

    vertex_source: U32
    indices: U32
    uv: F32
    chart: U32


@dataclass(frozen=True)
class LightmapLayout:
    """All unwraps and the rectangle that each instance has on a page.

    A point's page uv is ``unwrap.uv * scale + offset``, in [0, 1] of the page; pixel = uv · size.

    Attributes:
        n_pages, width_px, height_px: All pages have one size.
        unwraps: By primitive; None where no instance of it takes a lightmap.
        page: (I,) page of each instance, or −1.
        scale, offset: (I, 2).
        texels_per_metre: The density that was reached (median over instances).
    """

    n_pages: int
    width_px: int
    height_px: int
    unwraps: tuple[Unwrap | None, ...]
    page: NDArray[np.int32]
    scale: F32
    offset: F32
    texels_per_metre: float
    notes: tuple[str, ...] = ()
