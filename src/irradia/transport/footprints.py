"""Makes texels look at the scene, where parts of them lie inside something."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.transport.hidden import drop_hidden
from irradia.transport.move_out import move_out
from irradia.transport.sight import cut_off, take_one_side
from irradia.transport.subsamples import Subsamples
from irradia.transport.texel_grid import PRECEDING, TexelGrid
from irradia.transport.world import World


@dataclass(frozen=True)
class Footprints:
    """What of each texel looks at the scene.

    Attributes:
        hidden_share: (N,) share of its sub-samples that lie inside something.
        moved: (K, 2) texels that lie inside altogether, and those beside them that they stand for.
        cut_off: (N,) which of its preceding neighbours it doesn't see; see :func:`cut_off`.
        behind: (N,) the neighbour on the other side, for texels that something divides and that show a
            part on either; itself for all others. Rays that meet the far part read the texel too: see
            :mod:`irradia.transport.radiosity`. So do rays that meet a sliver of a texel that was moved, on
            the side that it was not moved to.
    """

    hidden_share: NDArray[np.float32]
    moved: NDArray[np.uint32]
    cut_off: NDArray[np.uint8]
    behind: NDArray[np.uint32]

    @property
    def visible(self) -> NDArray[np.bool_]:
        """(N,) whether any of the texel looks at the scene."""
        return self.hidden_share < 1.0

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(N,) whether the texel's light counts; what others are given is a guess."""
        valid = self.visible
        valid[self.moved[:, 0]] = True
        return valid


def clear_footprints(world: World, subsamples: Subsamples, grid: TexelGrid) -> Footprints:
    """Replaces sub-samples that lie inside something by visible places of their texel or the next.

    Args:
        world: The scene.
        subsamples: Changed in place.
        grid: Where the texels lie.
    """
    hidden_share = drop_hidden(world, subsamples, grid)
    divided = take_one_side(world, subsamples, hidden_share, grid)
    moved = move_out(world, subsamples, hidden_share, grid)
    apart = cut_off(world, subsamples, hidden_share, grid)
    return Footprints(hidden_share, moved, apart, _behind(hidden_share, divided, apart, grid))


def _behind(
    hidden_share: NDArray[np.float32],
    divided: NDArray[np.uint32],
    apart: NDArray[np.uint8],
    grid: TexelGrid,
) -> NDArray[np.uint32]:
    """See :class:`Footprints`.

    A texel that is hidden in part may also reach behind the wall with less than a sub-sample.
    """
    behind = np.arange(len(hidden_share), dtype=np.uint32)
    least = np.full(len(behind), 2.0, np.float32)
    both_sides = np.zeros(len(behind), np.bool_)
    both_sides[divided] = True
    for k, step in enumerate(PRECEDING):
        texel = np.flatnonzero(apart & (1 << k))
        beside = grid.neighbour(texel, step)
        for one, other in ((texel, beside), (beside, texel)):
            shows = both_sides[one] | (hidden_share[one] > 0.0)
            better = shows & (hidden_share[other] < least[one])
            behind[one[better]], least[one[better]] = other[better], hidden_share[other[better]]
    return behind
