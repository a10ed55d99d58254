"""Scores of pictures, and what of them is the reference's noise."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.field.evaluation import score_picture

SHAPE = (48, 64, 3)


def _truth() -> np.ndarray:
    rows, columns = np.indices(SHAPE[:2])
    return np.repeat((0.4 + 0.3 * np.sin(rows / 7) * np.cos(columns / 9))[..., None], 3, 2).astype(np.float32)


def _halves(noise: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    first, second = (_truth() + rng.normal(0.0, noise, SHAPE).astype(np.float32) for _ in range(2))
    return first, second


def test_of_the_truth_only_noise_is_seen_and_the_flags_say_so():
    scores = score_picture(_truth(), *_halves(0.01))
    for name in ("relmse", "psnr_db", "p95"):
        figure = getattr(scores, name)
        assert figure.value == pytest.approx(figure.noise, rel=0.1), name
    # A half is a noisier reference than the mean, so that this errs a little towards too little noise.
    assert scores.flip.value == pytest.approx(scores.flip.noise, rel=0.3)
    assert scores.mean_ratio.is_noise
    assert abs(scores.relmse_noise_free) < 0.1 * scores.relmse.value


def test_a_real_error_stands_out_from_the_noise():
    scores = score_picture(1.2 * _truth(), *_halves(0.005))
    assert not any(figure.is_noise for figure in scores.figures.values())
    assert scores.mean_ratio.value == pytest.approx(1.2, rel=1e-3)
    assert scores.p95.value > 0.15


def test_an_error_smaller_than_the_noise_is_flagged():
    scores = score_picture(0.5 * sum(_halves(0.05)), *_halves(0.05))
    assert scores.flip.is_noise
    assert scores.relmse.is_noise
    assert scores.psnr_db.is_noise


def test_noise_of_the_ratio_is_the_standard_error_of_the_mean():
    scores = score_picture(_truth(), *_halves(0.05))
    n_values = _truth().size
    expected = 0.05 / np.sqrt(2 * n_values) / _truth().mean()
    assert scores.mean_ratio.noise == pytest.approx(expected, rel=0.05)


def test_the_backdrop_counts_for_nothing():
    scene = np.zeros(SHAPE[:2], bool)
    scene[:24] = True
    first, second = _halves(0.005)
    wrong_behind = np.where(scene[..., None], 1.2 * _truth(), 9.0).astype(np.float32)
    right_behind = np.where(scene[..., None], 1.2 * _truth(), 0.5 * (first + second)).astype(np.float32)
    scores = score_picture(right_behind, first, second, scene)
    other = score_picture(wrong_behind, first, second, scene)
    assert scores.figures == other.figures
    assert scores.relmse_noise_free == other.relmse_noise_free
    assert scores.mean_ratio.value == pytest.approx(1.2, rel=1e-3)
    assert scores.scene_share == 0.5
    assert (scores.error[~scene] == 0.0).all()
    assert scores.error[scene].mean(dtype=np.float64) == pytest.approx(scores.flip.value, rel=1e-6)
    half = score_picture(1.2 * _truth()[:24], first[:24], second[:24])
    assert scores.flip.value == pytest.approx(half.flip.value, rel=0.1)  # but for the edge


def test_the_whole_pictures_figure_stands_beside_and_flatters():
    scene = np.zeros(SHAPE[:2], bool)
    scene[:24] = True
    first, second = _halves(0.005)
    picture = np.where(scene[..., None], 1.2 * _truth(), 0.5 * (first + second)).astype(np.float32)
    scores = score_picture(picture, first, second, scene)
    assert scores.whole_flip < 0.6 * scores.flip.value
    assert scores.to_json()["whole_flip"] == scores.whole_flip
    everything = score_picture(picture, first, second)
    assert everything.whole_flip == everything.flip.value == pytest.approx(scores.whole_flip, rel=1e-6)


def test_the_error_map_has_the_mean_that_is_told():
    scores = score_picture(1.2 * _truth(), *_halves(0.005))
    assert scores.error.shape == SHAPE[:2]
    assert scores.error.mean(dtype=np.float64) == pytest.approx(scores.flip.value, rel=1e-6)
    assert scores.to_json()["flip"]["value"] == scores.flip.value
