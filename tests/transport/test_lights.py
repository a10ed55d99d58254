"""Light sources: what is sampled, how often, and with which density."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from irradia.scene.types import Environment

pytestmark = pytest.mark.usefixtures("cpu_device")

_N = 1 << 18


def _random(n=_N, seed=5):
    from irradia.transport.backend import dr, mi
    from irradia.transport.sampling import Sampler

    return Sampler(dr.arange(mi.UInt32, n), mi.UInt32(seed)).next_2d()


def _patchy_sky() -> Environment:
    rng = np.random.default_rng(2)
    radiance = rng.uniform(0.0, 1.0, (8, 16, 3)).astype(np.float32) ** 4
    radiance[2, 5] = 40.0
    radiance[6] = 0.0
    return Environment(radiance)


def test_alias_table_picks_in_proportion():
    from irradia.transport.alias import AliasTable
    from irradia.transport.backend import mi

    weights = np.array([0.0, 1.0, 5.0, 0.5, 0.0, 20.0, 3.0])
    index, rest = AliasTable(weights).sample(_random().x, mi.Bool(True))
    counts = np.bincount(np.array(index), minlength=len(weights))
    expected = weights / weights.sum() * _N
    assert counts[expected == 0].sum() == 0
    some = expected > 0
    statistic = ((counts - expected)[some] ** 2 / expected[some]).sum()
    assert stats.chi2.sf(statistic, some.sum() - 1) > 1e-4
    assert stats.kstest(np.array(rest)[::97], "uniform").pvalue > 1e-4


def test_environment_density_integrates_to_one():
    from irradia.transport.backend import mi
    from irradia.transport.environment_light import EnvironmentLight

    light = EnvironmentLight(_patchy_sky())
    u = np.array(_random())
    cosine, phi = 1 - 2 * u[0], 2 * np.pi * u[1]
    sine = np.sqrt(1 - cosine**2)
    directions = mi.Vector3f(sine * np.sin(phi), cosine, -sine * np.cos(phi))
    _, pdf = light.lookup(directions, mi.Bool(True))
    assert np.array(pdf).mean() * 4 * np.pi == pytest.approx(1.0, rel=5e-3)


def test_environment_samples_agree_with_lookups_and_estimate_the_power():
    from irradia.transport.backend import mi
    from irradia.transport.environment_light import EnvironmentLight

    sky = _patchy_sky()
    light = EnvironmentLight(sky)
    direction, radiance, pdf = light.sample(_random(), mi.Bool(True))
    seen, seen_pdf = light.lookup(direction, mi.Bool(True))
    same = np.isclose(np.array(seen_pdf), np.array(pdf), rtol=1e-4)
    assert same.mean() > 0.999  # directions on a pixel's border may round to its neighbour
    estimate = (np.array(radiance) / np.array(pdf)).mean(axis=1)
    edges = np.cos(np.linspace(0, np.pi, 9))
    solid_angle = (edges[:-1] - edges[1:]) * 2 * np.pi / 16
    exact = (sky.radiance * solid_angle[:, None, None]).sum(axis=(0, 1))
    np.testing.assert_allclose(estimate, exact, rtol=5e-3)
    assert np.allclose(np.array(seen)[:, same], np.array(radiance)[:, same], rtol=1e-4)


@pytest.mark.parametrize(
    ("direction", "pixel"),
    [
        ((0.2, -0.2, -1.0), (4, 8)),
        ((1.0, -0.2, 0.2), (4, 12)),
        ((-1.0, -0.2, -0.2), (4, 4)),
        ((0.2, 1.0, -0.02), (0, 11)),
    ],
)
def test_environment_is_centred_on_minus_z_and_grows_towards_plus_x(direction, pixel):
    from irradia.transport.backend import mi
    from irradia.transport.environment_light import EnvironmentLight

    radiance = np.zeros((8, 16, 3), np.float32)
    radiance[pixel] = 1.0
    unit = np.array(direction) / np.linalg.norm(direction)
    seen, _ = EnvironmentLight(Environment(radiance)).lookup(mi.Vector3f(*unit.tolist()), mi.Bool(True))
    assert np.array(seen).ravel()[0] == 1.0


def test_even_sky_is_left_to_rays_and_a_peaked_one_is_sampled():
    from irradia.transport.environment_light import EnvironmentLight

    assert not EnvironmentLight(Environment(np.ones((8, 16, 3), np.float32))).sampled
    assert EnvironmentLight(_patchy_sky()).sampled
