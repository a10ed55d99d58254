"""IES tables continued over the sphere."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.formats.ies import IesTable, decode_ies
from irradia.scene.light_profile import light_candela, mean_candela, profile_from_ies
from irradia.scene.monotone_cubic import monotone_cubic
from irradia.scene.types import Light


def table(vertical, horizontal, kind="C", seed=3) -> IesTable:
    rng = np.random.default_rng(seed)
    candela = rng.uniform(10.0, 100.0, (len(horizontal), len(vertical)))
    if kind == "C" and vertical[0] == 0:
        candela[:, 0] = candela[0, 0]  # the axis has one value
    as_array = (np.array(values, np.float64) for values in (vertical, horizontal))
    return IesTable(kind, *as_array, candela, 2002, {})


def lamp(measured: IesTable, **fields) -> Light:
    pose = {"direction": (0.0, 0.0, -1.0), "up": (1.0, 0.0, 0.0), **fields}
    return Light("point", (1.0, 1.0, 1.0), profile=profile_from_ies(measured), **pose)


def towards(vertical_deg, horizontal_deg):
    """Type C directions of an untransformed light, (N, 3)."""
    v, h = np.radians(vertical_deg), np.radians(horizontal_deg)
    return np.stack([np.sin(v) * np.cos(h), np.sin(v) * np.sin(h), -np.cos(v) + 0 * h], axis=-1)


HALF, QUARTER, THIRD = [0, 90, 180], [0, 22.5, 45, 90], [0, 60, 120, 180]


@pytest.mark.parametrize("horizontal", [[0], QUARTER, THIRD, [0, 90, 180, 270, 360], [90, 135, 180, 270]])
@pytest.mark.parametrize("vertical", [[0, 30, 60, 90], [0, 45, 90, 135, 180], [90, 120, 180]])
def test_profile_passes_through_every_measured_value(vertical, horizontal):
    measured = table(vertical, horizontal)
    if horizontal[-1] == 360:
        measured.candela[-1] = measured.candela[0]
    if vertical[-1] == 180:
        measured.candela[:, -1] = 5.0
    h, v = np.meshgrid(measured.horizontal_deg, measured.vertical_deg, indexing="ij")
    found = light_candela(lamp(measured), towards(v.ravel(), h.ravel())).reshape(h.shape)
    poles = (v == 0) | (v == 180)
    np.testing.assert_allclose(found[~poles], measured.candela[~poles], rtol=2e-6)


@pytest.mark.parametrize(
    ("horizontal", "mirrors"),
    [
        ([0], [lambda h: h + 77.0]),
        (QUARTER, [lambda h: -h, lambda h: 180 - h]),
        (THIRD, [lambda h: -h]),
        ([90, 135, 180, 270], [lambda h: 180 - h]),
    ],
)
def test_range_of_horizontal_angles_says_the_symmetry(horizontal, mirrors):
    light = lamp(table([0, 30, 60, 90], horizontal))
    rng = np.random.default_rng(8)
    v, h = rng.uniform(0, 90, 500), rng.uniform(0, 360, 500)
    here = light_candela(light, towards(v, h))
    for mirror in mirrors:
        np.testing.assert_allclose(light_candela(light, towards(v, mirror(h))), here, rtol=1e-4)


def test_full_turn_without_its_last_plane_is_closed():
    with_last = table([0, 45, 90], [0, 90, 180, 270, 360])
    with_last.candela[-1] = with_last.candela[0]
    without = IesTable(
        "C", with_last.vertical_deg, with_last.horizontal_deg[:-1], with_last.candela[:-1], 2002, {}
    )
    a, b = (profile_from_ies(t).candela for t in (with_last, without))
    np.testing.assert_array_equal(a, b)


def test_beyond_the_measured_angles_it_is_dark():
    light = lamp(table([0, 30, 60], [0]))
    np.testing.assert_array_equal(light_candela(light, towards(np.array([61.0, 120, 180]), np.zeros(3))), 0.0)


def test_type_b_turns_about_a_horizontal_axis():
    """V leads from the beam towards +X; H leans clockwise, towards −Y, whatever V is."""
    vertical, horizontal = [-90, -45, 0, 45, 90], [-90, -30, 0, 30, 90]
    measured = table(vertical, horizontal, "B")
    light = lamp(measured)
    h, v = (np.radians(a) for a in np.meshgrid(horizontal, vertical, indexing="ij"))
    directions = np.stack([np.cos(h) * np.sin(v), -np.sin(h), -np.cos(h) * np.cos(v)], axis=-1)
    found = light_candela(light, directions.reshape(-1, 3)).reshape(h.shape)
    inner = (np.abs(h) < 1.5) & (np.abs(v) < 1.5)  # at the poles many angles share a direction
    np.testing.assert_allclose(found[inner], measured.candela[inner], rtol=5e-3)
    assert light_candela(light, np.array([[0.1, 0.0, 1.0]]))[0] == 0.0


def test_type_b_half_ranges_are_mirrored():
    light = lamp(table([0, 30, 90], [0, 45, 90], "B"))
    rng = np.random.default_rng(2)
    d = rng.normal(size=(400, 3))
    d[:, 2] = -np.abs(d[:, 2])
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    here = light_candela(light, d)
    np.testing.assert_allclose(light_candela(light, d * (-1, 1, 1)), here, rtol=1e-3, atol=0.05)
    np.testing.assert_allclose(light_candela(light, d * (1, -1, 1)), here, rtol=1e-3, atol=0.05)


def test_profile_turns_with_its_light():
    """Aimed down with 0° towards +X, as a luminaire hangs: 90° is −Z, counter-clockwise from above."""
    light = lamp(table([0, 45, 90], [0, 90, 180, 270]), direction=(0.0, -1.0, 0.0))
    upright = lamp(table([0, 45, 90], [0, 90, 180, 270]))
    v, h = np.array([45.0, 45.0, 90.0]), np.array([0.0, 90.0, 270.0])
    r, down = np.sin(np.radians(v)), np.cos(np.radians(v))
    hung = np.stack([r * np.cos(np.radians(h)), -down, -r * np.sin(np.radians(h))], axis=-1)
    np.testing.assert_allclose(light_candela(light, hung), light_candela(upright, towards(v, h)), rtol=1e-5)


def test_mean_candela_are_lumens_over_4_pi():
    """A cosine over one half-space: π·I lumens."""
    angles = np.linspace(0, 90, 181)
    cosine = IesTable("C", angles, np.zeros(1), 100.0 * np.cos(np.radians(angles))[None], 2002, {})
    assert mean_candela(profile_from_ies(cosine)) == pytest.approx(100.0 / 4, rel=1e-3)


def test_up_along_the_beam_is_no_obstacle():
    light = lamp(table([0, 45, 90], [0]), direction=(0.0, 1.0, 0.0), up=(0.0, 1.0, 0.0))
    assert light_candela(light, np.array([[0.0, 1.0, 0.0]]))[0] > 0.0


def test_real_files_are_flat_tables_with_smooth_middles():
    body = b"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0 1 1 0\n0 45 90\n0\n100 50 0\n"
    light = lamp(decode_ies(body, "x"))
    fine = light_candela(light, towards(np.linspace(0, 90, 181), np.zeros(181)))
    assert (np.diff(fine) < 0).all()
    assert np.abs(np.diff(fine, 2)).max() < 0.1  # a kink of straight lines would be none, a step 50


def test_cubic_never_overshoots_and_keeps_its_nodes():
    rng = np.random.default_rng(1)
    x = np.cumsum(rng.uniform(0.1, 2.0, 12))
    y = rng.uniform(0.0, 1.0, (12, 40))
    np.testing.assert_allclose(monotone_cubic(x, y, x), y, atol=1e-12)
    at = np.linspace(x[0], x[-1], 999)
    found = monotone_cubic(x, y, at)
    cell = np.clip(np.searchsorted(x, at, side="right") - 1, 0, 10)
    assert (found <= np.maximum(y[cell], y[cell + 1]) + 1e-12).all()
    assert (found >= np.minimum(y[cell], y[cell + 1]) - 1e-12).all()
