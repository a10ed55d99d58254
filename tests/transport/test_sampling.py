"""Samplers have the densities that they claim (chi² at p > 1e-4) and stratify."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

pytestmark = pytest.mark.usefixtures("cpu_device")

_N = 1 << 18


def _uniform_pairs(n=_N, seed=3):
    from irradia.transport.backend import dr, mi
    from irradia.transport.sampling import Sampler

    sampler = Sampler(dr.arange(mi.UInt32, n), mi.UInt32(seed))
    return sampler.next_2d(), sampler.next_2d()


def _chi2_passes(observed, expected):
    statistic = ((observed - expected) ** 2 / expected).sum()
    return stats.chi2.sf(statistic, observed.size - 1) > 1e-4


@pytest.mark.parametrize("n", [16, 64, 256])
def test_samples_fill_every_elementary_interval(n):
    """A (0, m, 2)-net in base 2: each of the dyadic boxes of area 1/n holds one point."""
    first, second = _uniform_pairs(n)
    for pair in (first, second):
        u = np.array(pair)
        for columns in (2**k for k in range(n.bit_length())):
            rows = n // columns
            cells = np.floor(u[0] * columns).astype(int) * rows + np.floor(u[1] * rows).astype(int)
            assert (np.bincount(cells, minlength=n) == 1).all()


def test_pairs_of_dimensions_are_independent():
    first, second = (np.array(pair) for pair in _uniform_pairs())
    table = np.histogram2d(first[0], second[1], bins=16, range=[[0, 1], [0, 1]])[0]
    assert _chi2_passes(table, np.full(table.shape, _N / 256))


def test_hemisphere_has_the_density_of_the_cosine():
    from irradia.transport.sampling import cosine_hemisphere

    direction = np.array(cosine_hemisphere(_uniform_pairs()[0]))
    assert np.allclose(np.linalg.norm(direction, axis=0), 1.0, atol=1e-5)
    # cos² θ is uniform under this density, and φ as well.
    phi = np.arctan2(direction[1], direction[0]) / (2 * np.pi) + 0.5
    table = np.histogram2d(direction[2] ** 2, phi, bins=16, range=[[0, 1], [0, 1]])[0]
    assert _chi2_passes(table, np.full(table.shape, _N / 256))


def test_rotation_carries_z_to_the_normal():
    from irradia.transport.backend import mi
    from irradia.transport.sampling import to_world

    rng = np.random.default_rng(1)
    normal = rng.normal(size=(3, 1000))
    normal[:, :2] = [[0, 0], [0, 0], [1, -1]]
    normal /= np.linalg.norm(normal, axis=0)
    n = mi.Vector3f(*normal.astype(np.float32))
    np.testing.assert_allclose(np.array(to_world(n, mi.Vector3f(0, 0, 1))), normal, atol=1e-6)
    x, y = (np.array(to_world(n, mi.Vector3f(*v))) for v in ((1, 0, 0), (0, 1, 0)))
    np.testing.assert_allclose((x * y).sum(0), 0.0, atol=1e-6)
    np.testing.assert_allclose(np.cross(x, y, axis=0), normal, atol=1e-5)
