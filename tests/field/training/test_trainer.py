"""The course of a training."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.field.backend import Rates, Stepper
from irradia.field.backends import backend as find_backend
from irradia.field.backends.numpy_backend import NumpyBackend
from irradia.field.encodings import Frequency, HashGrid
from irradia.field.spec import FieldSpec
from irradia.field.training import (
    DataOptions,
    Finished,
    Remark,
    Saved,
    Stepped,
    SteppedBack,
    TrainContext,
    TrainOptions,
    Validated,
    train,
)
from irradia.field.training import run as course
from irradia.field.training.checkpoint import load_checkpoint

OPTIONS = TrainOptions(steps=40, batch_size=64, validate_every=10, lr_network=0.01)


def same(one, other) -> bool:
    return one.keys() == other.keys() and all(np.array_equal(one[name], other[name]) for name in one)


def test_training_lowers_loss_and_error(run, samples):
    events = run(samples, replace(OPTIONS, steps=300, validate_every=50))
    losses = [event.loss for event in events if isinstance(event, Stepped)]
    errors = [event.figures.relmse for event in events if isinstance(event, Validated)]
    assert np.mean(losses[-20:]) < 0.2 * np.mean(losses[:20])
    assert errors[-1] < 0.3 * errors[0]


def test_the_last_event_says_what_was_trained(finished, samples, spec):
    last = finished(samples, OPTIONS)
    assert last.why == "steps"
    assert last.step == 40
    assert last.parameters.keys() == spec.parameter_shapes().keys()
    assert last.n_samples == len(samples) - last.figures.n_samples
    assert np.array_equal(last.frame.aabb, samples.aabb)
    assert last.frame.scale == 8.0  # the mean is 7.5


def test_the_same_seed_gives_the_same_bits_and_another_does_not(finished, samples):
    first = finished(samples, OPTIONS)
    assert same(first.parameters, finished(samples, OPTIONS).parameters)
    assert not same(first.parameters, finished(samples, replace(OPTIONS, seed=1)).parameters)


@pytest.mark.parametrize("extra", [{}, {"early_stop": 3}, {"data": DataOptions(memory_bytes=2048)}])
def test_resuming_gives_the_bytes_of_never_having_stopped(finished, samples, tmp_path, extra):
    options = replace(OPTIONS, **extra)
    whole = finished(samples, options)
    steps = []

    def stop() -> bool:
        steps.append(1)
        return len(steps) > 17

    path = tmp_path / "stopped.npz"
    stopped = finished(samples, options, checkpoint=path, stop=stop)
    resumed = finished(samples, options, checkpoint=path, resume=True)
    assert (stopped.why, stopped.step) == ("stopped", 17)
    assert resumed.step == 40
    assert same(resumed.parameters, whole.parameters)
    assert (resumed.loss, resumed.figures) == (whole.loss, whole.figures)


def test_a_killed_training_goes_on_from_its_last_checkpoint(finished, spec, samples, tmp_path):
    options = replace(OPTIONS, checkpoint_s=1e-9)
    context = TrainContext(backend="numpy", checkpoint=tmp_path / "killed.npz")
    for event in train(samples, spec, options, context):
        if isinstance(event, Saved) and event.step == 23:
            break
    resumed = finished(samples, options, checkpoint=tmp_path / "killed.npz", resume=True)
    assert same(resumed.parameters, finished(samples, options).parameters)


class Clock:
    """Stands still but when it is told."""

    def __init__(self) -> None:
        self.now = 0.0

    def perf_counter(self) -> float:
        return self.now

    def a_step(self, rates, loss):
        """Takes a hundredth of a second, for :class:`Watched`."""
        self.now += 0.01
        return loss


@pytest.fixture
def clock(monkeypatch):
    """That of trainings, under which none depends on how busy the machine is."""
    made = Clock()
    monkeypatch.setattr(course, "time", made)
    return made


def test_time_spent_before_an_interruption_counts(run, samples, tmp_path, clock):
    options = TrainOptions(steps=None, time_s=0.395, batch_size=64)
    surroundings = {"checkpoint": tmp_path / "stopped.npz", "backend": Watched(clock.a_step)}
    taken = []
    stopped = run(samples, options, stop=lambda: len(taken) >= 25 or taken.append(1), **surroundings)[-1]
    clock.now += 100.0
    resumed = run(samples, options, resume=True, **surroundings)
    first, last = next(event for event in resumed if isinstance(event, Stepped)), resumed[-1]
    assert stopped.spent_s == pytest.approx(0.25)
    assert first.spent_s == pytest.approx(0.26)
    assert (first.step, last.step, last.why) == (26, 40, "time")


def test_stopping_is_no_validation(run, samples, tmp_path):
    options = replace(OPTIONS, early_stop=1)
    path, taken = tmp_path / "stopped.npz", []
    events = run(samples, options, checkpoint=path, stop=lambda: len(taken) >= 17 or taken.append(1))
    judged = [event for event in events if isinstance(event, Validated)]
    assert [event.step for event in judged] == [10]
    course = load_checkpoint(path).course
    assert (course.best_relmse, course.n_worse) == (judged[0].figures.relmse, 0)


def test_a_time_budget_brings_the_rates_to_their_end(run, samples, clock):
    seen: list[Rates] = []
    backend = Watched(lambda rates, loss: (seen.append(rates), clock.a_step(rates, loss))[1])
    options = TrainOptions(steps=None, time_s=1.995, batch_size=64, lr_final=0.01)
    events = run(samples, options, backend=backend)
    assert (events[-1].why, events[-1].step) == ("time", 200)
    assert seen[-1].network == pytest.approx(0.01 * seen[1].network, rel=0.05)
    assert sum(isinstance(event, Validated) for event in events) == 20


class Watched(NumpyBackend):
    """Passes each step's rates and loss through a function that may change the loss.

    The first step of all is the one that warms kernels up.
    """

    def __init__(self, change) -> None:
        self.change = change

    def stepper(self, spec, state, options):
        return WatchedStepper(super().stepper(spec, state, options), self)


class WatchedStepper(Stepper):
    def __init__(self, inner, backend) -> None:
        self.inner, self.backend = inner, backend

    def step(self, batch, rates):
        loss = self.inner.step(batch, rates)
        return self.backend.change(rates, loss)

    def state(self):
        return self.inner.state()


class FailsAt:
    """Gives NaN at some of the calls."""

    def __init__(self, *calls: int) -> None:
        self.calls, self.n, self.rates = calls, -1, []  # not counting the warm-up

    def __call__(self, rates, loss):
        self.n += 1
        self.rates.append(rates)
        return float("nan") if self.n in self.calls else loss


def test_a_loss_that_is_no_number_steps_back_and_halves_the_rates(run, samples):
    fault = FailsAt(25)
    events = run(samples, replace(OPTIONS, lr_final=1.0), backend=Watched(fault))
    back = [event for event in events if isinstance(event, SteppedBack)]
    assert back == [SteppedBack(step=25, to_step=20, rate_factor=0.5)]
    assert fault.rates[25].network == 0.01
    assert fault.rates[26].network == 0.005
    assert (events[-1].why, events[-1].step, events[-1].n_setbacks) == ("steps", 40, 1)
    assert all(np.isfinite(values).all() for values in events[-1].parameters.values())


def test_a_setback_goes_back_to_the_last_validation_however_often_one_saves(run, samples, tmp_path):
    options = replace(OPTIONS, checkpoint_s=1e-9)
    events = run(samples, options, backend=Watched(FailsAt(25)), checkpoint=tmp_path / "c.npz")
    assert [event.to_step for event in events if isinstance(event, SteppedBack)] == [20]


def test_after_a_setback_other_batches_are_drawn(run, samples):
    drawn = []

    class Drawing(Watched):
        def stepper(self, spec, state, options):
            inner = super().stepper(spec, state, options)
            step = inner.step
            inner.step = lambda batch, rates: (drawn.append(batch.x.copy()), step(batch, rates))[1]
            return inner

    run(samples, OPTIONS, backend=Drawing(FailsAt(5)))
    assert not np.array_equal(drawn[1], drawn[6])  # step 1, before and after


def test_after_three_setbacks_training_gives_up(run, samples):
    with pytest.raises(InputError, match="no number") as raised:
        run(samples, OPTIONS, backend=Watched(lambda rates, loss: loss if rates.network == 0 else np.nan))
    assert "--lr-network" in str(raised.value)


def test_a_parameter_that_is_no_number_is_found_before_it_is_saved(run, samples, tmp_path):
    class Spoilt(Watched):
        spoilt = False

        def stepper(self, spec, state, options):
            inner = super().stepper(spec, state, options)
            inner.state = lambda: self.spoil(inner.inner.state())
            return inner

        def spoil(self, state):
            if state.step == 20 and not self.spoilt:
                self.spoilt = True
                state.second["mlp.0.weight"][0, 0] = np.nan
            return state

    events = run(samples, OPTIONS, backend=Spoilt(lambda rates, loss: loss), checkpoint=tmp_path / "c.npz")
    assert [e.to_step for e in events if isinstance(e, SteppedBack)] == [10]
    assert events[-1].step == 40


def test_training_ends_when_validation_stops_improving(finished, samples):
    still = replace(OPTIONS, steps=1000, lr_encoding=0.0, lr_network=0.0, early_stop=3)
    last = finished(samples, still)
    assert (last.why, last.step) == ("early stop", 40)  # the first is the best, three more are not


class Scripted(NumpyBackend):
    """Answers with the constants of a list, one for each evaluator after that of the warm-up."""

    def __init__(self, *constants: float) -> None:
        self.constants = iter((1.0, *constants))
        self.parameters = []

    def evaluator(self, spec, parameters):
        self.parameters.append(parameters)
        constant = np.float32(next(self.constants))
        return lambda x, normal: np.full((len(x), spec.n_outputs), constant)


def test_early_stop_keeps_the_best_parameters(finished, samples):
    backend = Scripted(5.0, 1.0, 2.0, 3.0, 4.0, 1.0)
    last = finished(samples, replace(OPTIONS, steps=1000, early_stop=3), backend=backend)
    assert (last.why, last.step) == ("early stop", 50)
    assert same(last.parameters, backend.parameters[2])


def test_hardly_better_is_not_better(finished, samples):
    backend = Scripted(5.0, *(5.0 - 1e-5 * i for i in range(1, 9)))
    last = finished(samples, replace(OPTIONS, steps=1000, early_stop=3), backend=backend)
    assert last.step == 40


def test_held_out_blocks_are_judged_apart(finished, samples):
    options = replace(OPTIONS, data=DataOptions(hold_out_blocks=0.3))
    last = finished(samples, options)
    assert last.held_out is not None
    n_held = last.held_out.n_samples + last.figures.n_samples
    assert last.n_samples + n_held == len(samples)
    assert 0.2 < last.held_out.n_samples / len(samples) < 0.4


def test_validation_samples_of_their_own_leave_all_rows_to_training(run, samples, make):
    events = run(samples, OPTIONS, validation=make(100, seed=5))
    assert events[-1].n_samples == len(samples)
    assert events[-1].figures.n_samples == 100
    assert not any(isinstance(event, Remark) for event in events)


def test_validation_samples_of_another_kind_are_refused(run, samples, make):
    with pytest.raises(InputError, match="n_coefficients"):
        run(samples, OPTIONS, validation=make(100, kind="sh", n_coefficients=4))


def test_sh_coefficients_train(finished, make):
    field = FieldSpec(Frequency(2), None, 8, 1, head="linear", mode="sh1")
    samples = make(kind="sh", n_coefficients=4)
    short, long = (finished(samples, replace(OPTIONS, steps=n), spec=field).figures for n in (10, 400))
    assert long.mae < 0.5 * short.mae
    assert long.psnr_db > short.psnr_db + 5.0
    with pytest.raises(InputError, match="expected samples of 12"):
        finished(make(), OPTIONS, spec=field)


def test_frozen_parameters_stay(finished, samples, spec):
    field = replace(spec, position=HashGrid(2, 6, 2, 4, 8))
    start = finished(samples, OPTIONS, spec=field).parameters
    again = finished(samples, replace(OPTIONS, frozen=frozenset({"position"})), spec=field, start=start)
    assert np.array_equal(again.parameters["position"], start["position"])
    assert not np.array_equal(again.parameters["mlp.0.weight"], start["mlp.0.weight"])


def test_training_starts_as_bright_as_the_samples(finished, make):
    lit_by_a_lamp = make()
    lit_by_a_lamp.rows[:, 6:9] = (0.1, 0.2, 0.3)
    lit_by_a_lamp.rows[::97, 6:9] = 16.0  # so the mean is not what is typical
    last = finished(lit_by_a_lamp, TrainOptions(steps=1, batch_size=64, lr_network=0.0), validation=make(5))
    assert np.allclose(np.exp(last.parameters["mlp.1.bias"]) * last.frame.scale, (0.1, 0.2, 0.3), rtol=1e-4)


def test_parameters_for_inference_are_the_running_mean_without_its_bias(run, samples):
    states = []

    class Kept(Watched):
        def stepper(self, spec, state, options):
            inner = super().stepper(spec, state, options)
            step = inner.step
            inner.step = lambda batch, rates: (step(batch, rates), states.append(inner.inner.state()))[0]
            return inner

    last = run(samples, replace(OPTIONS, steps=5, average=0.5), backend=Kept(lambda rates, loss: loss))[-1]
    weights = 0.5 ** np.arange(5)[::-1]
    values = [state.parameters["mlp.0.weight"] for state in states[1:]]
    expected = np.tensordot(weights / weights.sum(), values, axes=1)
    assert np.allclose(last.parameters["mlp.0.weight"], expected, rtol=1e-5)


def test_finished_comes_last_and_once(run, samples):
    events = run(samples, OPTIONS)
    assert [isinstance(event, Finished) for event in events].index(True) == len(events) - 1


@pytest.mark.parametrize("threads", [1, 2])
def test_with_numba_too_resuming_gives_the_bytes_of_never_having_stopped(
    finished, samples, spec, tmp_path, threads
):
    """And on one thread those of two."""
    field = replace(spec, position=HashGrid(2, 6, 2, 4, 8), width=16)
    whole = finished(samples, OPTIONS, spec=field, backend=find_backend("numba", field, 2))
    backend = find_backend("numba", field, threads)
    path, taken = tmp_path / "stopped.npz", []
    finished(
        *(samples, OPTIONS),
        spec=field,
        backend=backend,
        checkpoint=path,
        stop=lambda: len(taken) >= 17 or taken.append(1),
    )
    resumed = finished(samples, OPTIONS, spec=field, backend=backend, checkpoint=path, resume=True)
    assert same(resumed.parameters, whole.parameters)
