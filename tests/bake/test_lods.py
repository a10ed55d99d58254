"""Levels of detail and opted-out objects through a whole bake."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.scene.builtin.mesh import Mesh
from irradia.scene.builtin.shapes import box, floor
from irradia.scene.environment import environment_from_color
from irradia.scene.types import Instance, Material, Primitive, Scene

from .lit_scenes import bake, instance_of, laid_out, places

pytestmark = pytest.mark.usefixtures("cpu_device")

BLACK = Material("black", base_color=(0.0, 0.0, 0.0, 1.0), metallic=0.0, specular=0.0)
GREY = Material("grey", base_color=(0.5, 0.5, 0.5, 1.0), metallic=0.0, specular=0.0)
FLOOR = floor(4.0, 4.0)
FINE = box((-0.5, 0.3, -0.5), (0.5, 1.3, 0.5))
COARSE = box((-0.7, 0.2, -0.7), (0.7, 1.5, 0.7))


def _primitive(mesh: Mesh, material: int, index: int) -> Primitive:
    return Primitive(
        positions=mesh.positions.astype(np.float32),
        normals=mesh.normals.astype(np.float32),
        texcoords=(mesh.uv.astype(np.float32),),
        colors=None,
        indices=mesh.indices,
        material=material,
        mesh_index=index,
        primitive_index=0,
        vertex_source=np.arange(len(mesh.positions), dtype=np.uint32),
    )


def _scene(*boxes: tuple[Mesh, dict]) -> Scene:
    """Grey boxes over a black floor under a white sky."""
    primitives = [_primitive(FLOOR, 0, 0), *(_primitive(m, 1, k + 1) for k, (m, _) in enumerate(boxes))]
    instances = [Instance(0, np.eye(4), 0)]
    instances += [replace(Instance(k + 1, np.eye(4), k + 1), **fields) for k, (_, fields) in enumerate(boxes)]
    sky = environment_from_color((1.0, 1.0, 1.0))
    return Scene("boxes", tuple(primitives), tuple(instances), (BLACK, GREY), (), environment=sky)


def _means(scene: Scene) -> list[float]:
    """Mean E/π of each object."""
    mesh, texels, _ = places(scene, laid_out(scene, 64))
    result = bake(scene, 64, 64)
    assert result.valid.all()
    owner = instance_of(mesh, texels)
    light = result.irradiance_over_pi[:, 0].astype(np.float64)
    return [float(light[owner == k].mean()) for k in range(len(scene.instances))]


def test_each_level_is_lit_as_if_it_stood_there_alone_and_others_see_the_finest():
    both = _means(_scene((FINE, {"lod_group": 0}), (COARSE, {"lod_group": 0, "lod_level": 1})))
    fine, coarse = _means(_scene((FINE, {}))), _means(_scene((COARSE, {})))
    assert both[1] == pytest.approx(fine[1], rel=2e-2)
    assert both[2] == pytest.approx(coarse[1], rel=2e-2)
    assert both[0] == pytest.approx(fine[0], rel=1e-2)
    assert both[0] != pytest.approx(coarse[0], rel=2e-2)


def test_receive_only_box_leaves_the_floor_in_the_open():
    open_floor, lit_box = _means(_scene((FINE, {"casts": False})))
    assert open_floor == pytest.approx(1.0, abs=1e-5)
    assert lit_box > 0.4


def test_cast_only_box_shadows_the_floor_and_has_no_texels():
    scene = _scene((FINE, {"lightmap_scale": 0.0}))
    assert laid_out(scene, 64).page.tolist() == [0, -1]
    assert bake(scene, 64, 64).irradiance_over_pi.mean() < 0.99


def test_opted_out_box_is_as_if_it_were_not_there():
    scene = _scene((FINE, {"lightmap_scale": 0.0, "casts": False}))
    np.testing.assert_allclose(bake(scene, 64, 16).irradiance_over_pi, 1.0, atol=1e-5)
