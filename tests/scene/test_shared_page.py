"""Objects that a file lays out on one page together stay there; overlapping ones get rectangles."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.progress import silent_progress
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
from irradia.scene.types import Instance, Material, Primitive, Scene

_UNIT = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)


def _quad(uv1: np.ndarray, index: int) -> Primitive:
    corners = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], np.float32)
    return Primitive(
        positions=corners,
        normals=np.tile(np.float32([0, 1, 0]), (4, 1)),
        texcoords=(np.zeros((4, 2), np.float32), uv1.astype(np.float32)),
        colors=None,
        indices=np.array([[0, 1, 2], [0, 2, 3]], np.uint32),
        material=0,
        mesh_index=index,
        primitive_index=0,
        vertex_source=np.arange(4, dtype=np.uint32),
    )


def _layout(*uvs: np.ndarray, options: LayoutOptions, copies: int = 1):
    primitives = tuple(_quad(uv, k) for k, uv in enumerate(uvs))
    instances = tuple(Instance(k, np.eye(4), k) for k in range(len(uvs)) for _ in range(copies))
    scene = Scene("sheet", primitives, instances, (Material(),), ())
    return layout_lightmap(scene, options, silent_progress())


_LEFT, _RIGHT = 0.05 + 0.4 * _UNIT, np.float32([0.55, 0.05]) + 0.4 * _UNIT


def test_uv_that_share_a_page_stay_where_they_are():
    layout = _layout(_LEFT, _RIGHT, options=LayoutOptions(resolution=256))
    assert (layout.n_pages, layout.width_px) == (1, 256)
    assert (layout.scale == 1).all()
    assert (layout.offset == 0).all()
    for unwrap, uv in zip(layout.unwraps, (_LEFT, _RIGHT), strict=True):
        assert np.array_equal(unwrap.uv, uv.astype(np.float32))
    assert layout.texels_per_metre == pytest.approx(0.4 * 256)
    assert "as the file lays it out" in layout.notes[0]


def test_uv_that_overlap_between_objects_get_rectangles():
    layout = _layout(_LEFT, _LEFT, options=LayoutOptions(resolution=256))
    assert (layout.scale != 1).all()


def test_repeated_objects_get_rectangles():
    layout = _layout(_LEFT, _RIGHT, options=LayoutOptions(resolution=256), copies=2)
    assert len({tuple(o) for o in layout.offset}) == 4


def test_density_decides_the_shared_pages_edge():
    layout = _layout(_LEFT, _RIGHT, options=LayoutOptions(texels_per_metre=100))
    assert layout.width_px == 252  # 100 texels over 0.4 of the page, to a multiple of four
