"""How a bake's samples are spread over epochs and rounds: plain arithmetic, no light."""

from __future__ import annotations

from dataclasses import dataclass

_LONGEST_GROWING = 64  # rays; a cache this clean leaves no noise worth tracing longer for
_LONGEST_IN_A_HURRY, _FIRST_DIRECT_IN_A_HURRY = 8, 16
_MAX_SLICES = 32
_SAMPLES_PER_SLICE = 1 << 22
CACHED_NEE_RATIO = 0.5  # next-event samples per ray: a cache spares most of the noise that they would
_BLOCK = 8  # rays that a pass draws from one sub-sample before it moves to the next
_RAYS_PER_LAUNCH = 1 << 22


@dataclass(frozen=True)
class EpochPlan:
    """Rays per texel of each epoch.

    Attributes:
        first_direct: Next-event samples before the first epoch, which every epoch's cache uses.
        growing: Epochs after the map has settled, each replacing the noise of the one before.
        cached: Whether there is a cache at all; a path-traced bake has one epoch, without.
    """

    first_direct: int
    growing: tuple[int, ...]
    cached: bool


def plan_epochs(samples: int, *, cached: bool, hurry: bool = False) -> EpochPlan:
    """Doubling epochs up to an eighth of ``samples``.

    Args:
        samples: Rays per texel of the last epoch.
        cached: See :class:`EpochPlan`.
        hurry: Fewer and shorter ones, so that what the user looks at comes sooner.
    """
    if not cached:
        return EpochPlan(0, (), cached=False)
    longest = min(samples // 8, _LONGEST_IN_A_HURRY if hurry else _LONGEST_GROWING)
    growing = []
    size = 2
    while size <= longest:
        growing.append(size)
        size *= 2
    first_direct = _first_direct(samples, _FIRST_DIRECT_IN_A_HURRY if hurry else _LONGEST_GROWING)
    return EpochPlan(first_direct, tuple(growing), cached=True)


def direct_samples(n_rays: int, nee_ratio: float) -> int:
    """Next-event samples that go with a pass's rays."""
    return max(int(n_rays * nee_ratio), 1)


def _first_direct(samples: int, most: int) -> int:
    """About an eighth of ``samples``, so that with those of the last epoch every sub-sample has as many."""
    blocks, rest = divmod(samples, _BLOCK)
    later = blocks * direct_samples(_BLOCK, CACHED_NEE_RATIO)
    later += direct_samples(rest, CACHED_NEE_RATIO) if rest else 0
    first = min(max(samples // 8, _BLOCK), most) // _BLOCK * _BLOCK
    return first + -later % _BLOCK


def slice_bounds(samples: int, n_texels: int) -> list[int]:
    """Ray numbers at which the last epoch's slices end.

    Each slice is summed from nothing and the slices are added in order, so that machines that trace
    different slices together give the bytes of one. Small bakes have few, so that their launches
    stay large; every slice is at least one block of sub-samples.
    """
    wanted = min(_MAX_SLICES, samples * n_texels // _SAMPLES_PER_SLICE, samples // _BLOCK)
    n_slices = 1 << max(wanted, 1).bit_length() - 1
    blocks = -(-samples // _BLOCK)
    ends = [min((i + 1) * blocks // n_slices * _BLOCK, samples) for i in range(n_slices)]
    return [*ends[:-1], samples]


def rays_per_pass(n_texels: int) -> int:
    """A power of two that gives a launch a few million rays, and at least one block of sub-samples."""
    return max(_BLOCK, 1 << (_RAYS_PER_LAUNCH // max(n_texels, 1)).bit_length())


def lanes_per_texel(n_texels: int, n_rays: int, wanted_lanes: int) -> int:
    """A power of two by which texels × lanes fill the device, no more than there are blocks of rays."""
    lanes = 1
    while lanes * n_texels < wanted_lanes and n_rays % (2 * lanes * _BLOCK) == 0:
        lanes *= 2
    return lanes
