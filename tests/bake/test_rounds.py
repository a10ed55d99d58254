"""Who gets the next rays."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.rounds import PILOT, ROUND, AdaptiveRounds, Round, Rounds, UniformRounds, serve, wants_rays

SEEN = np.arange(0, 100, dtype=np.uint32)
UNSEEN = np.arange(100, 400, dtype=np.uint32)


def _run(rounds: Rounds, n: int = 10_000) -> list[Round]:
    done = []
    while (turn := rounds.next()) is not None and len(done) < n:
        rounds.done(turn)
        done.append(turn)
    return done


def test_uniform_rounds_give_every_texel_all_samples():
    rays = np.zeros(400, int)
    for turn in _run(UniformRounds([SEEN, UNSEEN], [[32, 64], [8, 24, 64]])):
        rays[turn.texels] += turn.n_rays
    assert (rays == 64).all()


def test_seen_texels_are_finished_before_a_fifth_of_the_others_rays_are_spent():
    rounds = UniformRounds([SEEN, UNSEEN], [range(8, 513, 8)] * 2)
    spent = [0, 0]
    while not rounds.finished(0):
        turn = rounds.next()
        assert turn is not None
        rounds.done(turn)
        spent[turn.queue] += turn.n_rays * len(turn.texels)
    assert 0.09 <= spent[1] / sum(spent) <= 0.15
    assert _run(rounds)[-1].queue == 1


@pytest.mark.parametrize("adaptive", [False, True])
def test_unseen_texels_that_have_had_their_tenth_before_wait(adaptive: bool):
    queues, noise = [SEEN, UNSEEN], _Noise(np.ones(400))
    if adaptive:
        rounds: Rounds = AdaptiveRounds(queues, noise.error, noise=None, samples=512, early_rays=20)
    else:
        rounds = UniformRounds(queues, [range(32, 513, 32)] * 2, early_rays=20)
    order = [turn.queue for turn in _run(rounds)]
    assert order[:16] == [0] * 16  # 20 · 300 rays of 20 · 400 + 512 · 100 are a tenth
    assert set(order[16:]) == {1}


def test_nothing_is_served_when_all_is_done():
    assert serve([5, 5], [True, True]) is None


def test_shards_together_are_the_whole():
    ends = list(range(8, 65, 8))
    whole = [(t.n_rays, t.queue) for t in _run(UniformRounds([SEEN], [ends]))]
    parts = [
        (t.n_rays, t.queue)
        for i in range(3)
        for t in _run(UniformRounds([SEEN], [ends], part=(i * 8 // 3, (i + 1) * 8 // 3)))
    ]
    assert parts == whole


class _Noise:
    """Texels whose error falls with the root of their rays."""

    def __init__(self, deviation: np.ndarray) -> None:
        self.deviation = deviation
        self.rays = np.zeros(len(deviation))

    def error(self) -> np.ndarray:
        return (self.deviation / np.sqrt(np.maximum(self.rays, 1))).astype(np.float32)

    def run(self, rounds: Rounds) -> None:
        while (turn := rounds.next()) is not None:
            self.rays[turn.texels] += turn.n_rays
            rounds.done(turn)


def test_noise_target_is_met_by_nineteen_texels_of_twenty():
    noise = _Noise(np.linspace(0.1, 3.0, 400))
    everything = np.arange(400, dtype=np.uint32)
    noise.run(AdaptiveRounds([everything], noise.error, noise=0.1, samples=1 << 20))
    assert np.percentile(noise.error(), 95) <= 0.1
    assert noise.rays.min() == PILOT
    assert noise.rays.max() > 5 * PILOT


def test_every_texel_gets_the_pilot_first():
    noise = _Noise(np.zeros(400))
    noise.run(AdaptiveRounds([np.arange(400, dtype=np.uint32)], noise.error, noise=0.1, samples=1 << 20))
    assert (noise.rays == PILOT).all()


def test_adaptive_budget_beats_uniform_at_equal_rays():
    deviation = np.where(np.arange(400) < 40, 5.0, 0.3)
    noise = _Noise(deviation)
    noise.run(AdaptiveRounds([np.arange(400, dtype=np.uint32)], noise.error, noise=None, samples=512))
    assert noise.rays.mean() == pytest.approx(512, rel=0.1)
    uniform = np.mean(deviation**2 / noise.rays.mean())
    assert np.mean(noise.error() ** 2) < 0.5 * uniform


def test_allocation_follows_the_standard_deviation():
    rays = np.full(100, 64)
    error = np.where(np.arange(100) < 10, 1.0, 0.01).astype(np.float32)
    assert wants_rays(error, rays, ROUND).tolist() == [True] * 10 + [False] * 90


def test_map_without_noise_wants_no_rays():
    assert not wants_rays(np.zeros(10, np.float32), np.full(10, 64), ROUND).any()


@pytest.mark.parametrize("adaptive", [False, True])
def test_restored_rounds_go_on_as_if_never_stopped(adaptive: bool):
    def make(noise: _Noise) -> Rounds:
        if adaptive:
            return AdaptiveRounds([SEEN, UNSEEN], noise.error, noise=0.05, samples=1 << 20)
        return UniformRounds([SEEN, UNSEEN], [range(16, 129, 16), range(8, 129, 8)])

    whole, broken = _Noise(np.linspace(0.1, 3.0, 400)), _Noise(np.linspace(0.1, 3.0, 400))
    whole.run(make(whole))
    first = make(broken)
    for _ in range(7):
        turn = first.next()
        assert turn is not None
        broken.rays[turn.texels] += turn.n_rays
        first.done(turn)
    second = make(broken)
    second.restore(first.state())
    broken.run(second)
    assert (whole.rays == broken.rays).all()
