"""A bake as plain arrays that any lightmapper can be given: the hand-over to a benchmark's peer."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.types import Image, Light, Material, Scene, TextureRef


def matte_twin(scene: Scene) -> Scene:
    """The scene with all specular taken away, so that a diffuse BSDF says the same everywhere.

    Base colour and its texture, emission, constant transmission and alpha stay.
    """
    return replace(scene, materials=tuple(_matte(material) for material in scene.materials))


def _matte(material: Material) -> Material:
    return replace(
        material,
        metallic=0.0,
        metallic_roughness_texture=None,
        specular=0.0,
        specular_texture=None,
        specular_color_texture=None,
        normal_texture=None,
        diffuse_transmission=0.0,
    )


def write_task(path: Path, scene: Scene, layout: LightmapLayout) -> None:
    """Writes a matte scene and its lightmap layout as .npz, per-corner arrays in world space.

    ======================  =====================================================================
    positions, normals      (T, 3, 3) triangle, corner, xyz
    lightmap_uv             (T, 3, 2) page uv, origin top left
    texture_uv              (T, 3, 2) with the material's texture transform applied
    material, page          (T,)
    base_color              (M, 4) factor on the texture
    alpha_mode, _cutoff     (M,) 0 opaque, 1 mask, 2 blend
    transmission            (M,) share of light that passes unbent, tinted by the base colour
    emission                (M, 3) radiance of the front, of both sides where double_sided
    double_sided, nearest   (M,)
    texture, wrap           (M,) index of image_K or −1; repeat, clamp or mirror
    image_K                 (H, W, 4) uint8, sRGB
    light_*                 (L, …) kind, intensity, position, direction, angle_deg
    environment             (H, W, 3), or empty
    n_pages, …_px           page count and size
    ======================  =====================================================================

    Raises:
        InputError: The scene has what a task can't say, such as vertex colours or spot lights.
    """
    mesh = merge(scene, layout)
    _check(scene, mesh)
    arrays = _mesh_arrays(scene, mesh) | _material_arrays(scene) | _light_arrays(scene.lights)
    environment = scene.environment
    arrays["environment"] = np.zeros((0, 0, 3), np.float32) if environment is None else environment.radiance
    arrays["n_pages"] = np.array(layout.n_pages)
    arrays["width_px"], arrays["height_px"] = np.array(layout.width_px), np.array(layout.height_px)
    np.savez(path, **arrays)


def _mesh_arrays(scene: Scene, mesh: MergedMesh) -> dict[str, np.ndarray]:
    texture_uv = np.zeros((len(mesh.indices), 3, 2), np.float32)
    for index, material in enumerate(scene.materials):
        texture = material.base_color_texture
        chosen = mesh.material == index
        if texture is not None:
            texture_uv[chosen] = _transform(texture, mesh.texcoords[mesh.indices[chosen], texture.texcoord])
    return {
        "positions": mesh.positions[mesh.indices],
        "normals": mesh.normals[mesh.indices],
        "lightmap_uv": mesh.lightmap_uv[mesh.indices],
        "texture_uv": texture_uv,
        "material": mesh.material.astype(np.int32),
        "page": mesh.page,
    }


def _transform(texture: TextureRef, uv: np.ndarray) -> np.ndarray:
    matrix = np.array(texture.uv_from_texcoord)
    return uv @ matrix[:, :2].T + matrix[:, 2]


def _material_arrays(scene: Scene) -> dict[str, np.ndarray]:
    materials = scene.materials
    textures = [m.base_color_texture for m in materials]
    arrays = {
        # What is unlit reflects nothing.
        "base_color": np.array([(0, 0, 0, 1) if m.unlit else m.base_color for m in materials], np.float32),
        "alpha_mode": np.array([("opaque", "mask", "blend").index(m.alpha_mode) for m in materials]),
        "alpha_cutoff": np.array([m.alpha_cutoff for m in materials]),
        "transmission": np.array([m.transmission for m in materials]),
        "emission": np.array([m.emission for m in materials]),
        "double_sided": np.array([m.double_sided for m in materials]),
        "texture": np.array([-1 if t is None else t.image for t in textures]),
        "nearest": np.array([t is not None and t.nearest for t in textures]),
        "wrap": np.array(["repeat" if t is None else t.wrap_s for t in textures]),
    }
    for index in {t.image for t in textures if t is not None}:
        image: Image = scene.images[index]
        arrays[f"image_{index}"] = image.pixels
    return arrays


def _light_arrays(lights: tuple[Light, ...]) -> dict[str, np.ndarray]:
    return {
        "light_kind": np.array([light.kind for light in lights], dtype="U16"),
        "light_intensity": np.array([light.intensity for light in lights]).reshape(-1, 3),
        "light_position": np.array([light.position for light in lights]).reshape(-1, 3),
        "light_direction": np.array([light.direction for light in lights]).reshape(-1, 3),
        "light_angle_deg": np.array([light.angle_deg for light in lights]),
    }


def _check(scene: Scene, mesh: MergedMesh) -> None:
    """A peer that is given less than we bake would be given less work, or other results."""
    for index, material in enumerate(scene.materials):
        texture = material.base_color_texture
        refused = {
            "specular or metal": material.specular > 0.0 or material.metallic > 0.0,
            "a transmission texture": material.transmission_texture is not None,
            "an emission texture": material.emission_texture is not None,
            "two wrap modes": texture is not None and texture.wrap_s != texture.wrap_t,
        }
        _refuse(refused, f"/materials/{index}")
    for index, light in enumerate(scene.lights):
        _refuse({"a spot": light.kind == "spot", "a range": light.range_m is not None}, f"light {index}")
    _refuse({"vertex colours": bool((mesh.colors[:, :3] != 1.0).any())}, scene.name)


def _refuse(reasons: dict[str, bool], where: str) -> None:
    for what, found in reasons.items():
        if found:
            raise InputError(f"the peer can't be given {what}", where=where)
