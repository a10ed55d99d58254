"""Vectors in kernels against the same arithmetic in NumPy, and the functions made of them."""

from __future__ import annotations

import importlib.util
import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.field.backends import numba_compile
from irradia.field.backends.numba_compile import inner, kernel, take
from irradia.field.backends.numba_math import exp8, log8, sin_cos8
from irradia.field.backends.numba_team import Team
from irradia.field.backends.numba_vector import (
    absolute,
    bits8,
    floor,
    fma,
    join2,
    lane,
    load2,
    load8,
    load_uint8,
    nearest,
    of_bits8,
    real8,
    select,
    splat8,
    square_root,
    store2,
    store8,
    store_uint8,
    sums8,
    whole8,
)

A = np.array([-2.5, -1.0, -0.0, 0.5, 1.5, 2.5, np.inf, np.nan], np.float32)
B = np.array([2.0, -4.0, 3.0, 0.5, 1.5, -1.0, 1.0, 1.0], np.float32)
WHOLE = np.array([0, 1, 7, 255, 65536, 2147483647, 3, 4], np.uint32)

KERNEL = """
from irradia.field.backends.numba_compile import inner

@inner
def twice(x):
    return 2.0 * x
"""


@inner
def _floats(a, b, out):
    x, y = load8(a, 0), load8(b, (0, 0))
    store8(out, (0, 0), x + y * 2.0)
    store8(out, (1, 0), (1.0 - x) / y)
    store8(out, (2, 0), select(x > y, x, y))
    store8(out, (3, 0), select(x <= 0.5, 7.0, splat8(8.0)))
    store8(out, (4, 0), square_root(absolute(x)))
    store8(out, (5, 0), floor(x))
    store8(out, (6, 0), nearest(x))
    store8(out, (7, 0), fma(x, y, splat8(1.0)))
    store8(out, (8, 0), of_bits8(bits8(x)))


def test_floats_are_computed_lane_by_lane():
    found = np.zeros((9, 8), np.float32)
    _floats(A, B[None], found)
    with np.errstate(invalid="ignore"):
        expected = [
            A + 2.0 * B,
            (1.0 - A) / B,
            np.where(A > B, A, B),
            np.where(A <= 0.5, 7.0, 8.0),
            np.sqrt(np.abs(A)),
            np.floor(A),
            np.rint(A),
            A * B + 1.0,
            A,
        ]
    np.testing.assert_allclose(found, np.array(expected, np.float32), rtol=1e-7)


@inner
def _integers(a, out):
    x = load_uint8(a, 0)
    store_uint8(out, (0, 0), (x * 2654435761) ^ (x + 1))
    store_uint8(out, (1, 0), (x << 3) & 0xFF)
    store_uint8(out, (2, 0), (x - 8) >> 28)
    store_uint8(out, (3, 0), select(x >= 4, x, x * 0))
    store_uint8(out, (4, 0), whole8(real8(x & 0xFFFF)))


def test_unsigned_integers_wrap_around():
    found = np.zeros((5, 8), np.uint32)
    _integers(WHOLE, found)
    expected = [
        (WHOLE * np.uint32(2654435761)) ^ (WHOLE + np.uint32(1)),
        (WHOLE << 3) & 0xFF,
        (WHOLE - np.uint32(8)) >> 28,
        np.where(WHOLE >= 4, WHOLE, 0),
        WHOLE & 0xFFFF,
    ]
    np.testing.assert_array_equal(found, np.array(expected))


@inner
def _sums(rows, out):
    a, b, c, d = load8(rows, (0, 0)), load8(rows, (1, 0)), load8(rows, (2, 0)), load8(rows, (3, 0))
    e, f, g, h = load8(rows, (4, 0)), load8(rows, (5, 0)), load8(rows, (6, 0)), load8(rows, (7, 0))
    store8(out, 0, sums8(a, b, c, d, e, f, g, h))
    store2(out, 8, load2(out, 0) + join2(lane(a, 7), lane(h, 0)))


