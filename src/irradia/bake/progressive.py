"""The bake as a sequence of passes, each leaving the map a little better.

A gather ray that meets a surface reads the light leaving it from the map of the previous epoch;
each epoch starts its own sums from nothing. Short epochs carry the light around until the map's
mean has settled, a few longer ones replace their noise, and the last, whose cache is frozen, is
the result: its samples are independent. A running mean that read itself would converge like
n^−(1−ρ) and never get there.

Between any two passes the bake can be looked at, stopped, saved and taken up again.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from irradia.bake.plan import EpochPlan, direct_samples, lanes_per_texel, rays_per_pass
from irradia.bake.rounds import Rounds
from irradia.bake.settle import rays_to_settle, settle
from irradia.core import Progress, Seed
from irradia.scene.types import F32, U32

if TYPE_CHECKING:
    from irradia.core.progress import Stage
    from irradia.transport.radiosity import TexelCache
    from irradia.transport.texel_light import Draw, TexelColour, TexelLight
    from irradia.transport.texel_noise import NoiseMeter
    from irradia.transport.texel_sums import Lanes, TexelSums

Phase = Literal["first light", "light bounces", "gather"]
_SHARE_BEFORE_LAST = 0.25  # of a time budget, for the epochs before the last


@dataclass(frozen=True)
class Epoch:
    """One epoch as it went: mean rays per texel, and the map's mean after it."""

    rays: float
    mean: float


@dataclass(frozen=True)
class Pass:
    """What one pass did.

    Attributes:
        phase: Where the bake stands.
        texels: (M,) which texels it changed.
        elapsed_s: Tracing time so far, earlier sessions counted.
        read: Gives (M, 3) their E/π now; it costs a read-back, which only those who look pay.
    """

    phase: Phase
    texels: U32
    elapsed_s: float
    read: Callable[[], F32]


@dataclass
class Progression:
    """How far a bake is: all that an interrupted one needs to go on.

    Attributes:
        direct: First next-event samples, which every epoch's cache shares.
        part: Sums of the running epoch, or of the last epoch's running round.
        total: Complete rounds of the last epoch.
        settled: E/π that the present cache is made of; None before the map has settled.
        n_grown: Growing epochs that are complete.
        epochs: Every epoch that is complete.
        spent_s: Time spent.
        n_rays: Gather rays so far, all epochs and texels together.
    """

    direct: TexelSums
    part: TexelSums
    total: TexelSums
    settled: TexelColour | None = None
    n_grown: int = 0
    epochs: list[Epoch] = field(default_factory=list)
    spent_s: float = 0.0
    n_rays: int = 0


