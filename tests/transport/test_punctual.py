"""Points, spots, suns and measured lights against what is known of them on paper."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from irradia.formats.ies import IesTable
from irradia.scene.light_profile import light_candela, profile_from_ies
from irradia.scene.types import Light

from .flat_scenes import BLACK, Sheet, matte, stacked, world_of

pytestmark = pytest.mark.usefixtures("cpu_device")

_N = 1 << 14
_WHITE = (1.0, 1.0, 1.0)


def ask(lights, origins, index=0, n=_N):
    """``n`` samples of one light at each origin: directions (P, n, 3), distances, irradiances (P, n)."""
    from irradia.transport.backend import dr, mi
    from irradia.transport.punctual import PunctualLights
    from irradia.transport.sampling import Sampler

    origins = np.atleast_2d(np.array(origins, np.float32))
    lane = dr.arange(mi.UInt32, len(origins) * n)
    place = lane // n
    p = dr.gather(mi.Point3f, mi.Point3f(np.ascontiguousarray(origins.T)), place)
    u = Sampler(lane - place * n, mi.UInt32(7) + place).next_2d()
    lights = PunctualLights(lights if isinstance(lights, list) else [lights])
    direction, distance, irradiance = lights.sample_one(p, mi.UInt32(index), u, mi.Bool(True))
    shape = (len(origins), n)
    distance = dr.select(mi.Bool(True), distance, 0.0) + dr.zeros(mi.Float, len(origins) * n)
    return (
        np.array(direction).T.reshape(*shape, 3),
        np.array(distance).reshape(shape),
        np.broadcast_to(np.array(irradiance.x), len(origins) * n).reshape(shape),
    )


def irradiance(light, origin, normal):
    """E at one place."""
    direction, _, arriving = ask(light, origin)
    return float((arriving * np.maximum(direction @ np.array(normal), 0.0)).mean())


@pytest.mark.parametrize("distance", [0.5, 1.0, 4.0, 200.0])
@pytest.mark.parametrize("tilt_deg", [0.0, 50.0])
def test_sphere_sends_what_its_candela_say_at_any_distance(distance, tilt_deg):
    light = Light("point", (30.0, 1.0, 1.0), position=(1.0, 2.0, 3.0), radius_m=0.3)
    normal = (math.sin(math.radians(tilt_deg)), math.cos(math.radians(tilt_deg)), 0.0)
    found = irradiance(light, (1.0, 2.0 - distance, 3.0), normal)
    assert found == pytest.approx(30.0 * math.cos(math.radians(tilt_deg)) / distance**2, rel=3e-3)


def test_samples_of_a_sphere_end_on_its_surface_and_are_uniform_in_what_is_seen_of_it():
    light = Light("point", _WHITE, position=(0.0, 0.0, 2.0), radius_m=0.5)
    direction, distance, arriving = ask(light, (0.0, 0.0, 0.0))
    ends = direction[0] * distance[0][:, None]
    np.testing.assert_allclose(np.linalg.norm(ends - (0, 0, 2), axis=1), 0.5, rtol=2e-3)
    assert (ends[:, 2] < 2.0).all()
    np.testing.assert_allclose(arriving, arriving[0, 0])
    cos_edge = math.sqrt(1 - 0.25**2)
    assert direction[0, :, 2].min() >= cos_edge - 1e-6
    spread = (1 - direction[0, :, 2]) / (1 - cos_edge)
    assert stats.kstest(spread[::13], "uniform").pvalue > 1e-4


def test_inside_a_sphere_its_light_is_finite_and_nothing_is_in_the_way():
    light = Light("point", _WHITE, position=(0.0, 0.0, 0.0), radius_m=0.5)
    _, distance, arriving = ask(light, [(0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.4999, 0.0, 0.0)])
    assert (distance == 0.0).all()
    np.testing.assert_allclose(arriving, 2.0 / 0.25, rtol=1e-5)


def test_small_sphere_is_a_point():
    origins = np.random.default_rng(3).normal(size=(50, 3))
    point = Light("spot", _WHITE, position=(0.0, 0.0, 3.0), outer_cone_rad=1.2)
    tiny = Light("spot", _WHITE, position=(0.0, 0.0, 3.0), outer_cone_rad=1.2, radius_m=1e-5)
    sharp, soft = ask(point, origins, n=4), ask(tiny, origins, n=4)
    np.testing.assert_allclose(soft[0], sharp[0], atol=2e-5)
    np.testing.assert_allclose(soft[1], sharp[1], rtol=1e-4)
    np.testing.assert_allclose(soft[2], sharp[2], rtol=1e-3)


def test_spot_falls_with_the_square_between_its_cones_and_ends_there():
    inner, outer = math.radians(20), math.radians(40)
    light = Light(
        "spot", (10.0, 0.0, 0.0), direction=(0.0, -1.0, 0.0), inner_cone_rad=inner, outer_cone_rad=outer
    )
    angles = np.radians([0.0, 15.0, 25.0, 33.0, 39.0, 41.0, 90.0, 180.0])
    origins = 2.0 * np.stack([np.sin(angles), -np.cos(angles), 0 * angles], axis=1)
    _, _, arriving = ask(light, origins, n=1)
    ramp = (np.cos(angles) - math.cos(outer)) / (math.cos(inner) - math.cos(outer))
    np.testing.assert_allclose(arriving[:, 0], 10.0 / 4 * np.clip(ramp, 0, 1) ** 2, rtol=1e-3, atol=1e-6)


def test_range_ends_a_light_smoothly():
    light = Light("point", _WHITE, range_m=2.0)
    _, _, arriving = ask(light, [(1.0, 0, 0), (0, 1.9, 0), (0, 0, 2.1)], n=1)
    expected = [1 - 0.5**4, (1 - 0.95**4) / 1.9**2, 0.0]
    np.testing.assert_allclose(arriving[:, 0], expected, rtol=1e-5)


@pytest.mark.parametrize("angle_deg", [0.0, 0.53, 40.0])
def test_sun_of_any_size_sends_its_lux_to_what_faces_it(angle_deg):
    light = Light("directional", (1000.0, 1.0, 1.0), direction=(0.0, -1.0, 0.0), angle_deg=angle_deg)
    assert irradiance(light, (5.0, 0.0, 5.0), (0.0, 1.0, 0.0)) == pytest.approx(1000.0, rel=2e-3)


def test_sun_is_a_disc_of_even_brightness():
    light = Light("directional", _WHITE, direction=(0.0, -1.0, 0.0), angle_deg=0.53)
    direction = ask(light, (0.0, 0.0, 0.0))[0][0]
    edge = math.radians(0.53 / 2)
    angle = np.linalg.norm(direction[:, [0, 2]], axis=1)
    assert angle.max() <= edge * 1.001
    assert stats.kstest((angle[::13] / edge) ** 2, "uniform").pvalue > 1e-4


def _measured(seed=1) -> Light:
    rng = np.random.default_rng(seed)
    vertical, horizontal = np.arange(0.0, 181.0, 15.0), np.arange(0.0, 361.0, 45.0)
    candela = rng.uniform(1.0, 50.0, (len(horizontal), len(vertical)))
    candela[-1] = candela[0]
    axis = np.array([0.3, -0.9, 0.2]) / np.linalg.norm([0.3, -0.9, 0.2])
    return Light(
        "point",
        (2.0, 1.0, 1.0),
        position=(1.0, 0.0, 0.0),
        direction=(float(axis[0]), float(axis[1]), float(axis[2])),
        up=(0.0, 0.0, 1.0),
        profile=profile_from_ies(IesTable("C", vertical, horizontal, candela, 2002, {})),
    )


def test_profile_sends_what_the_reference_says_in_every_direction():
    light = _measured()
    directions = np.random.default_rng(5).normal(size=(3000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    _, _, arriving = ask(light, np.array(light.position) + 2.0 * directions, n=1)
    np.testing.assert_allclose(arriving[:, 0], 2.0 * light_candela(light, directions) / 4, rtol=5e-3)


def test_profile_replaces_the_cone_and_leaves_other_lights_alone():
    spot = Light("spot", (3.0, 3.0, 3.0), outer_cone_rad=0.3, direction=(0.0, -1.0, 0.0))
    aimed = Light("spot", (1.0, 1.0, 1.0), outer_cone_rad=0.3, profile=_measured().profile)
    origin = (0.0, -2.0, 0.0)
    assert ask([spot, aimed], origin, index=0, n=1)[2][0, 0] == pytest.approx(3.0 / 4)
    assert ask([spot, aimed], (0.0, 0.0, 1.0), index=1, n=1)[2][0, 0] > 0.5  # behind its cone


def test_live_lights_are_those_mixed_or_realtime():
    from irradia.transport.backend import mi
    from irradia.transport.punctual import NO_LIGHT, PunctualLights

    modes = ("baked", "mixed", "realtime", "off")
    index = mi.UInt32([0, 1, 2, 3, NO_LIGHT])
    lights = PunctualLights([Light("point", _WHITE, mode=mode) for mode in modes])
    assert np.array(lights.is_live(index, mi.Bool(True))).tolist() == [False, True, True, False, False]
    assert np.array(lights.is_live(index, mi.Bool(False))).sum() == 0
    assert not np.array(PunctualLights([Light("point", _WHITE)]).is_live(index, mi.Bool(True))).any()


def test_penumbra_is_as_wide_as_the_lamp_and_the_edge_make_it():
    """A sphere over a long edge: the share that is seen is a disc cut by the edge's plane."""
    from irradia.transport.backend import dr, mi

    radius, height, edge_x, edge_y = 0.2, 3.0, 0.5, 1.0
    light = Light("point", _WHITE, position=(0.0, height, 0.0), radius_m=radius)
    floor = Sheet(matte(0.5), width=20.0, depth=20.0)
    lid = Sheet(BLACK, y=edge_y, width=2 * edge_x, depth=50.0)
    world = world_of(stacked([floor, lid], lights=(light,)))

    shadow_x = edge_x * height / (height - edge_y)
    x = shadow_x + np.linspace(-0.15, 0.15, 25)
    n = 4096
    origins = np.stack([x, np.full(25, 1e-3), np.zeros(25)], axis=1)
    direction, distance, _ = ask(light, origins, n=n)
    o = mi.Point3f(np.ascontiguousarray(np.repeat(origins, n, axis=0).T, np.float32))
    d = mi.Vector3f(np.ascontiguousarray(direction.reshape(-1, 3).T, np.float32))
    seen = world.transmittance(o, d, mi.Float(distance.ravel().astype(np.float32)), mi.Bool(True))
    share = np.array(dr.mean(seen)).reshape(25, n).mean(axis=1)

    # Signed distance of the lamp's centre from the plane through the place and the edge.
    normal = np.stack([np.full(25, edge_y), x - edge_x], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    offset = np.clip(((0.0 - x) * normal[:, 0] + height * normal[:, 1]) / radius, -1.0, 1.0)
    expected = (np.arccos(-offset) + offset * np.sqrt(1 - offset**2)) / np.pi
    assert (expected[0], expected[-1]) == (0.0, 1.0)  # the places span the penumbra
    np.testing.assert_allclose(share, expected, atol=0.02)
