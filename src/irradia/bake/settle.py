"""The first epochs, which carry light around the scene until its mean stops moving."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from irradia.transport.texel_light import TexelColour

_RAYS_TO_SETTLE = 1 << 18  # an epoch of fewer settles on a mean of its own, and bounces amplify the error
_MAX_EPOCHS = 64
_SETTLED = 5e-4  # of the mean: what the epochs still to come may add


def rays_to_settle(n_texels: int, samples: int) -> int:
    """Rays per texel of a settling epoch."""
    return min(max(_RAYS_TO_SETTLE // n_texels, 1), max(samples // 8, 1))


def settle(
    estimate: TexelColour,
    bounce: Callable[[TexelColour, float], TexelColour],
    mean: Callable[[TexelColour], float],
    each: Callable[[float], None],
) -> TexelColour:
    """Iterates until what is still to come is below ``_SETTLED`` of the mean.

    ``bounce`` must draw the same random numbers every time, so that the iteration is a fixed linear
    one whose mean converges geometrically; the epochs after it draw fresh ones. Every third epoch
    jumps ahead by the geometric series' remainder.

    Args:
        estimate: E/π straight from sources, to begin with.
        bounce: E/π from a map that is multiplied by a factor first.
        mean: Mean of a map.
        each: Told the mean after every epoch.

    Returns:
        The settled map.
    """
    scale, means = 1.0, [mean(estimate)]
    for _ in range(_MAX_EPOCHS):
        estimate = bounce(estimate, scale)
        means.append(mean(estimate))
        each(means[-1])
        scale = 1.0
        if len(means) < 3:
            continue
        remainder = _geometric_remainder(means)
        if abs(remainder) <= _SETTLED * abs(means[-1]):
            break
        if len(means) >= 4:
            scale = 1.0 + remainder / means[-1]
            means = [means[-1] * scale]
    return estimate


def _geometric_remainder(means: list[float]) -> float:
    """What a geometric series that goes on like the last three means would still add."""
    before, last = means[-2] - means[-3], means[-1] - means[-2]
    if before == 0.0 or last == 0.0:
        return 0.0
    ratio = min(max(last / before, 0.0), 0.98)
    return last * ratio / (1.0 - ratio)
