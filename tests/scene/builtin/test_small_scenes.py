"""Each small scene holds the case that it is made for."""

from __future__ import annotations

import io
from collections import Counter

import numpy as np
import pytest
from PIL import Image

from irradia.scene.builtin.leaks import CENTRE_Y_M, CENTRES_X_M, INNER_M, WALL_M
from irradia.scene.builtin.lights import hall_lamps


def rays_from_inside_all_hit(part, rng) -> bool:
    """Whether 200 random rays from the inner cube all meet a triangle."""
    a, b, c = (part.positions[part.indices[:, k]] for k in range(3))
    centre = np.array([CENTRES_X_M[part.node], CENTRE_Y_M, 0.0])
    for _ in range(200):
        origin = centre + rng.uniform(-0.49, 0.49, 3) * INNER_M
        direction = rng.normal(size=3)
        if not ray_hits(origin, direction, a, b, c):
            return False
    return True


def ray_hits(origin, direction, a, b, c) -> bool:
    """Möller and Trumbore's test against every triangle, in float64."""
    edge_1, edge_2 = b - a, c - a
    p = np.cross(direction, edge_2)
    determinant = np.einsum("tc,tc->t", edge_1, p)
    determinant = np.where(np.abs(determinant) < 1e-12, np.nan, determinant)
    u = np.einsum("tc,tc->t", origin - a, p) / determinant
    q = np.cross(origin - a, edge_1)
    v = q @ direction / determinant
    t = np.einsum("tc,tc->t", edge_2, q) / determinant
    return bool(((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)).any())


@pytest.mark.parametrize("name", CENTRES_X_M)
def test_no_ray_leaves_a_leaks_box(name, parts):
    (part,) = (p for p in parts("leaks") if p.node == name)
    assert rays_from_inside_all_hit(part, np.random.default_rng(1))


def test_touching_slabs_share_faces_and_fill_the_wall(parts):
    (part,) = (p for p in parts("leaks") if p.node == "touching")
    a, b, c = (part.positions[part.indices[:, k]] for k in range(3))
    volume = np.einsum("tc,tc->", a, np.cross(b, c)) / 6
    outer = INNER_M + 2 * WALL_M
    assert volume == pytest.approx(outer**3 - INNER_M**3, rel=1e-5)


def test_overlapping_slabs_hold_more_than_the_wall_and_edge_slabs_less(parts):
    volume = {}
    for part in parts("leaks"):
        a, b, c = (part.positions[part.indices[:, k]] for k in range(3))
        volume[part.node] = np.einsum("tc,tc->", a, np.cross(b, c)) / 6
    assert volume["edges-only"] == pytest.approx(6 * INNER_M**2 * WALL_M, rel=1e-5)
    assert volume["edges-only"] < volume["touching"] < volume["overlapping"]


def test_blocks_have_coincident_faces_of_both_facings(parts):
    facings = Counter()
    for part in parts("blocks"):
        a, b, c = (part.positions[part.indices[:, k]] for k in range(3))
        normals = np.sign(np.round(np.cross(b - a, c - a), 6)).astype(int)
        for first in range(0, len(part.indices), 2):
            corners = part.positions[np.unique(part.indices[first : first + 2])]
            key = tuple(sorted(map(tuple, np.round(corners, 3).tolist())))
            facings[key, tuple(normals[first].tolist())] += 1
    same = sum(count > 1 for count in facings.values())
    opposite = sum((key, tuple(-n for n in normal)) in facings for key, normal in facings) // 2
    assert same == 3 * 6
    assert opposite > 60


def test_leaf_texture_is_a_clean_mask_with_holes(document):
    (encoded,) = document("foliage").images
    alpha = np.asarray(Image.open(io.BytesIO(encoded)))[..., 3]
    assert set(np.unique(alpha)) == {0, 255}
    assert 0.25 < (alpha == 255).mean() < 0.6


def test_leaf_cards_show_the_texture_once(parts):
    for part in parts("foliage"):
        if part.material == "leaves":
            cards = part.uv.reshape(-1, 4, 2)
            np.testing.assert_allclose(np.ptp(cards, axis=1), 1.0, atol=1e-6)


@pytest.mark.parametrize(("name", "n_lamps", "n_spots"), [("lights", 1000, 300), ("lights-10", 10, 3)])
def test_hall_has_its_lamps_inside_it_and_outside_of_everything_else(document, parts, name, n_lamps, n_spots):
    entry = document(name).json
    lights = entry["extensions"]["KHR_lights_punctual"]["lights"]
    kinds = Counter(entry_light["type"] for entry_light in lights)
    assert kinds == {"point": n_lamps - n_spots, "spot": n_spots}
    places = np.array([n["translation"] for n in entry["nodes"] if "extensions" in n])
    assert len(places) == n_lamps
    radii = np.array([light["extras"]["irradia"]["radius"] for light in lights])[:, None]
    for part in parts(name):
        low, high = part.positions.min(axis=0), part.positions.max(axis=0)
        if part.node == "hall":
            assert (places - radii > low).all()
            assert (places + radii < high).all()
        elif part.node.startswith("column"):
            centre = (low + high)[[0, 2]] / 2
            assert (np.linalg.norm(places[:, [0, 2]] - centre, axis=1) > 0.3 + radii[:, 0]).all()
        else:
            assert ((places + radii < low) | (places - radii > high)).any(axis=1).all()


def test_ten_lamps_are_together_as_bright_as_a_thousand():
    few, many = (sum(sum(lamp.intensity) for lamp in hall_lamps(n)) for n in (10, 1000))
    assert few == pytest.approx(many, rel=0.5)  # ten stand for a thousand of unequal ones


def test_merged_objects_are_the_same_triangles_as_one_object(parts):
    separate, merged = parts("objects"), parts("objects-merged")
    assert len(separate) == 5001
    assert len(merged) == 1
    corners = np.concatenate([p.positions[p.indices] for p in separate])
    np.testing.assert_allclose(merged[0].positions[merged[0].indices], corners, atol=1e-5)


def test_pane_fills_the_hole_in_the_ceiling(parts):
    room, pane = (next(p for p in parts("pane") if p.node == n) for n in ("room", "pane"))
    ceiling = room.positions[room.indices][(room.positions[room.indices][..., 1] > 2.49).all(axis=1)]
    a, b, c = ceiling.swapaxes(0, 1)
    covered = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    a, b, c = (pane.positions[pane.indices[:, k]] for k in range(3))
    assert covered + np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(16.0, rel=1e-6)


def test_cylinder_is_faceted_in_shape_and_smooth_in_shading(parts):
    (body,) = (p for p in parts("cylinder") if p.node == "cylinder")
    side = np.abs(body.normals[:, 1]) < 0.5
    radial = body.positions[side] * [1, 0, 1] / 0.5
    np.testing.assert_allclose(body.normals[side], radial, atol=1e-6)
    assert len(np.unique(np.round(radial, 5), axis=0)) == 12
