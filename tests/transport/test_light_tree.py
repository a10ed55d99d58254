"""The tree over lights: complete, and honest about its probabilities."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from irradia.scene.types import Light

pytestmark = pytest.mark.usefixtures("cpu_device")

_N = 1 << 17


def lamps(n, seed=2, kinds=("point", "spot"), **fields) -> list[Light]:
    """Points and spots of unequal strength, strewn over a hall."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(n):
        d = rng.normal(size=3)
        d /= np.linalg.norm(d)
        found.append(
            Light(
                kinds[rng.integers(len(kinds))],
                tuple(rng.uniform(0.1, 5.0, 3).tolist()),
                position=tuple(rng.uniform((-10, 0, -6), (10, 3, 6)).tolist()),
                direction=tuple(d.tolist()),
                inner_cone_rad=0.2,
                outer_cone_rad=float(rng.uniform(0.3, 1.5)),
                radius_m=float(rng.choice([0.0, 0.2])),
                range_m=float(rng.uniform(2, 20)) if rng.random() < 0.3 else None,
                **fields,
            )
        )
    return found


def triangles(n, seed=6, double_sided=0.3):
    """Bounds of small emissive triangles, a share of them double-sided."""
    from irradia.transport.light_bounds import bounds_of_triangles

    rng = np.random.default_rng(seed)
    corners = rng.uniform((-10, 0, -6), (10, 3, 6), (n, 1, 3)) + rng.normal(0, 0.2, (n, 3, 3))
    return bounds_of_triangles(corners, rng.uniform(0.1, 3.0, n), rng.random(n) < double_sided)


def places(n, seed=9):
    """Receivers and their normals, (n, 3) each."""
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=(n, 3))
    return rng.uniform((-11, -1, -7), (11, 4, 7), (n, 3)), normal / np.linalg.norm(normal, axis=1)[:, None]


def _p(values):
    from irradia.transport.backend import mi

    return mi.Point3f(np.ascontiguousarray(np.atleast_2d(values).T, np.float32))


def _uniform(n=_N, seed=1):
    from irradia.transport.backend import dr, mi
    from irradia.transport.sampling import Sampler

    return Sampler(dr.arange(mi.UInt32, n), mi.UInt32(seed)).next_2d()


@pytest.mark.parametrize("n", [2, 3, 7, 64, 1000])
@pytest.mark.parametrize("n_kinds", [1, 2])
def test_every_source_is_one_leaf_and_the_tree_is_as_shallow_as_its_kinds_let_it(n, n_kinds):
    from irradia.transport.light_bounds import bounds_of_lights
    from irradia.transport.light_tree_build import INDEX_BITS, LEAF, build_light_tree

    everyone = lamps(n, kinds=("point", "spot")[:n_kinds])
    table = build_light_tree(bounds_of_lights(everyone), np.zeros(n, np.bool_))
    assert len(table.nodes) == n - 1
    links = np.ascontiguousarray(table.nodes[:, :, 7]).view(np.uint32)
    for source in range(n):
        node, trail, turns = 0, int(table.trail[source]), 0
        while True:
            link = int(links[node, trail & 1])
            trail, turns = trail >> 1, turns + 1
            if link & LEAF:
                break
            node = link & INDEX_BITS
        assert link & INDEX_BITS == source
        assert turns <= table.depth
    assert math.ceil(math.log2(n)) <= table.depth <= math.ceil(math.log2(n)) + n_kinds - 1


def test_tree_of_very_many_sources_is_complete_too(monkeypatch):
    from irradia.transport import light_tree_build
    from irradia.transport.light_bounds import bounds_of_lights

    sources = bounds_of_lights(lamps(300, kinds=("point",)))
    monkeypatch.setattr(light_tree_build, "_THOROUGH_UP_TO", 100)
    table = light_tree_build.build_light_tree(sources, np.zeros(300, np.bool_))
    assert len(table.nodes) == 299
    assert table.depth == 9
    halves = table.nodes[0, :, :3]
    assert abs(halves[0, 0] - halves[1, 0]) > 8.0  # cut across x, where the hall is longest