class ProgressiveBake:
    """A bake that can be watched and stopped.

    Args:
        light: The texels.
        plan: Epochs before the last.
        rounds: The last epoch.
        meter: Keeps the noise of its rounds.
        texels: (M,) the texels that are traced at all.
        seed: Root of the bake's random numbers.
        samples: Rays per texel that the last epoch means to draw; settling epochs go by it.
        time_s: Ends when another pass would take longer than this; None for no limit.
        one_bounce: Whether light ends where it first arrives; then the plan has no cache.

    Attributes:
        launches: Kernel launches of the latest pass.
        before_the_last_epoch: Asked which texels get the last epoch's rays; None for all.
        keep_slices: A list to which every round's sums are added before they are folded, or None.
    """

    def __init__(
        self,
        light: TexelLight,
        plan: EpochPlan,
        rounds: Rounds,
        meter: NoiseMeter,
        texels: U32,
        seed: Seed,
        *,
        samples: int,
        time_s: float | None = None,
        one_bounce: bool = False,
    ) -> None:
        self.light, self.plan, self.rounds, self.meter, self.texels = light, plan, rounds, meter, texels
        self.launches = 0
        self.keep_slices: list[dict[str, NDArray]] | None = None
        self.before_the_last_epoch: Callable[[], U32 | None] | None = None
        self.progression = Progression(light.empty_sums(), light.empty_sums(), light.empty_sums())
        self._seed, self._samples, self._time_s = seed, samples, time_s
        self._reflectance: TexelColour | None = light.reflectance()
        self._one_bounce = one_bounce
        self._stopped = False
        self._gathering = False  # whether the last epoch has had a pass: a time limit leaves it that
        self._longest_pass_s = 0.0
        self._origin = 0.0

    def stop(self) -> None:
        """Asks the bake to end after the running pass."""
        self._stopped = True

    @property
    def stopped(self) -> bool:
        """Whether it was asked to end before it was complete."""
        return self._stopped and not self.complete

    @property
    def complete(self) -> bool:
        """Whether all rounds are done."""
        return self._in_last_epoch and self.rounds.next() is None

    @property
    def _in_last_epoch(self) -> bool:
        now = self.progression
        return now.n_grown >= len(self.plan.growing) and (now.settled is not None or not self.plan.cached)

    def passes(self, progress: Progress) -> Iterator[Pass]:
        """Runs the bake from where it stands."""
        now = self.progression
        self._origin = time.perf_counter() - now.spent_s
        if now.settled is None:
            yield from self._first_light(progress)
            if self.plan.cached and not self._stopped:
                self._settle(progress)
                yield self._report("light bounces", self.texels)
        with progress.stage("gather", self._rays_ahead(), "samples") as stage:
            while not self._stopped and not self._in_last_epoch:
                if self._out_of_time(_SHARE_BEFORE_LAST):
                    now.n_grown, now.part = len(self.plan.growing), self.light.empty_sums()
                else:
                    yield from self._grow(stage)
            if not self._stopped:
                yield from self._last_epoch(stage)

    def _first_light(self, progress: Progress) -> Iterator[Pass]:
        """Light straight from sources, which depends on no cache: once is enough for all epochs."""
        now, n_direct = self.progression, self.plan.first_direct
        if n_direct == 0:
            return
        nothing = self._nothing()  # as large as a page, and needed by no later pass
        with progress.stage("first light", len(self.texels) * n_direct, "samples") as stage:
            done = self._count(now.direct.samples)
            while done < n_direct and not self._stopped:
                n = min(2 * rays_per_pass(len(self.texels)), n_direct - done)
                with self._timed():
                    now.direct = self.light.add_rays(
                        now.direct, self._lanes(self.texels, n), self._draw(0, n), nothing
                    )
                    self.light.wait()
                done += n
                stage.advance(n * len(self.texels))
                yield self._report("first light", self.texels)
        now.direct = now.direct.without_rays()  # zeros that take no memory

    def _settle(self, progress: Progress) -> None:
        now = self.progression
        n_rays = rays_to_settle(self.light.n_texels, self._samples)
        seed = self._seed.child("settle").uint32()
        lanes = self._lanes(self.texels, n_rays)

        def bounce(arriving: TexelColour, scale: float) -> TexelColour:
            cache = self._cache(arriving, scale)
            sums = self.light.add_rays(self.light.empty_sums(), lanes, self._draw(n_rays, 0, seed), cache)
            return self.light.incoming(sums, now.direct)

        with progress.stage("light bounces") as stage, self._timed():

            def each(mean: float) -> None:
                now.epochs.append(Epoch(n_rays, mean))
                stage.note(f"{len(now.epochs)} epochs")

            now.settled = settle(self.light.incoming(now.direct), bounce, self.light.mean, each)
        self.light.give_back()
        now.n_rays += n_rays * len(self.texels) * len(now.epochs)
        now.total = now.direct.without_rays()

    def _grow(self, stage: Stage) -> Iterator[Pass]:
        """One epoch from nothing; the map it makes is the next one's cache."""
        now = self.progression
        size, cache = self.plan.growing[now.n_grown], self._cache(self._known_before)
        drawn = self._count(now.part.rays)
        while drawn < size and not self._stopped:
            n = min(rays_per_pass(len(self.texels)), size - drawn)
            self._trace(self._lanes(self.texels, n), n, 0, cache, stage)
            drawn += n
            yield self._report("gather", self.texels)
        if drawn >= size:
            now.settled = self.light.incoming(now.part, now.direct)
            now.part = self.light.empty_sums()
            now.epochs.append(Epoch(size, self.light.mean(now.settled)))
            now.n_grown += 1

    def _last_epoch(self, stage: Stage) -> Iterator[Pass]:
        """Rounds with a frozen cache."""
        now = self.progression
        if self.before_the_last_epoch is not None:
            chosen = self.before_the_last_epoch()
            if chosen is not None:
                self.rounds.keep_only(chosen)
        cache = self._cache(self._known_before) if self.plan.cached else self._nothing()
        while (turn := self.rounds.next()) is not None:
            drawn = int(np.array(now.part.rays)[turn.texels[0]])
            while drawn < turn.n_rays:
                if self._stopped or (self._gathering and self._out_of_time(1.0)):
                    return
                n = min(rays_per_pass(len(turn.texels)), turn.n_rays - drawn)
                n_direct = direct_samples(n, self.light.nee_ratio)
                self._trace(self._lanes(turn.texels, n), n, n_direct, cache, stage, self._before())
                drawn += n
                self._gathering = True
                yield self._report("gather", turn.texels)
            if self.keep_slices is not None:
                self.keep_slices.append(now.part.to_arrays())
            self.meter.fold(now.total, now.part)
            now.part = self.light.empty_sums()
            self.rounds.done(turn)
        del cache
        self.light.give_back()
        now.epochs.append(Epoch(self._mean_rays(), self.light.mean(self.estimate())))

    def _before(self) -> TexelSums:
        """Complete rounds of the last epoch, those of other shards counted."""
        skipped = self.rounds.first_ray
        return self.progression.total.counting_from(skipped, int(skipped * self.light.nee_ratio))

    def _trace(
        self,
        lanes: Lanes,
        n_rays: int,
        n_direct: int,
        cache: TexelCache | None,
        stage: Stage,
        after: TexelSums | None = None,
    ) -> None:
        now = self.progression
        draw = self._draw(n_rays, n_direct, self._seed.child(f"epoch-{now.n_grown}").uint32(), now.n_grown)
        with self._timed():
            now.part, self.launches = self.light.count_launches(
                lambda: self.light.add_rays(now.part, lanes, draw, cache, after=after)
            )
        now.n_rays += n_rays * lanes.n_texels
        stage.advance(n_rays * lanes.n_texels)

    def _draw(self, n_rays: int, n_direct: int, seed: int = 0, first_subsample: int = 0) -> Draw:
        from irradia.transport.texel_light import Draw

        return Draw(n_rays, n_direct, seed, self._seed.child("direct").uint32(), first_subsample)

    def _nothing(self) -> TexelCache | None:
        """What rays read that find no light of surfaces."""
        return self.light.cache_of_nothing(self.plan.cached, one_bounce=self._one_bounce)

    def _cache(self, arriving: TexelColour, scale: float = 1.0) -> TexelCache:
        if self._reflectance is None:
            raise RuntimeError("this bake has given its memory back")
        return self.light.cache(arriving, self._reflectance, scale)

    def _lanes(self, texels: U32, n_rays: int) -> Lanes:
        per_texel = lanes_per_texel(len(texels), n_rays, self.light.wanted_lanes)
        return self.light.lanes(texels, per_texel)

    def _count(self, counts: object) -> int:
        """How many samples every texel has, where all have the same."""
        return int(np.array(counts)[self.texels[0]]) if len(self.texels) else 0

    def _rays_ahead(self) -> float | None:
        """All rays of growing epochs and the last; None where the end is open."""
        each = self.rounds.rays_per_texel
        return None if each is None else len(self.texels) * (sum(self.plan.growing) + each)

    def take(self, direct: TexelSums, slices: Iterable[TexelSums]) -> None:
        """Takes what others have traced: the sums before the last epoch, and its slices in order."""
        now = self.progression
        now.direct, now.total = direct, direct.without_rays()
        for part in slices:
            self.meter.fold(now.total, part)
        now.settled, now.n_grown = self.light.incoming(direct), len(self.plan.growing)
        while (turn := self.rounds.next()) is not None:
            self.rounds.done(turn)
        now.n_rays = int(np.array(now.total.rays).sum(dtype=np.int64))
        now.epochs.append(Epoch(self._mean_rays(), self.light.mean(self.estimate())))

    def fill_in(self, before: TexelSums) -> None:
        """Takes an earlier bake's samples for the texels that have had none."""
        from irradia.transport.backend import dr

        now = self.progression
        bare = now.total.plus(now.part).rays == 0
        now.total = before.where(bare, now.total)
        dr.eval(now.total)

    def cache_hash(self) -> str:
        """Of the light that the last epoch gathers from."""
        return hashlib.sha256(np.array(self._known_before).tobytes()).hexdigest()

    # ---- what is known ----

    def estimate(self) -> TexelColour:
        """E/π as known now: of the last epoch where it has been, else of the one before."""
        from irradia.transport.backend import dr

        now = self.progression
        if not self._in_last_epoch:
            return self._known_before
        sums = now.total.plus(now.part)
        return dr.select(sums.rays > 0, sums.mean(), self._known_before)

    def moments(self) -> F32:
        """(N, k, 3) means of the directional moments."""
        now, channels = self.progression, self.light.channels
        sums = now.total.plus(now.part)
        return np.stack(
            [self.light.to_host(sums.mean(c)) for c in range(channels.first_moment, channels.count)], axis=1
        )

    def coarse(self) -> TexelColour:
        """E/π before the last epoch: the same random numbers give the same noise again."""
        return self._known_before

    def release(self) -> None:
        """Gives everything on the device back. Nothing can be asked or traced afterwards."""
        from irradia.transport.backend import dr

        empty = self.light.empty_sums()
        self.progression = replace(self.progression, direct=empty, part=empty, total=empty, settled=None)
        self._reflectance = None
        self.meter.release()
        dr.flush_malloc_cache()

    def live_light(self) -> TexelColour:
        """First bounce of the lights that are lit live: in no map, but surfaces shine with it."""
        return self.progression.total.plus(self.progression.part).mean(1)

    def clamped_off_share(self) -> float | None:
        """Share of the light that a clamp has cut off, where there is one."""
        channels = self.light.channels
        if channels.clamp is None:
            return None
        sums = self.progression.total.plus(self.progression.part)
        lost = self.light.mean(sums.mean(channels.clamped_off))
        return lost / max(lost + self.light.mean(sums.mean()), 1e-30)

    @property
    def _known_before(self) -> TexelColour:
        """E/π that the present epoch's cache is made of."""
        now = self.progression
        return self.light.incoming(now.direct) if now.settled is None else now.settled

    def sample_counts(self) -> NDArray[np.uint32]:
        """(N,) gather rays of the last epoch in each texel."""
        now = self.progression
        return np.array(now.total.rays + now.part.rays) * np.uint32(self._in_last_epoch)

    def _mean_rays(self) -> float:
        return float(self.sample_counts()[self.texels].mean()) if len(self.texels) else 0.0

    def _report(self, phase: Phase, texels: U32) -> Pass:
        return Pass(
            phase,
            texels,
            self.progression.spent_s,
            lambda: self.light.to_host(self.estimate())[texels],
        )

    # ---- time ----

    @contextmanager
    def _timed(self) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self._longest_pass_s = max(self._longest_pass_s, time.perf_counter() - start)
        self.progression.spent_s = time.perf_counter() - self._origin

    def _out_of_time(self, share: float) -> bool:
        if self._time_s is None:
            return False
        return self.progression.spent_s + self._longest_pass_s > share * self._time_s
