"""How samples are spread over epochs, slices and launches."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from irradia.bake.plan import (
    CACHED_NEE_RATIO,
    direct_samples,
    lanes_per_texel,
    plan_epochs,
    rays_per_pass,
    slice_bounds,
)
from irradia.bake.rounds import UniformRounds


def test_growing_epochs_double_up_to_an_eighth_of_the_samples():
    assert plan_epochs(64, cached=True).growing == (2, 4, 8)


def test_growing_epochs_stay_cheap_in_long_bakes():
    plan = plan_epochs(4096, cached=True)
    assert sum(plan.growing) < 4096 / 16


@pytest.mark.parametrize("hurry", [False, True])
@pytest.mark.parametrize("samples", [1, 2, 7, 8, 9, 20, 64, 100, 4096])
def test_every_sub_sample_gets_as_many_next_event_samples(samples: int, hurry: bool):
    passes = [8] * (samples // 8) + [samples % 8] * (samples % 8 > 0)
    later = sum(direct_samples(n, CACHED_NEE_RATIO) for n in passes)
    assert (plan_epochs(samples, cached=True, hurry=hurry).first_direct + later) % 8 == 0


def test_path_bake_is_one_epoch():
    assert plan_epochs(64, cached=False).growing == ()


def test_hurried_bake_spends_less_before_its_last_epoch():
    assert sum(plan_epochs(256, cached=True, hurry=True).growing) < sum(plan_epochs(256, cached=True).growing)


@pytest.mark.parametrize("samples", [256, 1024, 4096])
def test_a_quarter_that_is_seen_first_is_done_within_a_third_of_the_samples(samples: int):
    settling = 8  # rays, rather more than it takes
    plan = plan_epochs(samples, cached=True, hurry=True)
    seen, unseen = np.arange(100_000, dtype=np.uint32), np.arange(100_000, 400_000, dtype=np.uint32)
    ends = [slice_bounds(samples, len(seen)), slice_bounds(samples, 400_000)]
    rounds = UniformRounds([seen, unseen], ends, early_rays=sum(plan.growing))
    traced = [0, 0]
    while not rounds.finished(0):
        turn = rounds.next()
        assert turn is not None
        rounds.done(turn)
        traced[turn.queue] += len(turn.texels) * turn.n_rays
    early = 400_000 * (plan.first_direct + settling + sum(plan.growing))
    with_direct = 1.0 + CACHED_NEE_RATIO
    assert early + with_direct * sum(traced) < 0.34 * (early + with_direct * 400_000 * samples)
    assert 300_000 * sum(plan.growing) + traced[1] > 0.09 * (400_000 * sum(plan.growing) + sum(traced))


@pytest.mark.parametrize("samples", [1, 7, 8, 64, 100, 1000, 4096])
@pytest.mark.parametrize("n_texels", [1, 5_000, 1_000_000])
def test_slices_rise_to_the_samples_in_blocks_of_sub_samples(samples: int, n_texels: int):
    ends = slice_bounds(samples, n_texels)
    assert ends[-1] == samples
    assert all(before < after for before, after in itertools.pairwise(ends))
    assert all(end % 8 == 0 for end in ends[:-1])


def test_large_bake_has_enough_slices_for_a_farm():
    assert len(slice_bounds(1024, 1_000_000)) == 32


def test_tiny_bake_is_not_cut_into_tiny_launches():
    assert len(slice_bounds(1024, 1_000)) == 1


@pytest.mark.parametrize("n_texels", [1, 1_000, 300_000, 5_000_000])
def test_launch_has_a_few_million_rays_or_one_block_a_texel(n_texels: int):
    n_rays = rays_per_pass(n_texels)
    assert n_rays == 8 or 4e6 <= n_rays * n_texels <= 9e6


def test_few_texels_are_served_by_several_lanes_each():
    lanes = lanes_per_texel(100, 4096, wanted_lanes=8192)
    assert lanes * 100 >= 8192
    assert 4096 % (lanes * 8) == 0


def test_many_texels_have_a_lane_each():
    assert lanes_per_texel(100_000, 64, wanted_lanes=8192) == 1
