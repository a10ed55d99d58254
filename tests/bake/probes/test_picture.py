"""Spheres in a picture: where, in front of what, and lit from which side."""

from __future__ import annotations

import numpy as np

from irradia.bake.probes.picture import draw_probes
from irradia.core.sh import sh_basis
from irradia.formats.probes import EMPTY, FILLED
from irradia.scene.types import Camera

from .places import blank_probes

CAMERA = Camera(np.eye(4), yfov_rad=np.pi / 2)  # at the origin, along −Z
BLACK = np.zeros((60, 80, 3), np.float32)


def lit_from_above(position, **fields):
    """Light of direction +Y over an even part, so that all of the sphere shines."""
    series = (3.0 * sh_basis((0, 1, 0)) + 4.0 * sh_basis((0, 1, 0)) * (np.arange(9) == 0)).astype(np.float32)
    return blank_probes(np.array([position]), coefficients=np.repeat(series[None, :, None], 3, 2), **fields)


def test_sphere_lies_where_the_camera_sees_it_and_is_brighter_on_top():
    image = draw_probes(lit_from_above((1.0, 0.5, -3.0)), CAMERA, BLACK, radius_m=0.3)
    rows, columns = np.nonzero(image.any(axis=-1))
    # 30 px to a unit of slope: x = 40 + 30/3 · 1, y = 30 − 30/3 · 0.5.
    np.testing.assert_allclose((columns.mean() + 0.5, rows.mean() + 0.5), (50.0, 25.0), atol=0.5)
    assert image[rows.min() + 1, 50, 0] > 1.5 * image[rows.max() - 1, 50, 0]
    assert not BLACK.any()


def test_what_is_nearer_hides_a_sphere():
    probes = lit_from_above((0.0, 0.0, -3.0))
    assert not draw_probes(probes, CAMERA, BLACK, np.full((60, 80), 2.0, np.float32), radius_m=0.3).any()
    assert draw_probes(probes, CAMERA, BLACK, np.full((60, 80), 4.0, np.float32), radius_m=0.3).any()
    behind = lit_from_above((0.0, 0.0, 3.0))
    assert not draw_probes(behind, CAMERA, BLACK, radius_m=0.3).any()


def test_probes_in_walls_have_a_rim_and_empty_ones_are_left_out():
    filled = lit_from_above((0.0, 0.0, -1.0), state=np.array([FILLED], np.uint8))
    image = draw_probes(filled, CAMERA, BLACK, radius_m=0.3)
    assert (image[..., 0] > 5 * image[..., 2]).any()
    empty = lit_from_above((0.0, 0.0, -1.0), state=np.array([EMPTY], np.uint8))
    assert not draw_probes(empty, CAMERA, BLACK, radius_m=0.3).any()
