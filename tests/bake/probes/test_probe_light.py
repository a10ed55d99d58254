"""Light at points in free space, against answers on paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.core.sh import fibonacci_sphere, irradiance, sh_basis
from irradia.scene.builtin.shapes import centred_box, quad
from irradia.scene.merge import merge
from irradia.scene.types import Environment, Light, Material, Scene

from .places import scene_of

pytestmark = pytest.mark.usefixtures("cpu_device")

FAR_TRIANGLE = quad((500.0, 500.0, 500.0), (1e-3, 0, 0), (0, 1e-3, 0))  # a scene can't be without
PLACE = np.array([[0.3, 0.2, -0.1]], np.float32)


def gather(scene: Scene, places=PLACE, n_samples=1024, seed=1, least_m=1e-3) -> np.ndarray:
    from irradia.transport.probe_light import gather_sh
    from irradia.transport.world import World

    world = World(scene, merge(scene))
    result = np.zeros((len(places), 9, 3), np.float32)
    least = np.full(len(places), least_m, np.float32)
    for part, series in gather_sh(world, np.asarray(places, np.float32), least, n_samples, seed):
        result[part] = series
    return result


def test_kernel_and_reference_have_the_same_functions():
    from irradia.transport.backend import mi
    from irradia.transport.probe_light import _sh

    d = fibonacci_sphere(50).astype(np.float32)
    values = [np.broadcast_to(np.array(v), 50) for v in _sh(mi.Vector3f(d.T.copy()))]
    np.testing.assert_allclose(np.stack(values, axis=1), sh_basis(d), atol=1e-6)


def test_constant_surroundings_are_nothing_but_l0():
    found = gather(scene_of(FAR_TRIANGLE, sky=(1.0, 2.0, 0.5)), n_samples=4096)[0]
    np.testing.assert_allclose(found[0], np.sqrt(4 * np.pi) * np.array((1.0, 2.0, 0.5)), rtol=1e-4)
    assert np.abs(found[1:]).max() < 0.02


@pytest.mark.parametrize("direction", [(-1.0, 0.0, 0.0), (0.0, -0.6, -0.8)])
def test_sun_is_a_delta_whose_coefficients_are_exact(direction):
    sun = Light("directional", (3.0, 2.0, 1.0), direction=direction)
    found = gather(scene_of(FAR_TRIANGLE, lights=(sun,)), n_samples=8)[0]
    expected = sh_basis(-np.array(direction))[:, None] * sun.intensity
    np.testing.assert_allclose(found, expected, atol=1e-5)


def test_point_light_follows_the_inverse_square_and_its_direction():
    lamp = Light("point", (8.0, 4.0, 2.0), position=(0.3, 2.2, -0.1))
    found = gather(scene_of(FAR_TRIANGLE, lights=(lamp,)), n_samples=8)[0]
    expected = sh_basis((0, 1, 0))[:, None] * np.array(lamp.intensity) / 4.0
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-5)


def test_lamp_at_the_very_place_of_a_probe_stays_finite():
    lamp = Light("point", (8.0, 4.0, 2.0), position=tuple(map(float, PLACE[0])))
    sun = Light("directional", (3.0, 3.0, 3.0), direction=(0.0, -1.0, 0.0))
    found = gather(scene_of(FAR_TRIANGLE, lights=(lamp, sun)), n_samples=4096, least_m=0.5)[0, 0]
    expected = sh_basis((0, 1, 0))[0] * (3.0 + np.array(lamp.intensity) / 0.25)
    np.testing.assert_allclose(found, expected, rtol=0.05)
    near = replace(lamp, position=(0.3, 0.45, -0.1))
    found = gather(scene_of(FAR_TRIANGLE, lights=(near,)), n_samples=8, least_m=0.5)[0]
    np.testing.assert_allclose(
        found, sh_basis((0, 1, 0))[:, None] * lamp.intensity * 4.0, rtol=1e-3, atol=1e-4
    )


def test_light_that_an_engine_draws_itself_is_left_out():
    baked = Light("point", (8.0, 4.0, 2.0), position=(0.3, 2.2, -0.1))
    live = [replace(baked, position=(2.0, 0.0, 0.0), mode=mode) for mode in ("mixed", "realtime", "off")]
    alone = gather(scene_of(FAR_TRIANGLE, lights=(baked,)), n_samples=4096)
    together = gather(scene_of(FAR_TRIANGLE, lights=(*live, baked)), n_samples=4096)
    np.testing.assert_allclose(together, alone, atol=0.05 * np.abs(alone).max())


def test_live_light_still_comes_back_from_surfaces():
    lamp = Light("point", (8.0, 8.0, 8.0), position=(0.0, 0.5, 0.0))
    room = centred_box((4, 3, 5)).inside_out()
    full = gather(scene_of(room, lights=(lamp,)), n_samples=4096)[0, 0]
    indirect = gather(scene_of(room, lights=(replace(lamp, mode="realtime"),)), n_samples=4096)[0, 0]
    towards = np.linalg.norm(np.array(lamp.position) - PLACE[0])
    direct = 8.0 / towards**2 * sh_basis((0, 1, 0))[0]
    np.testing.assert_allclose(full - indirect, direct, rtol=0.03)


def test_furnace_room_shines_evenly():
    """Every surface reflects ρ and emits 1: radiance is 1 / (1 − ρ) from everywhere."""
    scene = scene_of(centred_box((4, 3, 5)).inside_out(), reflectance=0.5)
    material = replace(scene.materials[0], emission=(1.0, 1.0, 1.0))
    found = gather(replace(scene, materials=(material,)), n_samples=8192)[0]
    np.testing.assert_allclose(found[0], np.sqrt(4 * np.pi) * 2.0, rtol=0.01)
    assert np.abs(found[1:]).max() < 0.15


def test_closed_box_without_light_is_black():
    places = np.random.default_rng(1).uniform(-0.9, 0.9, (64, 3))
    found = gather(scene_of(centred_box((2, 2, 2)).inside_out(), sky=(1.0, 1.0, 1.0)), places, 256)
    assert not found.any()


def test_emissive_card_counts_once_by_its_solid_angle():
    """A lamp seen by rays and by next-event samples; E on a facing surface is known (Howell, B-3)."""
    side, height = 0.8, 1.0
    card = quad((-side / 2, height, -side / 2), (side, 0, 0), (0, 0, side))
    scene = scene_of(card)
    lamp = Material("lamp", base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emission=(5.0, 3.0, 1.0))
    found = gather(replace(scene, materials=(lamp,)), [(0.0, 0.0, 0.0)], 1 << 15)[0]
    h = side / 2 / height
    factor = 4 / (2 * np.pi) * 2 * h / np.sqrt(1 + h * h) * np.arctan(h / np.sqrt(1 + h * h))
    u, v = np.meshgrid(*[(np.arange(400) + 0.5) / 400 * side - side / 2] * 2)
    d = np.stack([u.ravel(), np.full(u.size, height), v.ravel()], axis=1)
    distance = np.linalg.norm(d, axis=1, keepdims=True)
    solid_angle = height / distance[:, 0] ** 3 * (side / 400) ** 2
    expected = (sh_basis(d / distance) * solid_angle[:, None]).sum(axis=0)[:, None] * lamp.emission
    np.testing.assert_allclose(found, expected, atol=0.01 * expected.max())
    assert abs(irradiance(expected, (0.0, 1.0, 0.0))[0] / (np.pi * factor * 5.0) - 1) < 0.15


def test_of_a_lamp_with_levels_of_detail_only_the_finest_shines():
    fine, coarse = (
        quad((-0.4, 1, -0.4), (0.8, 0, 0), (0, 0, 0.8)),
        quad((-0.4, 0.9, -0.4), (0.8, 0, 0), (0, 0, 0.8)),
    )
    lamp = Material("lamp", base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emission=(5.0, 3.0, 1.0))
    alone = replace(scene_of(fine), materials=(lamp,))
    both = replace(scene_of(fine, coarse), materials=(lamp,))
    levels = tuple(replace(i, lod_group=0, lod_level=n) for n, i in enumerate(both.instances))
    place = [(0.0, 0.0, 0.0)]
    found = gather(replace(both, instances=levels), place, 1 << 13)
    np.testing.assert_allclose(found, gather(alone, place, 1 << 13), atol=0.02 * found.max())


def test_environment_with_a_small_sun_is_found():
    radiance = np.full((32, 64, 3), 0.1, np.float32)
    radiance[8, 48] = 5000.0
    theta = np.pi * np.array([8, 9]) / 32
    solid_angle = (np.cos(theta[0]) - np.cos(theta[1])) * 2 * np.pi / 64
    scene = replace(scene_of(FAR_TRIANGLE), environment=Environment(radiance))
    found = gather(scene, n_samples=4096)[0, 0]
    expected = sh_basis((0, 1, 0))[0] * (4 * np.pi * 0.1 + 4999.9 * solid_angle)
    np.testing.assert_allclose(found, expected, rtol=0.01)


def test_blocks_of_samples_and_launches_change_nothing(monkeypatch):
    from irradia.transport import probe_light

    places = np.random.default_rng(2).uniform(-1, 1, (37, 3))
    scene = scene_of(centred_box((4, 3, 5)).inside_out(), lights=(Light("point", (5.0,) * 3),))
    whole = gather(scene, places, 200)
    monkeypatch.setattr(probe_light, "_LANES_PER_LAUNCH", 40)
    np.testing.assert_array_equal(gather(scene, places, 200), whole)


def test_looks_see_distance_backs_and_sky():
    from irradia.transport.probe_light import look_along
    from irradia.transport.world import World

    scene = scene_of(centred_box((2, 2, 2)))
    world = World(scene, merge(scene))
    origins = np.array([(3, 0, 0), (3, 0, 0), (0, 0, 0)], np.float32)
    directions = np.array([(-1, 0, 0), (1, 0, 0), (0, 1, 0)], np.float32)
    sight = look_along(world, origins, directions)
    np.testing.assert_allclose(sight.distance, (2.0, np.inf, 1.0), rtol=1e-5)
    np.testing.assert_array_equal(sight.back, (False, False, True))
    np.testing.assert_array_equal(sight.sky, (0.0, 1.0, 0.0))


def test_glass_lets_sight_and_sky_through():
    from irradia.transport.probe_light import look_along
    from irradia.transport.world import World

    scene = scene_of(quad((1, -1, -1), (0, 2, 0), (0, 0, 2)))
    glass = replace(scene.materials[0], base_color=(0.5, 1.0, 0.9, 1.0), transmission=1.0)
    scene = replace(scene, materials=(glass,))
    origins = np.zeros((1, 3), np.float32)
    sight = look_along(World(scene, merge(scene)), origins, np.array([(1.0, 0.0, 0.0)], np.float32))
    assert np.isinf(sight.distance[0])
    assert not sight.back[0]
    np.testing.assert_allclose(sight.sky, 0.8, atol=0.05)


def test_one_kernel_gathers_any_number_of_probes_and_samples():
    """A launch each; the second and third find the first's kernel."""
    from irradia.transport.backend import dr
    from irradia.transport.probe_light import gather_sh
    from irradia.transport.world import World

    scene = scene_of(centred_box((4, 3, 5)).inside_out(), lights=(Light("point", (5.0,) * 3),))
    world = World(scene, merge(scene))
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        for n_probes, n_samples in ((5, 64), (5, 500), (90, 130)):
            places = np.zeros((n_probes, 4), np.float32)
            list(gather_sh(world, places[:, :3], places[:, 3] + 1, n_samples, seed=1))
        history = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
    assert len(history) == 3
    assert len({entry["hash"] for entry in history}) == 1
