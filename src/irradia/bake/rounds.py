"""Which texels get the next rays of the last epoch.

The epoch is a sequence of rounds; a round gives the same number of rays to every texel of a list.
Uniform rounds go over all texels slice by slice. Adaptive rounds watch the noise: after a pilot that
all texels share, rays go where they lower the relative error most, or stay where it is above a
target. Decisions come from noise pooled over a texel's neighbours, and are taken on whole rounds, so
that a single bright hit neither starves nor feeds a texel.

With a camera, texels that it sees are a queue of their own, served first. The others have a tenth of
all rays meanwhile, those of earlier epochs counted: what is seen needs their light.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import F32, U32

PILOT = 64  # rays a texel before its noise is trusted
ROUND = 32
SHARE_OF_UNSEEN = 0.1
PERCENTILE = 95.0  # of the texels, that ``--noise`` speaks of


@dataclass(frozen=True)
class Round:
    """Rays for a list of texels.

    Attributes:
        texels: (M,) their numbers, ascending.
        n_rays: For each.
        queue: Which queue is served.
    """

    texels: U32
    n_rays: int
    queue: int


class Rounds(Protocol):
    """A schedule; its state is plain arrays, so that an interrupted bake goes on exactly.

    Attributes:
        rays_per_texel: What all rounds together mean to spend on a texel; None where the end is open.
    """

    @property
    def rays_per_texel(self) -> float | None:
        """See the class."""
        ...

    @property
    def first_ray(self) -> int:
        """Number of the first ray of every texel: not 0 in a shard."""
        ...

    def next(self) -> Round | None:
        """The next round, or None when the epoch is complete."""
        ...

    def done(self, finished: Round) -> None:
        """Takes note that a round has been traced and summed."""
        ...

    def finished(self, queue: int) -> bool:
        """Whether a queue has all its rays."""
        ...

    def keep_only(self, texels: U32) -> None:
        """Leaves all other texels out."""
        ...

    def state(self) -> dict[str, NDArray]:
        """What :meth:`restore` needs."""
        ...

    def restore(self, state: dict[str, NDArray]) -> None:
        """Goes on from a saved state."""
        ...


def serve(spent: Sequence[int], finished: Sequence[bool]) -> int | None:
    """Which queue is next: the first unfinished one, unless a later one is owed its share."""
    waiting = [queue for queue, is_done in enumerate(finished) if not is_done]
    if not waiting:
        return None
    if len(waiting) == 2 and spent[1] < SHARE_OF_UNSEEN * sum(spent):
        return 1
    return waiting[0]


class UniformRounds:
    """The same rays for every texel.

    Args:
        queues: Lists of texels, in order of importance.
        ends: For each queue, ray numbers at which its rounds end; the last is the same for all.
        early_rays: That each texel has had in earlier epochs.
        part: First and end of the rounds to trace, a shard's part of the one queue; None for all.
    """

    def __init__(
        self,
        queues: Sequence[U32],
        ends: Sequence[Sequence[int]],
        *,
        early_rays: int = 0,
        part: tuple[int, int] | None = None,
    ) -> None:
        self._queues = queues
        self._ends = ends
        self._early_rays = early_rays
        self._first, last = part or (0, None)
        self._last = [len(each) if last is None else last for each in ends]
        self._position = np.full(len(queues), self._first, np.int64)
        self._spent = np.zeros(len(queues), np.int64)

    @property
    def rays_per_texel(self) -> float:
        """See :class:`Rounds`."""
        return self._ends[0][self._last[0] - 1] - self.first_ray

    @property
    def first_ray(self) -> int:
        """See :class:`Rounds`."""
        return self._ends[0][self._first - 1] if self._first else 0

    def next(self) -> Round | None:
        """See :class:`Rounds`."""
        spent = [int(s) + self._early_rays * len(q) for s, q in zip(self._spent, self._queues, strict=True)]
        queue = serve(spent, [self.finished(q) for q in range(len(self._queues))])
        if queue is None:
            return None
        ends, position = self._ends[queue], int(self._position[queue])
        before = ends[position - 1] if position else 0
        return Round(self._queues[queue], ends[position] - before, queue)

    def done(self, finished: Round) -> None:
        """See :class:`Rounds`."""
        self._position[finished.queue] += 1
        self._spent[finished.queue] += finished.n_rays * len(finished.texels)

    def finished(self, queue: int) -> bool:
        """See :class:`Rounds`."""
        return self._position[queue] >= self._last[queue] or len(self._queues[queue]) == 0

    def keep_only(self, texels: U32) -> None:
        """See :class:`Rounds`."""
        self._queues = [np.intersect1d(queue, texels) for queue in self._queues]

    def state(self) -> dict[str, NDArray]:
        """See :class:`Rounds`."""
        return {"position": self._position.copy(), "spent": self._spent.copy()}

    def restore(self, state: dict[str, NDArray]) -> None:
        """See :class:`Rounds`."""
        self._position, self._spent = state["position"].copy(), state["spent"].copy()


class AdaptiveRounds:
    """Rays where the noise is.

    Args:
        queues: Lists of texels, in order of importance.
        relative_error: Gives (N,) the present standard error of every texel over its mean (plus 1 %
            of the map's median); asked at most once a round.
        noise: Target: a queue is finished when 95 % of its texels are below. None spreads rays so
            that the mean square relative error falls fastest.
        samples: Mean rays a texel at which a queue is finished, whatever its noise.
        early_rays: That each texel has had in earlier epochs.
    """

    def __init__(
        self,
        queues: Sequence[U32],
        relative_error: Callable[[], F32],
        *,
        noise: float | None,
        samples: int,
        early_rays: int = 0,
    ) -> None:
        self._queues = queues
        self._relative_error = relative_error
        self._noise = noise
        self._samples = samples
        self._early_rays = early_rays
        self._active = list(queues)
        n_texels = int(max((q.max() + 1 for q in queues if len(q)), default=0))
        self._rays = np.zeros(n_texels, np.int64)

    @property
    def rays_per_texel(self) -> float | None:
        """See :class:`Rounds`."""
        return self._samples if self._noise is None else None

    @property
    def first_ray(self) -> int:
        """See :class:`Rounds`."""
        return 0

    def next(self) -> Round | None:
        """See :class:`Rounds`."""
        spent = [int(self._rays[q].sum()) + self._early_rays * len(q) for q in self._queues]
        queue = serve(spent, [self.finished(q) for q in range(len(self._queues))])
        return None if queue is None else Round(self._active[queue], ROUND, queue)

    def done(self, finished: Round) -> None:
        """See :class:`Rounds`."""
        self._rays[finished.texels] += finished.n_rays
        mine = self._queues[finished.queue]
        rays = self._rays[mine]
        if rays.min() < min(PILOT, self._samples):
            return
        if rays.mean() >= self._samples:
            self._active[finished.queue] = mine[:0]
            return
        error = self._relative_error()[mine]
        self._active[finished.queue] = mine[self._wanting(error, rays)]

    def _wanting(self, error: F32, rays: NDArray[np.int64]) -> NDArray[np.bool_]:
        if self._noise is None:
            return wants_rays(error, rays, ROUND)
        if np.percentile(error, PERCENTILE) <= self._noise:
            return np.zeros(len(error), np.bool_)
        return error > self._noise

    def finished(self, queue: int) -> bool:
        """See :class:`Rounds`."""
        return len(self._active[queue]) == 0

    def keep_only(self, texels: U32) -> None:
        """See :class:`Rounds`."""
        self._queues = [np.intersect1d(queue, texels) for queue in self._queues]
        self._active = [np.intersect1d(active, texels) for active in self._active]

    def state(self) -> dict[str, NDArray]:
        """See :class:`Rounds`."""
        active = {f"active-{i}": texels.copy() for i, texels in enumerate(self._active)}
        return {"rays": self._rays.copy(), **active}

    def restore(self, state: dict[str, NDArray]) -> None:
        """See :class:`Rounds`."""
        self._rays = state["rays"].copy()
        self._active = [state[f"active-{i}"].copy() for i in range(len(self._queues))]


def wants_rays(error: F32, rays: NDArray[np.int64], step: int) -> NDArray[np.bool_]:
    """Which texels are behind an allocation of rays in proportion to their standard deviation.

    That allocation makes the sum of squared relative errors smallest. It spends a quarter of a step
    a texel more than has been spent; those that it would give at least half a step are served.

    Args:
        error: (N,) standard error of each texel's mean, relative.
        rays: (N,) rays that it stands on.
        step: Rays that a round gives.
    """
    deviation = error * np.sqrt(rays)
    if not deviation.any():
        return np.zeros(len(error), np.bool_)
    budget = float(rays.sum()) + 0.25 * step * len(rays)
    low, high = 0.0, budget / float(deviation.max())
    while np.maximum(rays, high * deviation).sum() < budget:
        high *= 2.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        if np.maximum(rays, middle * deviation).sum() < budget:
            low = middle
        else:
            high = middle
    wanting = high * deviation >= rays + 0.5 * step
    return wanting if wanting.any() else deviation > 0.0
