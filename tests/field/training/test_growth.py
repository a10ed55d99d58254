"""Training while samples still come."""

from __future__ import annotations

import pytest

from irradia.core.errors import InputError
from irradia.field.training import (
    DataOptions,
    Finished,
    Remark,
    Stepped,
    TrainContext,
    TrainOptions,
    Working,
    growth,
    train,
)
from irradia.formats.samples import SampleWriter, open_samples


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    monkeypatch.setattr(growth, "LOOK_EVERY_S", 0.0)
    monkeypatch.setattr(growth, "_WAIT_S", 0.0)


@pytest.fixture
def writer(tmp_path, samples):
    with SampleWriter(tmp_path / "box.samples", samples.info) as open_writer:
        yield open_writer


def test_rows_that_come_later_are_trained_on(writer, samples, spec, tmp_path):
    writer.append(samples.rows[:200])
    options = TrainOptions(steps=60, batch_size=64, validate_every=60)
    told = []
    context = TrainContext(backend="numpy")
    for event in train(open_samples(tmp_path / "box.samples"), spec, options, context):
        told.append(event)
        if isinstance(event, Stepped) and event.step == 20:
            writer.append(samples.rows[200:400])
        if isinstance(event, Stepped) and event.step == 40:
            writer.append(samples.rows[400:])
            writer.close()
    remarks = [event.text for event in told if isinstance(event, Remark)]
    assert "Training from 400 samples, so far." in remarks
    assert "Training from 600 samples, all there are." in remarks
    assert isinstance(told[-1], Finished)
    assert told[-1].n_samples > 550


def test_more_rows_than_memory_holds_with_smoothing_end_no_training(writer, samples, spec, tmp_path):
    writer.append(samples.rows[:200])
    row_bytes = 4 * samples.info.n_columns
    options = TrainOptions(
        steps=40, batch_size=64, validate_every=40, data=DataOptions(smooth_k=4, memory_bytes=350 * row_bytes)
    )
    told = []
    for event in train(open_samples(tmp_path / "box.samples"), spec, options, TrainContext(backend="numpy")):
        told.append(event)
        if isinstance(event, Stepped) and event.step == 10:
            writer.append(samples.rows[200:])
    remarks = [event.text for event in told if isinstance(event, Remark) and "Training from" in event.text]
    assert len(remarks) == 1
    assert "Training from 350 samples, as many as --memory holds" in remarks[0]
    assert isinstance(told[-1], Finished)
    assert 300 < told[-1].n_samples <= 350


def test_a_few_more_rows_are_not_worth_reading_again(writer, samples, spec, tmp_path):
    writer.append(samples.rows[:400])
    told = []
    context = TrainContext(backend="numpy")
    options = TrainOptions(steps=20, batch_size=64)
    for event in train(open_samples(tmp_path / "box.samples"), spec, options, context):
        told.append(event)
        if isinstance(event, Stepped) and event.step == 5:
            writer.append(samples.rows[400:450])
    assert not any(isinstance(event, Remark) and "Training from" in event.text for event in told)


def test_training_waits_for_the_first_batch(writer, samples, spec, tmp_path):
    writer.append(samples.rows[:10])
    waited = []
    options = TrainOptions(steps=5, batch_size=256)
    for event in train(open_samples(tmp_path / "box.samples"), spec, options, TrainContext(backend="numpy")):
        if isinstance(event, Working) and event.stage == "Wait for samples":
            waited.append(event.done)
            writer.append(samples.rows[10 + 100 * len(waited) : 110 + 100 * len(waited)])
    assert waited == [10.0, 110.0, 210.0]


def test_rows_that_come_while_one_asks_for_the_writer_count(writer, samples, finished, tmp_path, monkeypatch):
    writer.append(samples.rows[:10])

    def ends(_):
        writer.append(samples.rows[10:])
        writer.close()
        return False

    monkeypatch.setattr(growth, "grows", ends)
    last = finished(open_samples(tmp_path / "box.samples"), TrainOptions(steps=5, batch_size=256))
    assert last.n_samples > 550


def test_training_goes_on_with_what_it_has_when_its_samples_are_replaced(samples, spec, tmp_path):
    path, told = tmp_path / "box.samples", []
    writer = SampleWriter(path, samples.info)
    writer.append(samples.rows[:200])
    options = TrainOptions(steps=20, batch_size=64)
    for event in train(open_samples(path), spec, options, TrainContext(backend="numpy")):
        told.append(event)
        if isinstance(event, Stepped) and event.step == 5:
            writer.abandon()
            writer = SampleWriter(path, samples.info)  # begins anew
            writer.append(samples.rows[:9])
    writer.abandon()
    assert isinstance(told[-1], Finished)
    assert told[-1].step == 20
    remarks = [event.text for event in told if isinstance(event, Remark)]
    assert sum("taken the place" in text for text in remarks) == 1


def test_a_dataset_that_was_given_up_is_trained_on_as_it_is(samples, finished, tmp_path):
    writer = SampleWriter(tmp_path / "box.samples", samples.info)
    writer.append(samples.rows[:200])
    writer.abandon()
    last = finished(open_samples(tmp_path / "box.samples"), TrainOptions(steps=5, batch_size=1024))
    assert last.n_samples > 190


def test_a_dataset_that_was_given_up_before_its_first_row_is_refused(samples, finished, tmp_path):
    SampleWriter(tmp_path / "box.samples", samples.info).abandon()
    with pytest.raises(InputError, match="found none"):
        finished(open_samples(tmp_path / "box.samples"), TrainOptions(steps=5))
