"""Fingerprints tell an edit from a mere re-save."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from irradia.scene.environment import environment_from_color
from irradia.scene.fingerprint import Changes, compare_fingerprints, fingerprint, instance_names
from irradia.scene.types import Light, Scene


@pytest.fixture
def scene(named_scene) -> Scene:
    """Two nodes of one mesh, one of another; a light of each of two names, and a sky."""
    lights = (Light("point", (1.0, 2.0, 3.0), name="bulb"), Light("point", (1.0, 1.0, 1.0), name="bulb"))
    made = named_scene([("left", "square"), ("right", "square"), ("alone", "other")])
    return replace(made, lights=lights, environment=environment_from_color((0.5, 0.5, 0.5)))


def difference(before: Scene, after: Scene):
    return compare_fingerprints(fingerprint(before), fingerprint(after))


def with_instance(scene: Scene, index: int, **fields) -> Scene:
    instances = list(scene.instances)
    instances[index] = replace(instances[index], **fields)
    return replace(scene, instances=tuple(instances))


def with_primitive(scene: Scene, index: int, **fields) -> Scene:
    primitives = list(scene.primitives)
    primitives[index] = replace(primitives[index], **fields)
    return replace(scene, primitives=tuple(primitives))


def test_fingerprint_is_plain_json(scene):
    mark = fingerprint(scene)
    assert json.loads(json.dumps(mark)) == mark
    assert set(mark["instances"]) == {"left", "right", "alone"}
    assert set(mark["lights"]) == {"bulb", "bulb #2"}


def test_same_scene_has_the_same_fingerprint(scene):
    assert not difference(scene, scene)


def test_order_of_vertices_and_triangles_does_not_count(scene):
    square = scene.primitives[0]
    two = np.array([[0, 1, 2], [0, 2, 1]], np.uint32)
    before = with_primitive(scene, 0, indices=two)
    turned = np.array([2, 0, 1])  # vertex k moves to place turned[k]
    back = np.argsort(turned)
    after = with_primitive(
        scene,
        0,
        positions=square.positions[back],
        normals=square.normals[back],
        texcoords=(square.texcoords[0][back],),
        indices=turned[two[::-1][:, [1, 2, 0]]].astype(np.uint32),
    )
    assert not difference(before, after)


def test_noise_of_float_arithmetic_does_not_count(scene):
    square = scene.primitives[0]
    nearly = np.nextafter(square.positions, np.float32(0.0))
    assert not difference(scene, with_primitive(scene, 0, positions=nearly))
    world = scene.instances[0].world_from_object * (1 - 1e-9)
    assert not difference(scene, with_instance(scene, 0, world_from_object=world))


def test_names_and_numbers_of_nodes_and_materials_do_not_count(scene):
    renamed = tuple(replace(material, name="new") for material in scene.materials)
    assert not difference(scene, replace(scene, materials=renamed))
    assert not difference(scene, with_instance(scene, 2, node_index=77))


@pytest.mark.parametrize(
    "fields", [{"casts": False}, {"lightmap_scale": 2.0}, {"lod_group": 0, "lod_level": 1}]
)
def test_part_in_the_bake_counts(scene, fields):
    assert difference(scene, with_instance(scene, 1, **fields)).instances == Changes(changed=("right",))


def test_moved_object_alone_has_changed(scene):
    moved = scene.instances[1].world_from_object.copy()
    moved[0, 3] += 1e-3
    changes = difference(scene, with_instance(scene, 1, world_from_object=moved))
    assert changes.instances == Changes(changed=("right",))
    assert not changes.lights
    assert not changes.environment


@pytest.mark.parametrize("change", ["grown", "flipped", "unwrapped", "painted", "bent"])
def test_edited_mesh_changes_all_its_objects(scene, change):
    square = scene.primitives[0]
    fields = {
        "grown": {"positions": square.positions * np.float32(2)},
        "flipped": {"indices": square.indices[:, ::-1]},
        "unwrapped": {"texcoords": (square.texcoords[0] + np.float32(0.1),)},
        "painted": {"colors": np.full((3, 4), 0.5, np.float32)},
        "bent": {"normals": square.normals[:, [2, 1, 0]]},
    }[change]
    changes = difference(scene, with_primitive(scene, 0, **fields))
    assert changes.instances == Changes(changed=("left", "right"))


def test_pixels_of_a_texture_count(scene):
    pixels = scene.images[0].pixels.copy()
    pixels[1, 1, 2] += 1
    images = (replace(scene.images[0], name="new name", pixels=pixels),)
    assert difference(scene, replace(scene, images=images)).instances.changed == ("alone", "left", "right")


def test_material_counts(scene):
    rough = (replace(scene.materials[0], emission=(0.0, 0.0, 0.1)), *scene.materials[1:])
    assert difference(scene, replace(scene, materials=rough)).instances.changed == ("alone", "left", "right")


def test_lights_and_environment_count(scene):
    dimmed = (scene.lights[0], replace(scene.lights[1], intensity=(0.9, 1.0, 1.0)))
    assert difference(scene, replace(scene, lights=dimmed)).lights == Changes(changed=("bulb #2",))
    assert difference(scene, replace(scene, lights=scene.lights[:1])).lights == Changes(removed=("bulb #2",))
    changes = difference(scene, replace(scene, environment=environment_from_color((0.5, 0.5, 0.6))))
    assert changes.environment
    assert not changes.instances
    assert difference(scene, replace(scene, environment=None)).environment


def test_new_and_gone_objects_are_named(scene):
    fewer = replace(scene, instances=scene.instances[:2])
    assert difference(scene, fewer).instances == Changes(removed=("alone",))
    assert difference(fewer, scene).instances == Changes(added=("alone",))


def test_every_instance_has_a_name_of_its_own(named_scene):
    scene = named_scene(
        [("crate", "a"), ("crate", "a"), ("hedge", "a"), ("hedge", "a"), ("hall", "a"), ("hall", "b")]
    )
    hedge = [replace(scene.instances[2 + k], node_index=2, gpu_instance=k) for k in (0, 1)]
    hall = [replace(scene.instances[4 + k], node_index=4) for k in (0, 1)]
    parts = (scene.primitives[0], replace(scene.primitives[1], primitive_index=1))
    scene = replace(scene, primitives=parts, instances=(*scene.instances[:2], *hedge, *hall))
    assert instance_names(scene) == ["crate", "crate #2", "hedge[0]", "hedge[1]", "hall/0", "hall/1"]


def test_fingerprint_of_another_version_makes_everything_changed(scene):
    changes = compare_fingerprints({"version": 0}, fingerprint(scene))
    assert not changes.comparable
    assert changes.instances.changed == ("alone", "left", "right")
    assert changes.environment