def test_bounds_hold_what_is_below_them():
    from irradia.transport.light_bounds import bounds_of_groups, bounds_of_lights

    spots = bounds_of_lights(lamps(200, kinds=("spot",)))
    sources = spots.joined(triangles(100, double_sided=0.01))
    starts = np.array([0, 2, 50, 51, 180, 250])
    groups = bounds_of_groups(sources, starts)
    for k, (first, last) in enumerate(zip(starts, [*starts[1:], 300], strict=True)):
        part = sources.take(np.arange(first, last))
        reach = np.linalg.norm(part.centre - groups.centre[k], axis=1) + part.radius
        assert reach.max() <= groups.radius[k] + 1e-9
        tilt = np.arccos(np.clip(part.axis @ groups.axis[k], -1, 1)) + part.spread
        assert min(tilt.max(), math.pi) <= groups.spread[k] + 1e-9
        assert groups.power[k] == pytest.approx(part.power.sum())
        assert groups.falloff[k] == part.falloff.max()
        assert groups.reach[k] == part.reach.max()
    assert 0.0 < groups.spread[0] < math.pi


@pytest.mark.parametrize("double_sided", [1.0, 0.3])
def test_probabilities_of_surfaces_and_of_dead_ends_sum_to_one_everywhere(double_sided):
    """A dead end is a group whose bounds might shine here, though none of its members' do."""
    from irradia.transport.backend import dr, mi
    from irradia.transport.light_tree import LightTree

    n, sources = 37, triangles(37, double_sided=double_sided)
    tree = LightTree(sources, np.ones(n, np.bool_))
    where, _ = places(200)
    lane = dr.arange(mi.UInt32, 200 * n)
    p = dr.gather(mi.Point3f, _p(where), lane // n)
    found = (
        np.array(tree.probability(lane % n, p, mi.Vector3f(0.0), mi.Bool(True))).reshape(200, n).sum(axis=1)
    )
    lane = dr.arange(mi.UInt32, 200 << 12)
    u = (mi.Float(lane & 4095) + 0.5) / 4096.0
    pick = tree.pick(dr.gather(mi.Point3f, _p(where), lane >> 12), mi.Vector3f(0.0), u, mi.Bool(True))
    dead = (np.array(pick.probability) == 0).reshape(200, 4096).mean(axis=1)
    np.testing.assert_allclose(found + dead, 1.0, atol=5e-3)
    assert (dead.max() == 0.0) == (double_sided == 1.0)  # sources that face all round have none


def test_surfaces_are_picked_with_the_probability_that_is_asked_for_again():
    """Whatever the receiver's normal, which a ray's hit doesn't know."""
    from irradia.transport.backend import mi
    from irradia.transport.light_bounds import bounds_of_lights
    from irradia.transport.light_tree import LightTree

    n_lamps, n_surfaces = 20, 30
    sources = bounds_of_lights(lamps(n_lamps)).joined(triangles(n_surfaces))
    is_surface = np.arange(n_lamps + n_surfaces) >= n_lamps
    tree = LightTree(sources, is_surface)
    where, normals = places(8)
    for place, normal in zip(where, normals, strict=True):
        n = mi.Vector3f(*normal.tolist())
        pick = tree.pick(_p(place), n, _uniform().x, mi.Bool(True))
        source, probability = np.array(pick.source), np.array(pick.probability)
        on_surface = is_surface[source] & (probability > 0)
        unknown = mi.Vector3f(0.0)
        again = np.array(tree.probability(pick.source, _p(place), unknown, mi.Bool(True)))
        np.testing.assert_allclose(again[on_surface], probability[on_surface], rtol=1e-4)


@pytest.mark.parametrize("with_surfaces", [False, True])
def test_picks_come_as_often_as_they_say(with_surfaces):
    from irradia.transport.backend import mi
    from irradia.transport.light_bounds import bounds_of_lights
    from irradia.transport.light_tree import LightTree

    sources = bounds_of_lights(lamps(24))
    if with_surfaces:
        sources = sources.joined(triangles(16))
    n = len(sources)
    tree = LightTree(sources, np.arange(n) >= 24)
    rng = np.random.default_rng(3)
    for place, normal in zip(*places(6), strict=True):
        u = mi.Float(rng.random(_N).astype(np.float32))
        pick = tree.pick(_p(place), mi.Vector3f(*normal.tolist()), u, mi.Bool(True))
        source, probability = np.array(pick.source), np.array(pick.probability, np.float64)
        alive = probability > 0
        source, probability = source[alive], probability[alive]
        counts = np.bincount(source, minlength=n)
        expected = np.zeros(n)
        expected[source] = probability * _N
        assert expected.sum() == pytest.approx(alive.sum(), abs=5 * math.sqrt(alive.sum()))
        np.testing.assert_allclose(probability, expected[source] / _N)  # one probability a source
        often = expected > 8
        statistic = ((counts - expected)[often] ** 2 / expected[often]).sum()
        assert stats.chi2.sf(statistic, often.sum() - 1) > 1e-5
        assert stats.kstest(np.array(pick.u)[alive][::211], "uniform").pvalue > 1e-5


@pytest.mark.parametrize("kinds", [("point",), ("spot",), ("point", "spot")])
def test_no_light_that_arrives_is_left_out(kinds):
    from irradia.transport.backend import dr, mi
    from irradia.transport.light_bounds import bounds_of_lights
    from irradia.transport.light_tree import LightTree
    from irradia.transport.punctual import PunctualLights

    n, n_places = 150, 2000
    everyone = lamps(n, kinds=kinds)
    tree = LightTree(bounds_of_lights(everyone), np.zeros(n, np.bool_))
    lane = dr.arange(mi.UInt32, n * n_places)
    where, normals = (_p(values) for values in places(n_places))
    p, facing = (dr.gather(mi.Point3f, values, lane // n) for values in (where, normals))
    u = _uniform(n * n_places)
    direction, _, irradiance = PunctualLights(everyone).sample_one(p, lane % n, u, mi.Bool(True))
    arrives = np.array((dr.dot(mi.Vector3f(facing), direction) > 1e-3) & (dr.max(irradiance) > 0.0))
    probability = np.array(tree.probability(lane % n, p, mi.Vector3f(facing), mi.Bool(True)))
    assert 0.01 < arrives.mean() < 0.6
    assert (probability[arrives] > 0.0).all()


@pytest.mark.parametrize("kinds", [("point",), ("spot",), ("point", "spot")])
def test_estimate_is_what_all_lights_together_send(kinds):
    from irradia.transport.backend import dr, mi
    from irradia.transport.light_bounds import bounds_of_lights
    from irradia.transport.light_tree import LightTree
    from irradia.transport.punctual import PunctualLights

    n = 150
    everyone = lamps(n, kinds=kinds)
    lights = PunctualLights(everyone)
    tree = LightTree(bounds_of_lights(everyone), np.zeros(n, np.bool_))
    for place, normal in zip(*places(12), strict=True):
        p, facing = _p(place), mi.Vector3f(*normal.tolist())

        def arriving(index, u, p=p, facing=facing):
            direction, _, irradiance = lights.sample_one(p, index, u, mi.Bool(True))
            return np.array(dr.mean(irradiance) * dr.maximum(dr.dot(facing, direction), 0.0), np.float64)

        per_light = 64
        lane = dr.arange(mi.UInt32, n * per_light)
        exact = arriving(lane // per_light, _uniform(n * per_light)).sum() / per_light
        u = _uniform()
        pick = tree.pick(p, facing, u.x, mi.Bool(True))
        chance = np.array(pick.probability, np.float64)
        values = np.divide(
            arriving(pick.source, mi.Point2f(pick.u, u.y)), chance, out=np.zeros(_N), where=chance > 0
        )
        assert values.mean() == pytest.approx(exact, rel=0.01, abs=4 * values.std() / math.sqrt(_N) + 1e-9)


def test_near_and_facing_sources_are_preferred():
    from irradia.transport.backend import mi
    from irradia.transport.light_bounds import bounds_of_lights
    from irradia.transport.light_tree import LightTree

    near, far = (Light("point", (1.0, 1.0, 1.0), position=(x, 1.0, 0.0)) for x in (0.0, 10.0))
    down, away = (
        Light("spot", (1.0, 1.0, 1.0), position=(0.0, 1.0, 0.0), direction=(0.0, y, 0.0)) for y in (-1.0, 1.0)
    )
    for first, second in ((near, far), (down, away)):
        tree = LightTree(bounds_of_lights([first, second]), np.zeros(2, np.bool_))
        pick = tree.pick(_p((0.0, 0.0, 0.0)), mi.Vector3f(0, 1, 0), _uniform(4096).x, mi.Bool(True))
        assert (np.array(pick.source) == 0).mean() > 0.98


def test_below_the_horizon_of_all_lights_nothing_is_picked():
    from irradia.transport.backend import mi
    from irradia.transport.light_bounds import bounds_of_lights
    from irradia.transport.light_tree import LightTree

    tree = LightTree(bounds_of_lights(lamps(9, kinds=("point",))), np.zeros(9, np.bool_))
    under = _p((0.0, -5.0, 0.0))
    blind = tree.pick(under, mi.Vector3f(0, -1, 0), _uniform(64).x, mi.Bool(True))
    assert not np.array(blind.probability).any()
    all_round = tree.pick(under, mi.Vector3f(0, 0, 0), _uniform(64).x, mi.Bool(True))
    assert (np.array(all_round.probability) > 0).any()
