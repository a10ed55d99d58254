"""Textures, materials and visibility as the kernels see them."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.colour import linear_from_srgb
from irradia.scene.merge import merge
from irradia.scene.types import Image, Instance, Material, Primitive, Scene, TextureRef

pytestmark = pytest.mark.usefixtures("cpu_device")


def _noise(height=5, width=7) -> Image:
    return Image("noise", np.random.default_rng(4).integers(0, 256, (height, width, 4), np.uint8))


def _reference(image, uv, wraps, srgb):
    """Bilinear lookup, slowly."""
    rgba = image.pixels / 255.0
    rgb = linear_from_srgb(rgba[..., :3]) if srgb else rgba[..., :3]
    rgba = np.concatenate([rgb, rgba[..., 3:]], axis=-1)
    size = np.array(image.pixels.shape[1::-1])
    at = uv * size - 0.5
    base = np.floor(at).astype(int)
    total = np.zeros((len(uv), 4))
    for dx in (0, 1):
        for dy in (0, 1):
            index = [_wrapped(base[:, i] + d, size[i], wraps[i]) for i, d in ((0, dx), (1, dy))]
            share = [
                np.where(d, at[:, i] - base[:, i], 1 - at[:, i] + base[:, i]) for i, d in ((0, dx), (1, dy))
            ]
            total += rgba[index[1], index[0]] * (share[0] * share[1])[:, None]
    return total


def _wrapped(index, size, mode):
    if mode == "clamp":
        return np.clip(index, 0, size - 1)
    if mode == "repeat":
        return index % size
    period = index % (2 * size)
    return np.minimum(period, 2 * size - 1 - period)


@pytest.mark.parametrize("wraps", [("repeat", "clamp"), ("mirror", "repeat"), ("clamp", "mirror")])
@pytest.mark.parametrize("srgb", [True, False])
def test_texture_lookup_is_bilinear_and_wraps(wraps, srgb):
    from irradia.transport.backend import mi
    from irradia.transport.textures import TextureTable

    image = _noise()
    table = TextureTable((image,))
    slot = table.add(TextureRef(0, texcoord=1, wrap_s=wraps[0], wrap_t=wraps[1]))
    table.freeze()
    uv = np.random.default_rng(5).uniform(-2, 3, (500, 2)).astype(np.float32)
    unused = mi.Point2f(0.3, 0.3)
    got = table.sample(mi.UInt32(slot), unused, mi.Point2f(*uv.T), srgb=srgb, active=mi.Bool(True))
    rgba = np.concatenate([np.array(got.rgb), np.array(got.alpha)[None]]).T
    np.testing.assert_allclose(rgba, _reference(image, uv.astype(np.float64), wraps, srgb), atol=2e-4)


def _appearance(material: Material, images=()):
    from irradia.transport.backend import mi
    from irradia.transport.materials import MaterialTable
    from irradia.transport.textures import TextureTable

    textures = TextureTable(images)
    table = MaterialTable((material,), textures)
    textures.freeze()
    centre = mi.Point2f(0.5, 0.5)
    return table.appearance(mi.UInt32(0), centre, centre, mi.Vector4f(1.0), mi.Bool(True))


def _rgb(value) -> np.ndarray:
    return np.array(value).ravel()


def test_material_without_specular_reflects_its_base_colour():
    looks = _appearance(Material(base_color=(0.2, 0.5, 0.8, 1.0), metallic=0.0, specular=0.0))
    np.testing.assert_allclose(_rgb(looks.reflectance), [0.2, 0.5, 0.8], rtol=1e-6)
    assert not _rgb(looks.through).any()


def test_metal_still_bounces_light():
    looks = _appearance(Material(base_color=(0.9, 0.6, 0.3, 1.0), metallic=1.0))
    np.testing.assert_allclose(
        _rgb(looks.reflectance), np.array([0.9, 0.6, 0.3]) * 20 / 21 + 1 / 21, rtol=1e-5
    )


def test_reflectance_is_clamped():
    looks = _appearance(Material(base_color=(1.0, 1.0, 1.0, 1.0), metallic=0.0, specular=0.0))
    np.testing.assert_allclose(_rgb(looks.reflectance), 0.98, rtol=1e-6)


@pytest.mark.parametrize(("alpha", "coverage"), [(0.49, 0.0), (0.5, 1.0)])
def test_mask_is_all_or_nothing(alpha, coverage):
    looks = _appearance(Material(base_color=(1, 1, 1, alpha), metallic=0.0, alpha_mode="mask"))
    assert _rgb(looks.coverage)[0] == coverage
    np.testing.assert_allclose(_rgb(looks.through), 1.0 - coverage, atol=1e-6)


@pytest.mark.parametrize("transmission", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("alpha", [0.0, 0.3, 1.0])
def test_energy_is_never_created_at_a_surface(transmission, alpha):
    looks = _appearance(
        Material(
            base_color=(1.0, 0.9, 0.1, alpha), metallic=0.0, alpha_mode="blend", transmission=transmission
        )
    )
    assert (_rgb(looks.reflectance) + _rgb(looks.through) <= 1.0 + 1e-6).all()
    assert 0.0 <= _rgb(looks.pass_probability)[0] <= 1.0


def _sheets(materials: tuple[Material, ...], flips: tuple[bool, ...] | None = None, gap=0.1) -> Scene:
    """Unit squares one above the other, facing up, or down where flipped."""
    flips = flips or (False,) * len(materials)
    primitives = []
    for index, flip in enumerate(flips):
        y = index * gap
        corners = np.array([[0, y, 0], [0, y, 1], [1, y, 1], [1, y, 0]], np.float32)
        triangles = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
        normals = np.tile(np.float32([0, -1 if flip else 1, 0]), (4, 1))
        uv = corners[:, [0, 2]].copy()
        primitives.append(
            Primitive(
                corners,
                normals,
                (uv,),
                None,
                triangles[:, ::-1] if flip else triangles,
                index,
                index,
                0,
                np.arange(4, dtype=np.uint32),
            )
        )
    instances = tuple(Instance(i, np.eye(4), i) for i in range(len(primitives)))
    return Scene("sheets", tuple(primitives), instances, materials, ())


def test_light_passes_any_number_of_coloured_layers():
    from irradia.transport.backend import mi
    from irradia.transport.world import World

    tint = Material(base_color=(0.9, 0.5, 0.7, 1.0), metallic=0.0, specular=0.0, transmission=1.0)
    scene = _sheets((tint,) * 12)
    world = World(scene, merge(scene))
    arriving = world.transmittance(
        mi.Point3f(0.4, -1, 0.3), mi.Vector3f(0, 1, 0), mi.Float(1e30), mi.Bool(True)
    )
    np.testing.assert_allclose(_rgb(arriving), np.array([0.9, 0.5, 0.7]) ** 12, rtol=1e-4)


def test_among_coincident_triangles_the_front_wins():
    from irradia.transport.backend import mi
    from irradia.transport.world import World

    scene = _sheets((Material(name="up"), Material(name="down")), flips=(False, True), gap=0.0)
    world = World(scene, merge(scene))
    for y, direction, material in ((1.0, -1.0, 0), (-1.0, 1.0, 1)):
        origin = mi.Point3f(np.float32([0.2, 0.8]), y, np.float32([0.3, 0.6]))
        hit = world.geometry.intersect(origin, mi.Vector3f(0, direction, 0), mi.Bool(True))
        assert (np.array(world.geometry.vertices(hit.triangle, hit.valid).w) == material).all()
        there = np.array(world.point(hit.triangle, hit.bary, hit.valid).position)
        np.testing.assert_allclose(there[[0, 2]], [[0.2, 0.8], [0.3, 0.6]], atol=1e-6)


def test_among_equal_triangles_the_lowest_number_wins():
    from irradia.transport.backend import mi
    from irradia.transport.world import World

    scene = _sheets((Material(),) * 3, gap=0.0)
    world = World(scene, merge(scene))
    hit = world.geometry.intersect(mi.Point3f(0.3, 1, 0.4), mi.Vector3f(0, -1, 0), mi.Bool(True))
    assert np.array(world.geometry.vertices(hit.triangle, hit.valid).w)[0] == 0
