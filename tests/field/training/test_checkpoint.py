"""Checkpoints, the log and its curves."""

from __future__ import annotations

import struct
import zipfile
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.field.backend import TrainState
from irradia.field.backends import backend as find_backend
from irradia.field.encodings import Frequency, Identity
from irradia.field.spec import FieldSpec
from irradia.field.training import Figures, Stepped, SteppedBack, TrainOptions, Validated
from irradia.field.training.checkpoint import (
    Checkpoint,
    Course,
    check_same,
    load_checkpoint,
    read_step,
    save_checkpoint,
)
from irradia.field.training.curves import write_curves
from irradia.field.training.log import COLUMNS, LogRow, TrainingLog, read_log, write_log

SPEC = FieldSpec(Frequency(2), Identity(), width=8, n_hidden_layers=1)
FIGURES = Figures(10, 30.5, 0.01, 1.02, 0.3, None, under_noise=False)


@pytest.fixture
def checkpoint():
    rng = np.random.default_rng(0)
    groups = [
        {name: rng.random((3, 2)).astype(np.float32) for name in ("position", "mlp.0.weight")}
        for _ in range(5)
    ]
    state = TrainState(*groups[:4], step=123)
    course = Course(4.5, 0.25, 2, 0.001, 1, (0.1, 0.2))
    return Checkpoint(state, course, groups[4], {"spec": {"width": 64}, "data": {"rows": 9}}, 8.0)


def test_a_checkpoint_comes_back_as_it_was(checkpoint, tmp_path):
    save_checkpoint(tmp_path / "c.npz", checkpoint)
    found = load_checkpoint(tmp_path / "c.npz")
    assert (found.course, found.identity, found.scale) == (
        checkpoint.course,
        checkpoint.identity,
        checkpoint.scale,
    )
    assert found.state.step == read_step(tmp_path / "c.npz") == 123
    for group in ("parameters", "average", "first", "second"):
        here, there = getattr(checkpoint.state, group), getattr(found.state, group)
        assert all(np.array_equal(here[name], there[name]) for name in here | there)
    assert np.array_equal(found.best["position"], checkpoint.best["position"])


@pytest.mark.parametrize("keep", [0, 10, 300, -1, -30])
def test_a_checkpoint_cut_short_is_refused(checkpoint, tmp_path, keep):
    path = tmp_path / "c.npz"
    save_checkpoint(path, checkpoint)
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(InputError, match="damaged"):
        load_checkpoint(path)


def test_a_flipped_bit_is_found(checkpoint, tmp_path):
    path = tmp_path / "c.npz"
    save_checkpoint(path, checkpoint)
    data = bytearray(path.read_bytes())
    at = bytes(data).index(checkpoint.state.first["position"].tobytes())
    data[at] ^= 1
    path.write_bytes(data)
    with pytest.raises(InputError, match="damaged"):
        load_checkpoint(path)


@pytest.mark.parametrize("content", [b"text", b"PK\x03\x04 no archive"])
def test_other_files_are_refused(tmp_path, content):
    (tmp_path / "c.npz").write_bytes(content)
    with pytest.raises(InputError, match="damaged"):
        load_checkpoint(tmp_path / "c.npz")