def test_eight_sums_come_in_order():
    rows = np.random.default_rng(1).integers(-99, 99, (8, 8)).astype(np.float32)
    found = np.zeros(10, np.float32)
    _sums(rows, found)
    np.testing.assert_array_equal(found[:8], rows.sum(axis=1))
    np.testing.assert_array_equal(found[8:], found[:2] + rows[[0, 7], [7, 0]])


@inner
def _functions(x, out):
    for i in range(0, len(x), 8):
        value = load8(x, i)
        store8(out, (0, i), exp8(value))
        store8(out, (1, i), log8(absolute(value) + 1e-30))
        sine, cosine = sin_cos8(value)
        store8(out, (2, i), sine)
        store8(out, (3, i), cosine)


def _computed(x: np.ndarray) -> np.ndarray:
    found = np.zeros((4, len(x)), np.float32)
    _functions(x.astype(np.float32), found)
    return found


def test_functions_are_right_to_a_few_roundings():
    x = np.random.default_rng(2).uniform(-87.0, 87.0, 4096).astype(np.float32)
    x[:16] = np.linspace(-1e-3, 1e-3, 16)
    exponential, logarithm, sine, cosine = _computed(x)
    exact = x.astype(np.float64)
    np.testing.assert_allclose(exponential, np.exp(exact), rtol=2e-7)
    np.testing.assert_allclose(logarithm, np.log(np.abs(exact) + 1e-30), rtol=2e-7, atol=1e-7)
    np.testing.assert_allclose(sine, np.sin(exact), atol=1.5e-7)
    np.testing.assert_allclose(cosine, np.cos(exact), atol=1.5e-7)


def test_functions_keep_what_is_no_number_and_bound_the_exponential():
    found = _computed(np.array([np.nan, 1000.0, -1000.0, 88.0, 0.0, 1.0, 1.0, 1.0]))
    assert np.isnan(found[:, 0]).all()
    assert found[0, 1] == found[0, 3] == pytest.approx(math.exp(87.0), rel=1e-6)
    assert found[0, 2] == pytest.approx(math.exp(-87.0), rel=1e-6)
    assert found[0, 4] == 1.0


@kernel
def _note_tasks(thread, next_task, n_tasks, done, by):
    while True:
        task = take(next_task)
        if task >= n_tasks:
            break
        done[task] += 1
        by[task] = thread


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_a_team_does_every_task_once(threads):
    team = Team(threads)
    for _ in range(20):
        done, by = np.zeros(1000, np.int64), np.zeros(1000, np.int64)
        team.run(_note_tasks, len(done), done, by)
        assert (done == 1).all()
        assert (by < threads).all()


def test_callers_of_a_team_wait_for_each_other():
    team = Team(2)
    counts = [np.zeros(5000, np.int64) for _ in range(4)]
    with ThreadPoolExecutor(4) as callers:
        for done in [callers.submit(team.run, _note_tasks, len(c), c, np.zeros_like(c)) for c in counts * 10]:
            done.result()
    assert all((count == 10).all() for count in counts)


def test_a_team_needs_a_thread():
    with pytest.raises(InputError, match="at least 1 thread, found 0"):
        Team(0)


def test_kept_code_is_stale_when_any_kernels_file_has_changed(tmp_path, monkeypatch):
    file = tmp_path / "twice.py"
    file.write_text(KERNEL)

    def taken_from_disk() -> int:
        spec = importlib.util.spec_from_file_location("twice", file)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        assert module.twice(1.5) == 3.0
        return sum(module.twice.stats.cache_hits.values())

    assert [taken_from_disk(), taken_from_disk()] == [0, 1]
    monkeypatch.setattr(numba_compile, "_STAMP", b"of other files")
    assert [taken_from_disk(), taken_from_disk()] == [0, 1]
