"""The modelling kit: closed solids are closed, fronts face outward, volumes are right."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from irradia.scene.builtin import shapes
from irradia.scene.builtin.arch import arch_panel, arched_pane, groin_vault, soffit
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.relief import leaf, sheet
from irradia.scene.builtin.sweep import court_moulding, lathe, moulding, square_moulding

# A bevel takes a right-angled prism off each edge, as long as the face between them, and a corner's rest.
BEVELLED_UNIT_CUBE_M3 = 1 - 12 * 0.005 * 0.8 - 8 * 5e-3 / 6
SQUARE_RING = [(0, 0), (0.1, 0), (0.1, 0.2), (0, 0.2), (0, 0)]
SOLIDS = {
    "box": (shapes.box((0, 0, 0), (1, 2, 3)), 6.0),
    "bevelled box": (shapes.bevelled_box((0.1, 0.2, 0.3), (1.1, 1.2, 1.3), 0.1), BEVELLED_UNIT_CUBE_M3),
    "cylinder": (shapes.cylinder(0.5, 2.0, 24), 24 / 2 * np.sin(2 * np.pi / 24) * 0.25 * 2),
    "cone": (shapes.cone(0.5, 1.2, 24), 24 / 2 * np.sin(2 * np.pi / 24) * 0.25 * 1.2 / 3),
    "lathe": (lathe([(0, 0), (0.5, 0), (0.5, 1), (0, 1)], 32), 32 / 2 * np.sin(2 * np.pi / 32) * 0.25),
    "square ring": (square_moulding(SQUARE_RING, 0.5), 0.2 * (1.2**2 - 1)),
    "leaf": (leaf(np.array([[0.1, 0.0], [0.1, 0.1], [0.15, 0.2]]), 0.1, 0.01), None),
}  # fmt: skip


def directed_edges(mesh) -> Counter:
    _, welded = np.unique(np.round(mesh.positions, 7), axis=0, return_inverse=True)
    triangles = welded.reshape(-1)[mesh.indices]
    return Counter(map(tuple, np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]).tolist()))


def volume(mesh) -> float:
    a, b, c = (mesh.positions[mesh.indices[:, k]] for k in range(3))
    return float(np.einsum("tc,tc->", a, np.cross(b, c))) / 6


@pytest.mark.parametrize("name", SOLIDS)
def test_every_edge_of_a_solid_is_shared_once_in_each_direction(name):
    edges = directed_edges(SOLIDS[name][0])
    assert all(edges[b, a] == count for (a, b), count in edges.items())


@pytest.mark.parametrize("name", [n for n, (_, v) in SOLIDS.items() if v is not None])
def test_solid_has_the_volume_of_its_formula(name):
    mesh, expected = SOLIDS[name]
    assert volume(mesh) == pytest.approx(expected, rel=1e-6)


def test_sphere_volume_approaches_the_ball():
    assert volume(shapes.sphere(1.0, 96, 48)) == pytest.approx(4 / 3 * np.pi, rel=3e-3)


def test_sheet_around_a_wavy_surface_is_closed_and_holds_area_times_thickness():
    x, y = np.meshgrid(np.linspace(0, 1, 30), np.linspace(0, 2, 40), indexing="ij")
    points = np.stack([x, y, 0.1 * np.sin(6 * x)], axis=-1)
    mesh = sheet(points, 0.01, np.stack([x, y], axis=-1))
    edges = directed_edges(mesh)
    assert all(edges[b, a] == count for (a, b), count in edges.items())
    length = np.linalg.norm(np.diff(points[:, 0], axis=0), axis=1).sum()
    assert volume(mesh) == pytest.approx(2 * length * 0.01, rel=0.02)


def test_moulding_faces_the_right_of_its_path():
    profile = [(0.1, 0.0), (0.1, 1.0)]
    mesh = moulding(profile, [(0, 0, 0), (1, 0, 0)])
    np.testing.assert_allclose(mesh.normals, np.broadcast_to([0, 0, 1], mesh.normals.shape), atol=1e-12)
    np.testing.assert_allclose(mesh.positions[:, 2], 0.1)


def test_court_moulding_faces_into_the_court_and_mitres_its_corners():
    mesh = court_moulding([(0.1, 0.0), (0.1, 1.0)], 2.0, 1.0, 0.0)
    inward = -np.einsum("vc,vc->v", mesh.normals, mesh.positions * [1, 0, 1])
    assert inward.min() > 0
    np.testing.assert_allclose(np.abs(mesh.positions[:, 0]), 1.9)
    np.testing.assert_allclose(np.abs(mesh.positions[:, 2]), 0.9)


def test_smooth_profile_shades_smoothly_and_a_crease_stays_hard():
    smooth = lathe([(1.0, 0.0), (1.0, 1.0), (0.9, 2.0)], 16)
    hard = lathe([(1.0, 0.0), (1.0, 1.0), (0.5, 1.0)], 16)
    assert len(smooth.positions) == 17 * 3
    assert len(hard.positions) == 17 * 4


def test_arch_panel_and_pane_fill_the_wall_between_them():
    def area(mesh):
        a, b, c = (mesh.positions[mesh.indices[:, k]] for k in range(3))
        return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2

    panel = arch_panel(1.6, 0.5, 4.0, 1.0, 2.0, 24)
    pane = arched_pane(1.0, 0.5, 2.0, 24)
    assert area(panel) + area(pane) == pytest.approx(3.2 * 3.5, rel=1e-9)


def test_soffit_and_vault_face_the_space_below():
    under_arch = soffit(1.0, 2.0, 0.5, 16)
    toward_axis = np.array([0.0, 2.0, 0.0]) - under_arch.positions * [1, 1, 0]
    assert np.einsum("vc,vc->v", under_arch.normals, toward_axis).min() > 0
    vault = groin_vault(1.6, 1.8, 3.0, 1.3, 16)
    assert vault.normals[:, 1].max() <= 1e-12
    assert vault.positions[:, 1].max() == pytest.approx(4.3)


def test_look_at_points_minus_z_at_the_target():
    matrix = look_at((1, 2, 3), (4, 1, -2))
    np.testing.assert_allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-12)
    forward = np.array([3, -1, -5]) / np.sqrt(35)
    np.testing.assert_allclose(-matrix[:3, 2], forward)
    assert matrix[1, 1] > 0
