"""Moments of light against quadrature, and the density of the rays that gather them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.scene.tangents import RNM_BASIS

pytestmark = pytest.mark.usefixtures("cpu_device")

_N = 1 << 18
NORMAL = np.array([0.36, 0.48, 0.8])
TANGENT = np.array([0.8, -0.6, 0.0])
BITANGENT = np.cross(NORMAL, TANGENT)


def pairs(n=_N):
    from irradia.transport.backend import dr, mi
    from irradia.transport.sampling import Sampler

    return Sampler(dr.arange(mi.UInt32, n), mi.UInt32(11)).next_2d()


def frame():
    from irradia.transport.backend import mi
    from irradia.transport.frames import Frame

    return Frame(*(mi.Vector3f(*map(float, axis)) for axis in (TANGENT, BITANGENT, NORMAL)))


def radiance(directions):
    """A coloured, lopsided sky, (N, 3) for (N, 3) directions."""
    x, y, z = directions.T
    return np.stack([1.0 + 0.8 * x, 0.5 + np.maximum(y, 0.0) ** 2, 0.2 + (z > 0.7)], axis=1)


def quadrature():
    """Directions over the hemisphere about NORMAL, and the solid angle of each."""
    n = 400_000
    z = (np.arange(n) + 0.5) / n
    phi = np.arange(n) * np.pi * (3.0 - np.sqrt(5.0))
    s = np.sqrt(1.0 - z * z)
    local = np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=1)
    return local @ np.stack([TANGENT, BITANGENT, NORMAL]), 2.0 * np.pi / n


def expected(name):
    """(k, 3) by the definitions."""
    directions, solid_angle = quadrature()
    light = radiance(directions)
    if name == "rnm":
        axes = RNM_BASIS @ np.stack([TANGENT, BITANGENT, NORMAL])
        facing = np.maximum(directions @ axes.T, 0.0)
        return np.einsum("nk,nc->kc", facing, light) * solid_angle / np.pi
    mean = light.sum(axis=0) * solid_angle / (4.0 * np.pi)
    if name == "sh":
        axes = np.einsum("nk,nc->kc", directions, light) * solid_angle / (4.0 * np.pi)
        return np.concatenate([mean[None], axes])
    grey = light @ LUMINANCE_WEIGHTS
    return np.stack([mean, grey @ directions * solid_angle / (4.0 * np.pi)])


def sampled(name, hemisphere):
    """(k, 3) means of the terms over rays of a hemisphere."""
    from irradia.transport.backend import mi
    from irradia.transport.moments import MOMENTS

    local = hemisphere.draw(pairs())
    at = frame()
    direction = at.to_world(local)
    light = mi.Color3f(*radiance(np.array(direction).T.astype(np.float64)).T.astype(np.float32))
    terms = MOMENTS[name]().terms(light * (local.z / (np.pi * hemisphere.density(local.z))), direction, at)
    return np.stack([np.array(term).mean(axis=1, dtype=np.float64) for term in terms])


@pytest.mark.parametrize("name", ["sh", "mono", "rnm"])
def test_rays_estimate_the_moments(name):
    from irradia.transport.hemispheres import MIXED

    np.testing.assert_allclose(sampled(name, MIXED), expected(name), rtol=2e-3, atol=5e-4)


def test_what_the_normal_sees_of_the_moments_is_the_plain_map():
    directions, solid_angle = quadrature()
    light = radiance(directions)
    plain = ((directions @ NORMAL)[:, None] * light).sum(axis=0) * solid_angle / np.pi
    np.testing.assert_allclose(4.0 * NORMAL @ expected("sh")[1:], plain, rtol=1e-4)


@pytest.mark.parametrize("name", ["sh", "mono"])
def test_a_sample_is_never_worth_more_than_its_radiance(name):
    from irradia.transport.backend import mi
    from irradia.transport.hemispheres import MIXED
    from irradia.transport.moments import MOMENTS

    local = MIXED.draw(pairs())
    at = frame()
    light = mi.Color3f(local.z / (np.pi * MIXED.density(local.z)))
    for term in MOMENTS[name]().terms(light, at.to_world(local), at):
        assert np.abs(np.array(term)).max() <= 1.01


@pytest.mark.parametrize("name", ["COSINE", "MIXED"])
def test_hemispheres_have_their_density(name):
    from irradia.transport import hemispheres

    hemisphere = getattr(hemispheres, name)
    direction = np.array(hemisphere.draw(pairs()))
    assert np.allclose(np.linalg.norm(direction, axis=0), 1.0, atol=1e-5)
    edges = np.linspace(0.0, 1.0, 17)
    middle = np.linspace(0.0, 1.0, 16 * 64 + 1)
    middle = 0.5 * (middle[1:] + middle[:-1])
    density = np.array(hemisphere.density(_floats(middle))).reshape(16, 64).mean(axis=1)
    share = 2.0 * np.pi * density / 16.0
    assert share.sum() == pytest.approx(1.0, abs=1e-5)
    phi = np.arctan2(direction[1], direction[0]) / (2.0 * np.pi) + 0.5
    table = np.histogram2d(direction[2], phi, bins=[edges, 16], range=[[0, 1], [0, 1]])[0]
    wanted = np.repeat(share[:, None] / 16.0, 16, axis=1) * _N
    statistic = ((table - wanted) ** 2 / wanted).sum()
    assert stats.chi2.sf(statistic, table.size - 1) > 1e-4


def _floats(values):
    from irradia.transport.backend import mi

    return mi.Float(values.astype(np.float32))
