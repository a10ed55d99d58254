"""Which rows a step sees."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.field.training.batches import MemorySource, draw
from irradia.field.training.events import Remark, Working
from irradia.field.training.options import DataOptions
from irradia.field.training.prepare import DataPlan, prepare
from irradia.field.training.rows import BatchMemory, Rows, frame_of, held_out
from irradia.field.training.windows import N_GROUPS, WindowSource

SEED = Seed(3)


@pytest.fixture
def numbered(make):
    """Samples whose first value is their number plus 1."""
    samples = make(1000)
    samples.rows[:, 6] = np.arange(1, 1001)
    return samples


def source_of(samples, **options):
    kept_back = held_out(samples, SEED, rows=options.pop("rows", False), blocks=options.pop("blocks", 0.0))
    plan = DataPlan(frame_of(samples), kept_back, DataOptions(**options), 64, SEED)
    events = []
    preparing = prepare(samples, plan)
    while True:
        try:
            events.append(next(preparing))
        except StopIteration as end:
            return end.value, events


def numbers(samples, batch):
    return np.rint(batch.target[:, 0] * frame_of(samples).scale).astype(int) - 1


def window(samples, block_rows=8, rows=False, n_blocks_in_memory=2 * N_GROUPS):
    memory = n_blocks_in_memory * block_rows * samples.info.n_columns * 4
    kept_back = held_out(samples, SEED, rows=rows, blocks=0.0)
    return WindowSource(samples, frame_of(samples), kept_back, memory, SEED, 16, block_rows)


def test_a_batch_depends_on_seed_and_step_alone():
    drawn = draw(1000, 7, 64, SEED)
    draw(1000, 3, 999, SEED)
    assert np.array_equal(drawn, draw(1000, 7, 64, SEED))
    assert not np.array_equal(drawn, draw(1000, 8, 64, SEED))
    assert not np.array_equal(drawn, draw(1000, 7, 64, Seed(4)))


def test_every_row_is_as_likely():
    counts = np.bincount(np.concatenate([draw(50, step, 1000, SEED) for step in range(100)]), minlength=50)
    deviation = (counts - 2000) / np.sqrt(2000)
    assert np.abs(deviation).max() < 4.5  # of 50, each normal
    assert len(counts) == 50


def test_a_batch_is_in_units_of_the_frame(make):
    samples = make()
    source, _ = source_of(samples)
    batch = source.batch(0, 256, SEED)
    index = draw(len(samples), 0, 256, SEED)
    frame = frame_of(samples)
    assert np.array_equal(batch.x, frame.to_unit(samples.positions[index]))
    assert np.array_equal(batch.normal, samples.normals[index])
    assert np.array_equal(batch.target, samples.values[index] / np.float32(frame.scale))
    assert batch.target.flags.c_contiguous


def test_the_file_itself_is_not_changed(make):
    samples = make()
    before = samples.rows.copy()
    source_of(samples, smooth_k=3)
    assert np.array_equal(samples.rows, before)


def test_sh_batches_have_no_normal(make):
    samples = make(kind="sh", n_coefficients=9)
    batch = source_of(samples)[0].batch(0, 16, SEED)
    assert batch.normal is None
    assert batch.target.shape == (16, 27)


def test_what_is_held_out_is_never_drawn(numbered):
    kept_back = held_out(numbered, SEED, rows=True, blocks=0.2)
    learned = kept_back.learned(np.arange(1000), numbered.positions)
    assert 500 < learned.sum() < 950
    source, _ = source_of(numbered, rows=True, blocks=0.2)
    drawn = np.concatenate([numbers(numbered, source.batch(step, 256, SEED)) for step in range(50)])
    assert set(drawn) == set(np.flatnonzero(learned))


def test_rows_held_out_are_about_two_per_cent(make):
    samples = make(20_000)
    share = held_out(samples, SEED, rows=True, blocks=0.0).rows_of(np.arange(20_000)).mean()
    assert share == pytest.approx(0.02, abs=0.003)


def test_blocks_held_out_are_whole_cells_of_space(make):
    samples = make(10)
    kept_back = held_out(samples, SEED, rows=False, blocks=0.5)
    edge = 2.0 / 32  # of the box's longest edge
    corner = np.floor(np.random.default_rng(1).random((400, 3)) * [16, 32, 16]) * edge
    inside = [
        kept_back.in_blocks((corner + np.array(shift) * edge).astype(np.float32))
        for shift in ((0.1, 0.1, 0.1), (0.9, 0.1, 0.5), (0.5, 0.9, 0.9))
    ]
    assert np.array_equal(inside[0], inside[1])
    assert np.array_equal(inside[0], inside[2])
    assert 0.4 < inside[0].mean() < 0.6


def test_windows_meet_every_row_in_a_pass(numbered):
    source = window(numbered)
    drawn = np.concatenate([numbers(numbered, source.batch(step, 16, SEED)) for step in range(63 * 8)])
    counts = np.bincount(drawn, minlength=1000)
    assert (counts > 0).mean() > 0.99
    assert counts[:500].sum() == pytest.approx(counts[500:].sum(), rel=0.05)


def test_a_window_holds_rows_from_all_over_the_file(numbered):
    drawn = numbers(numbered, window(numbered).batch(0, 512, SEED))
    assert len(np.unique(drawn // 100)) >= 6
    assert len(np.unique(drawn)) <= 2 * N_GROUPS * 8  # but no more than fits


def test_a_window_of_a_later_step_needs_none_before_it(numbered):
    passing, jumping = window(numbered), window(numbered)
    for step in range(200):
        passing.batch(step, 16, SEED)
    there = passing.batch(199, 16, SEED).target
    assert np.array_equal(there, jumping.batch(199, 16, SEED).target)


def test_windows_never_show_what_is_held_out(numbered):
    kept = ~held_out(numbered, SEED, rows=True, blocks=0.0).rows_of(np.arange(1000))
    source = window(numbered, rows=True)
    drawn = np.concatenate([numbers(numbered, source.batch(step, 64, SEED)) for step in range(300)])
    assert kept[drawn].all()


def test_windows_move_on(numbered):
    source = window(numbered)
    first, later = (set(numbers(numbered, source.batch(step, 512, SEED))) for step in (0, 40))
    assert len(first & later) < 0.6 * len(first)


def test_a_file_that_fits_is_read_as_a_whole_and_a_larger_one_by_windows(make):
    small, told = source_of(make(200))
    assert isinstance(small, MemorySource)
    assert any(isinstance(event, Working) and event.stage == "Read samples" for event in told)
    large, told = source_of(make(200), memory_bytes=1000)
    assert isinstance(large, WindowSource)
    assert any(isinstance(event, Remark) and "windows" in event.text for event in told)


@pytest.mark.parametrize("wish", [{"smooth_k": 4}, {"jitter_copies": 1}])
def test_samples_beyond_memory_can_be_neither_smoothed_nor_jittered(make, wish):
    with pytest.raises(InputError, match="MiB of memory"):
        source_of(make(200), memory_bytes=1000, **wish)


def test_samples_in_space_are_jittered_only_with_a_test_by_rays(make):
    with pytest.raises(InputError, match="don't know where walls are"):
        source_of(make(200, kind="volume"), jitter_copies=1)


def test_copies_add_rows_with_the_values_of_their_samples(make):
    samples = make(300)
    samples.rows[:, 3:6] = (0.0, 0.0, 1.0)
    samples.rows[:, 2] = 0.5
    source, _ = source_of(samples, jitter_copies=2, jitter_radius_m=0.02)
    assert source.n_rows > 800
    targets = {tuple(row) for row in source.batch(0, 4096, SEED).target}
    assert targets <= {tuple(row) for row in samples.values / np.float32(frame_of(samples).scale)}


@pytest.mark.parametrize(("mean", "scale"), [(1.0, 1.0), (1.3, 1.0), (1.5, 2.0), (0.1, 0.125), (0.0, 1.0)])
def test_the_scale_is_the_power_of_two_nearest_to_the_mean(make, mean, scale):
    samples = make()
    samples.rows[:, 6:9] = mean * np.array([0.5, 0.75, 1.75])
    assert frame_of(samples).scale == scale


def test_the_scale_of_coefficients_takes_their_magnitude(make):
    samples = make(kind="sh", n_coefficients=4)
    samples.rows[:, 3:-1] = np.tile([4.0, -4.0], 6)
    assert frame_of(samples).scale == 4.0


def test_columns_come_apart_as_position_normal_and_value():
    rows = Rows(np.arange(30, dtype=np.float32).reshape(3, 10), has_normals=True)
    batch = BatchMemory(2, 10, has_normals=True).take(rows.packed, np.array([2, 0]))
    assert batch.x.tolist() == [[20, 21, 22], [0, 1, 2]]
    assert batch.normal is not None
    assert batch.normal.tolist() == [[23, 24, 25], [3, 4, 5]]
    assert batch.target.tolist() == [[26, 27, 28], [6, 7, 8]]
