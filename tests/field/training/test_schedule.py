"""Learning rates."""

from __future__ import annotations

import pytest

from irradia.core.errors import InputError
from irradia.field.training import DataOptions, TrainOptions
from irradia.field.training.schedule import progress, rates


def test_rates_fall_exponentially_from_the_first_to_the_final_share():
    options = TrainOptions(steps=100, lr_encoding=0.02, lr_network=0.004, lr_final=0.01)
    at_first, halfway, at_last = (rates(options, progress(options, step, 0.0)) for step in (0, 50, 100))
    assert (at_first.encoding, at_first.network) == (0.02, 0.004)
    assert halfway.encoding == pytest.approx(0.002)
    assert at_last.network == pytest.approx(0.00004)


def test_what_setbacks_left_multiplies_both_rates():
    options = TrainOptions()
    assert rates(options, 0.3, 0.25).encoding == pytest.approx(rates(options, 0.3).encoding / 4)
    assert rates(options, 0.3, 0.25).network == pytest.approx(rates(options, 0.3).network / 4)


def test_progress_is_by_steps_or_time_whichever_is_further():
    assert progress(TrainOptions(steps=200), 50, 1e9) == 0.25
    assert progress(TrainOptions(steps=None, time_s=10.0), 1_000_000, 4.0) == 0.4
    both = TrainOptions(steps=200, time_s=10.0)
    assert progress(both, 50, 8.0) == 0.8
    assert progress(both, 150, 1.0) == 0.75
    assert progress(both, 150, 99.0) == 1.0


@pytest.mark.parametrize(
    "wrong",
    [
        {"steps": None},
        {"steps": 0},
        {"time_s": 0.0},
        {"batch_size": 0},
        {"lr_encoding": -1.0},
        {"lr_network": float("nan")},
        {"lr_final": 0.0},
        {"lr_final": 1.5},
        {"average": 1.0},
        {"validate_every": 0},
        {"early_stop": 0},
    ],
)
def test_options_that_make_no_sense_are_refused(wrong):
    with pytest.raises(InputError, match="expected"):
        TrainOptions(**wrong)


@pytest.mark.parametrize(
    "wrong",
    [
        {"jitter_copies": -1},
        {"jitter_radius_m": 0.0},
        {"smooth_k": -1},
        {"smooth_normal_threshold": 2.0},
        {"hold_out_blocks": 0.9},
        {"memory_bytes": 0},
    ],
)
def test_data_options_that_make_no_sense_are_refused(wrong):
    with pytest.raises(InputError, match="expected"):
        DataOptions(**wrong)


def test_how_often_to_save_is_no_part_of_what_must_stay_the_same():
    assert TrainOptions(checkpoint_s=1.0).identity() == TrainOptions(checkpoint_s=9.0).identity()
    assert TrainOptions(seed=1).identity() != TrainOptions(seed=2).identity()
