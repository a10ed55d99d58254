"""Scene facts: counts and measures, and light estimates against their formulas."""

from dataclasses import replace

import numpy as np
import pytest

from irradia.scene.builtin.mesh import Mesh
from irradia.scene.builtin.shapes import box, floor, sphere
from irradia.scene.environment import environment_from_color
from irradia.scene.info import SceneFacts, scene_facts
from irradia.scene.light_estimate import N_SAMPLES
from irradia.scene.merge import merge
from irradia.scene.surface import sample_surface
from irradia.scene.types import Image, Instance, Light, Material, Primitive, Scene, TextureRef

MATTE = Material("matte", metallic=0.0)


def _scene(*meshes: tuple[Mesh, Material], **more: object) -> Scene:
    primitives = tuple(_primitive(mesh, index) for index, (mesh, _) in enumerate(meshes))
    instances = tuple(Instance(index, np.eye(4), index) for index in range(len(meshes)))
    return replace(
        Scene("test", primitives, instances, tuple(material for _, material in meshes), ()), **more
    )


def _primitive(mesh: Mesh, material: int) -> Primitive:
    positions, normals = mesh.positions.astype(np.float32), mesh.normals.astype(np.float32)
    source = np.arange(len(positions), dtype=np.uint32)
    return Primitive(positions, normals, (), None, mesh.indices.astype(np.uint32), material, 0, 0, source)


def _contribution(facts: SceneFacts, name: str) -> np.ndarray:
    return next(np.array(s.mean_irradiance_rgb) for s in facts.sources if s.name == name)


def test_counts_and_measures_include_every_instance() -> None:
    scene = _scene((box((0, 0, 0), (1, 2, 3)), MATTE))
    moved = np.eye(4)
    moved[:3, 3] = [10, 0, 0]
    moved[:3, :3] *= 2.0
    facts = scene_facts(replace(scene, instances=(*scene.instances, Instance(0, moved, 1)), notes=("odd",)))
    assert (facts.n_primitives, facts.n_instances, facts.n_triangles, facts.n_vertices) == (1, 2, 24, 24)
    assert facts.bounds_min_m == (0.0, 0.0, 0.0)
    assert facts.bounds_max_m == (12.0, 4.0, 6.0)
    assert facts.surface_area_m2 == pytest.approx(22.0 * (1 + 4))
    assert facts.notes == ("odd",)


def test_materials_are_listed_by_what_they_do() -> None:
    kinds = [
        Material("leaf", alpha_mode="mask"),
        Material("veil", alpha_mode="blend", double_sided=True),
        Material("glass", transmission=1.0),
        Material("paper", diffuse_transmission=0.5),
        Material("lamp", emission=(0.0, 1.0, 0.0)),
        Material("", unlit=True),
    ]
    scene = _scene(*((floor(1, 1), material) for material in kinds))
    facts = scene_facts(replace(scene, materials=(*scene.materials, Material("unused", unlit=True))))
    assert facts.alpha_mask == ("leaf",)
    assert facts.alpha_blend == ("veil",)
    assert facts.double_sided == ("veil",)
    assert facts.transmissive == ("glass", "paper")
    assert facts.emissive == ("lamp",)
    assert facts.unlit == ("material 5",)


def test_sun_on_a_plane_gives_lux_times_cosine() -> None:
    direction = (0.0, -0.5, -(0.75**0.5))
    sun = Light("directional", (100.0, 200.0, 300.0), direction=direction, name="sun")
    facts = scene_facts(_scene((floor(2, 2), MATTE), lights=(sun,)))
    np.testing.assert_allclose(_contribution(facts, "sun"), [50.0, 100.0, 150.0], rtol=1e-6)


def test_sun_from_behind_gives_nothing() -> None:
    sun = Light("directional", (1.0, 1.0, 1.0), direction=(0.0, 1.0, 0.0), name="sun")
    facts = scene_facts(_scene((floor(2, 2), MATTE), lights=(sun,)))
    assert not _contribution(facts, "sun").any()
    assert facts.warnings == ("no light source reaches a surface: the bake would be black",)


def test_lamp_in_a_sphere_gives_candela_over_squared_radius() -> None:
    lamp = Light("point", (90.0, 90.0, 90.0), name="lamp")
    facts = scene_facts(_scene((sphere(3.0, 96, 48).inside_out(), MATTE), lights=(lamp,)))
    np.testing.assert_allclose(_contribution(facts, "lamp"), [10.0] * 3, rtol=5e-3)


