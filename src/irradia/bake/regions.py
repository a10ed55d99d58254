"""Parts of charts over which light may be taken from texel to texel.

The floor that runs on under a wall is one chart, but dark inside and bright outside. What smooths,
fills or closes seams goes by regions instead: texels of a chart that hang together without passing
through anything hidden.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.bake.texels import TexelSet
from irradia.scene.types import U32

NOWHERE = 0xFFFFFFFF


def find_regions(texels: TexelSet, visible: NDArray[np.bool_], cut_off: NDArray[np.uint8], moved: U32) -> U32:
    """Numbers the regions by their first texel.

    Args:
        texels: The covered texels.
        visible: (N,) whether any of the texel sees the scene.
        cut_off: (N,) which of its preceding neighbours (left, upper left, above, upper right) it
            doesn't see, a bit for each.
        moved: (K, 2) texels that aren't visible but stand for another, and that other.

    Returns:
        (N,) region, or NOWHERE for texels without light of their own.
    """
    from irradia.bake.region_kernels import join_neighbours

    region = join_neighbours(texels.pixel, texels.chart, visible, cut_off, texels.width_px, texels.height_px)
    region[moved[:, 0]] = region[moved[:, 1]]
    return region