def spoil_packing(path):
    """Deflated, with nonsense where the first bytes were."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("header.npy", bytes(9999))
    data = bytearray(path.read_bytes())
    data[40:50] = b"\xff" * 10
    path.write_bytes(data)


def ask_for_all_memory(path):
    with zipfile.ZipFile(path, "w") as archive:
        text = "{'descr': '<f4', 'fortran_order': False, 'shape': (1152921504606846, ), }"
        archive.writestr("header.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode())


def pack_in_an_unknown_way(path):
    data = bytearray(path.read_bytes())
    at = data.index(b"PK\x01\x02")
    while at >= 0:
        data[at + 10 : at + 12] = struct.pack("<H", 99)
        at = data.find(b"PK\x01\x02", at + 1)
    path.write_bytes(data)


@pytest.mark.parametrize("damage", [spoil_packing, ask_for_all_memory, pack_in_an_unknown_way])
def test_whatever_reading_nonsense_raises_is_damage(checkpoint, tmp_path, damage):
    path = tmp_path / "c.npz"
    save_checkpoint(path, checkpoint)
    damage(path)
    with pytest.raises(InputError, match="damaged"):
        load_checkpoint(path)


@pytest.mark.parametrize("group", ["parameters", "average", "first", "second", "best"])
def test_arrays_of_other_shapes_are_damage(finished, samples, tmp_path, group):
    options, path = TrainOptions(steps=20, batch_size=64, validate_every=4, early_stop=9), tmp_path / "c.npz"
    taken = []
    finished(samples, options, checkpoint=path, stop=lambda: len(taken) >= 5 or taken.append(1))
    found = load_checkpoint(path)
    arrays = found.best if group == "best" else getattr(found.state, group)
    arrays["mlp.0.weight"] = arrays["mlp.0.weight"][:-1]
    save_checkpoint(path, found)
    with pytest.raises(InputError, match=r"damaged: mlp\.0\.weight: expected shape"):
        finished(samples, options, checkpoint=path, resume=True)


def test_without_a_checkpoint_nothing_can_be_resumed(tmp_path):
    with pytest.raises(InputError, match="no stopped training"):
        load_checkpoint(tmp_path / "none.npz")


def test_another_training_is_not_gone_on_with(checkpoint):
    check_same(checkpoint, checkpoint.identity, "c.npz")
    with pytest.raises(InputError, match=r"another spec\.width: 64, now 32"):
        check_same(checkpoint, {"spec": {"width": 32}, "data": {"rows": 9}}, "c.npz")
    with pytest.raises(InputError, match=r"data\.rows"):
        check_same(checkpoint, {"spec": {"width": 64}, "data": {"rows": 10}}, "c.npz")


def test_what_grew_since_is_welcome(checkpoint):
    grew = replace(checkpoint, identity={"data": {"rows": None, "sha256": None, "kind": "sh"}})
    check_same(grew, {"data": {"rows": 99, "sha256": "ab", "kind": "sh"}}, "c.npz")
    with pytest.raises(InputError, match=r"data\.kind"):
        check_same(grew, {"data": {"rows": 99, "sha256": "ab", "kind": "volume"}}, "c.npz")


@pytest.mark.parametrize("other", [{"seed": 1}, {"lr_final": 0.5}, {"batch_size": 65}])
def test_a_training_with_other_options_does_not_go_on(finished, samples, tmp_path, other):
    options = TrainOptions(steps=20, batch_size=64)
    taken = []
    stop = lambda: len(taken) >= 5 or taken.append(1)  # noqa: E731
    finished(samples, options, checkpoint=tmp_path / "c.npz", stop=stop)
    with pytest.raises(InputError, match=f"another options.{next(iter(other))}"):
        finished(samples, replace(options, **other), checkpoint=tmp_path / "c.npz", resume=True)


@pytest.mark.parametrize("what", ["backend", "scene", "validation"])
def test_a_training_in_other_surroundings_does_not_go_on(finished, samples, make, tmp_path, what):
    other = {"backend": find_backend("numba", SPEC), "scene": "other.glb", "validation": make(50)}[what]
    options, taken = TrainOptions(steps=20, batch_size=64), []
    stop = lambda: len(taken) >= 5 or taken.append(1)  # noqa: E731
    finished(samples, options, checkpoint=tmp_path / "c.npz", stop=stop)
    with pytest.raises(InputError, match=f"another {what}"):
        finished(samples, options, checkpoint=tmp_path / "c.npz", resume=True, **{what: other})


def test_a_training_on_other_samples_does_not_go_on(finished, samples, make, tmp_path):
    options = TrainOptions(steps=20, batch_size=64)
    taken = []
    finished(samples, options, checkpoint=tmp_path / "c.npz", stop=lambda: len(taken) >= 5 or taken.append(1))
    with pytest.raises(InputError, match=r"another data\.sha256"):
        finished(make(seed=9), options, checkpoint=tmp_path / "c.npz", resume=True)


def stepped(step, loss):
    return Stepped(step, loss, step / 1000, step / 10, step * 64, 1e6)


def test_a_log_has_a_row_for_every_two_hundredth_and_every_validation():
    log = TrainingLog()
    for step in range(1, 1001):
        log.take(stepped(step, 1.0 / step))
        if step % 100 == 0:
            log.take(Validated(step, FIGURES))
    assert len(log.rows) == pytest.approx(200, abs=12)
    judged = [row for row in log.rows if row.psnr_db is not None]
    assert [row.step for row in judged] == list(range(100, 1001, 100))
    assert len({row.step for row in log.rows}) == len(log.rows)
    third = log.rows[2]
    assert third.loss == pytest.approx(
        np.mean([1.0 / s for s in range(log.rows[1].step + 1, third.step + 1)])
    )


def test_a_setback_takes_rows_back():
    log = TrainingLog()
    for step in range(1, 101):
        log.take(stepped(step, 1.0))
    log.take(SteppedBack(100, 50, 0.5))
    assert log.rows[-1].step <= 50
    log.take(stepped(200, 1.0))
    assert log.rows[-1].rate_factor == 0.5


@pytest.mark.parametrize("to_step", [0, 50])
def test_a_validation_right_after_a_setback_changes_no_row(to_step):
    log = TrainingLog()
    for step in range(1, 101):
        log.take(stepped(step, 1.0))
    log.take(SteppedBack(100, to_step, 0.5))
    before = list(log.rows)
    log.take(Validated(to_step, FIGURES))
    assert log.rows == before


def test_a_log_comes_back_from_its_csv(tmp_path):
    rows = [LogRow(1, 0.1, 64, 0.5), LogRow(2, 0.25, 128, 0.25, 30.0, 0.01, 1.5, 0.125, 0.5)]
    write_log(tmp_path / "log.csv", rows)
    assert (tmp_path / "log.csv").read_text().splitlines()[0] == ",".join(COLUMNS)
    assert read_log(tmp_path / "log.csv", 9) == rows
    assert read_log(tmp_path / "log.csv", 1) == rows[:1]
    assert read_log(tmp_path / "none.csv", 9) == []


def test_another_table_is_no_log(tmp_path):
    (tmp_path / "log.csv").write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match="log of a training"):
        read_log(tmp_path / "log.csv", 9)


def test_curves_are_drawn_for_loss_and_psnr(tmp_path):
    rows = [LogRow(step, 0.1, 64, 1.0 / step, 20.0 + step) for step in range(1, 30)]
    write_curves(tmp_path / "c.svg", rows, "a < b")
    drawing = ET.fromstring((tmp_path / "c.svg").read_text())
    lines = drawing.findall("{http://www.w3.org/2000/svg}polyline")
    assert [len(line.attrib["points"].split()) for line in lines] == [29, 29]
    heights = [float(point.split(",")[1]) for point in lines[0].attrib["points"].split()]
    assert heights == sorted(heights)  # the loss falls


@pytest.mark.parametrize("rows", [[], [LogRow(1, 0.1, 64, 0.5)], [LogRow(1, 0.1, 64, float("nan"))]])
def test_curves_of_next_to_nothing_are_still_a_drawing(tmp_path, rows):
    write_curves(tmp_path / "c.svg", rows, "title")
    ET.fromstring((tmp_path / "c.svg").read_text())