def test_range_cuts_a_lamp_off() -> None:
    lamp = Light("point", (90.0, 90.0, 90.0), range_m=2.5, name="lamp")
    facts = scene_facts(_scene((sphere(3.0, 32, 16).inside_out(), MATTE), lights=(lamp,)))
    assert not _contribution(facts, "lamp").any()


def test_spot_lights_its_cone_only() -> None:
    """Inside a sphere around it a hard cone of half angle α reaches (1 − cos α) / 2 of the area."""
    cone = {"inner_cone_rad": 0.7999, "outer_cone_rad": 0.8}
    spot = Light("spot", (9.0, 9.0, 9.0), direction=(0.0, -1.0, 0.0), name="spot", **cone)
    facts = scene_facts(_scene((sphere(3.0, 96, 48).inside_out(), MATTE), lights=(spot,)))
    np.testing.assert_allclose(_contribution(facts, "spot"), [0.5 * (1 - np.cos(0.8))] * 3, rtol=0.03)


def test_lamp_on_a_surface_counts_as_if_at_a_hundredth_of_the_size() -> None:
    scene = _scene((floor(2, 2), MATTE))
    x, y, z = sample_surface(merge(scene), N_SAMPLES).positions[100]
    lamp = Light("point", (1.0, 1.0, 1.0), position=(x, y + 1e-5, z), name="lamp")
    facts = scene_facts(replace(scene, lights=(lamp,)))
    assert np.all(_contribution(facts, "lamp") < 10.0)


def test_emitter_spreads_its_power_over_all_surfaces() -> None:
    """Φ = π L A; a double-sided one gives twice that."""
    lamp = Material("lamp", emission=(2.0, 4.0, 6.0))
    single = scene_facts(_scene((floor(1, 1), lamp), (floor(3, 3, -1.0), MATTE)))
    double = scene_facts(_scene((floor(1, 1), replace(lamp, double_sided=True)), (floor(3, 3, -1.0), MATTE)))
    np.testing.assert_allclose(_contribution(single, "lamp"), np.pi * np.array([2, 4, 6]) / 10, rtol=1e-6)
    np.testing.assert_allclose(_contribution(double, "lamp"), 2 * _contribution(single, "lamp"))


def test_emission_texture_scales_by_its_linear_mean() -> None:
    pixels = np.zeros((2, 2, 4), np.uint8)
    pixels[0, :, :3] = [255, 188, 0]
    lamp = Material("lamp", emission=(1.0, 1.0, 1.0), emission_texture=TextureRef(0))
    facts = scene_facts(_scene((floor(1, 1), lamp), images=(Image("half", pixels),)))
    np.testing.assert_allclose(_contribution(facts, "lamp"), np.pi * np.array([0.5, 0.2514, 0.0]), rtol=1e-3)


def test_environment_gives_pi_times_its_mean_radiance() -> None:
    scene = _scene((floor(1, 1), MATTE), environment=environment_from_color((1.0, 2.0, 3.0)))
    facts = scene_facts(scene)
    np.testing.assert_allclose(
        _contribution(facts, "constant colour"), np.pi * np.array([1, 2, 3]), rtol=1e-6
    )
    assert facts.warnings == ()


def test_sources_come_strongest_first() -> None:
    lights = tuple(
        Light("directional", (x, x, x), direction=(0.0, -1.0, 0.0), name=str(x)) for x in (2.0, 9.0, 5.0)
    )
    facts = scene_facts(_scene((floor(1, 1), MATTE), lights=lights))
    assert [source.name for source in facts.sources] == ["9.0", "5.0", "2.0"]


@pytest.mark.parametrize(("lux", "warned"), [(0.9e4, False), (1.1e4, True)])
def test_contrast_over_ten_thousand_is_warned_of(lux: float, warned: bool) -> None:
    down = (0.0, -1.0, 0.0)
    lights = (
        Light("directional", (lux, lux, lux), direction=down, name="sun"),
        Light("directional", (1.0, 1.0, 1.0), direction=down, name="moon"),
        Light("directional", (0.0, 0.0, 0.0), direction=down, name="off"),
    )
    warnings = scene_facts(_scene((floor(1, 1), MATTE), lights=lights)).warnings
    assert any("'sun'" in text and "'moon'" in text for text in warnings) == warned


def test_empty_scene_has_facts_too() -> None:
    facts = scene_facts(Scene("empty", (), (), (), (), lights=(Light("point", (1.0, 1.0, 1.0)),)))
    assert (facts.n_triangles, facts.surface_area_m2, facts.sources) == (0, 0.0, ())
    assert facts.warnings
