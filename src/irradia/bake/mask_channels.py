"""Which of four channels each light's shadow goes to: overlapping lights never share one.

This work is based on: Brélaz 1979, "New Methods to Color the Vertices of a Graph" (DSATUR): next
comes the light whose neighbours already take the most channels. Ours differs where none is left:
then the light takes the channel whose holders are weakest together, if it is stronger than they
are. The strength of all that have a channel grows with that, so it ends.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

N_CHANNELS = 4
NO_CHANNEL = -1
_EMPTY = -1.0  # weaker than any light


def assign_channels(overlap: NDArray[np.bool_], strength: ArrayLike) -> NDArray[np.int8]:
    """Gives lights channels.

    Args:
        overlap: (L, L) symmetric: whether two lights may shine on one place.
        strength: (L,) at least 0: what a light is worth when not all can have a channel.

    Returns:
        (L,) 0 … 3, or NO_CHANNEL.
    """
    power = np.asarray(strength, np.float64)
    neighbours = overlap & ~np.eye(len(power), dtype=np.bool_)
    channel = np.full(len(power), NO_CHANNEL, np.int8)
    waiting = np.ones(len(power), np.bool_)
    holders = np.zeros((len(power), N_CHANNELS), np.int64)  # neighbours of each light in each channel
    while waiting.any():
        light = _most_constrained(waiting, holders, power)
        waiting[light] = False
        best, rivals = _weakest_channel(neighbours[light], channel, power)
        if rivals < power[light]:
            evicted = neighbours[light] & (channel == best)
            holders[:, best] += neighbours[light] - neighbours[evicted].sum(axis=0)
            channel[evicted], waiting[evicted] = NO_CHANNEL, True
            channel[light] = best
    return _fill_gaps(neighbours, channel, power)


def _most_constrained(
    waiting: NDArray[np.bool_], holders: NDArray[np.int64], power: NDArray[np.float64]
) -> int:
    """Of the waiting, the one with the fewest free channels; then the strongest, then the first."""
    taken = np.where(waiting, (holders > 0).sum(axis=1), -1)
    candidates = np.flatnonzero(taken == taken.max())
    return int(candidates[power[candidates].argmax()])


def _weakest_channel(
    neighbours: NDArray[np.bool_], channel: NDArray[np.int8], power: NDArray[np.float64]
) -> tuple[int, float]:
    """The first empty channel, else the one whose holders among the neighbours are worth the least."""
    worth = np.full(N_CHANNELS, _EMPTY)
    for c in range(N_CHANNELS):
        rivals = neighbours & (channel == c)
        if rivals.any():
            worth[c] = power[rivals].sum()
    return int(worth.argmin()), float(worth.min())


def _fill_gaps(
    neighbours: NDArray[np.bool_], channel: NDArray[np.int8], power: NDArray[np.float64]
) -> NDArray[np.int8]:
    """Gives channels that were freed later to lights that had found none, strongest first."""
    for light in np.argsort(-power, kind="stable"):
        if channel[light] == NO_CHANNEL:
            best, rivals = _weakest_channel(neighbours[light], channel, power)
            if rivals == _EMPTY:
                channel[light] = best
    return channel
