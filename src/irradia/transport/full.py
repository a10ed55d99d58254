"""Images with full materials, by Mitsuba's own scene, BSDFs and path integrator.

Shown beside a bake and never scored against it: a lightmap holds diffuse transport, and what glass
and gloss add to a picture is not its error. Also a second opinion on our own integrator.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.core import Progress, Seed
from irradia.scene.light_profile import mean_candela
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.types import Camera, Environment, Light, Material, Scene, TextureRef
from irradia.transport.backend import mi

if TYPE_CHECKING:
    from irradia.transport.render import RenderOptions

_SAMPLES_PER_PASS = 8
_DEPTH = 16


def render_full(
    scene: Scene, camera: Camera, options: RenderOptions, progress: Progress
) -> NDArray[np.float32]:
    """Renders with metallic-roughness materials; (height, width, 3) linear radiance."""
    with progress.stage("scene with full materials"):
        world = mi.load_dict(_scene_dict(scene))
        sensor = _sensor(camera, options)
        integrator = mi.load_dict({"type": "path", "max_depth": _DEPTH})
    n_pixels = options.width * options.height
    total = np.zeros((options.height, options.width, 3), np.float64)
    count = 0
    with progress.stage("render full materials", options.spp * n_pixels, "samples") as stage:
        while count < options.spp:
            n = min(_SAMPLES_PER_PASS, options.spp - count)
            seed = Seed(options.seed).child(f"full-{count}").uint32()
            image = mi.render(world, sensor=sensor, integrator=integrator, spp=n, seed=seed)
            total += np.array(image)[..., :3] * n
            count += n
            stage.advance(n * n_pixels)
    return (total / count).astype(np.float32)


def _sensor(camera: Camera, options: RenderOptions) -> Any:
    turn = mi.ScalarTransform4f().scale([-1, 1, -1])  # Mitsuba looks along +Z with x to the left
    film = {
        "type": "hdrfilm",
        "width": options.width,
        "height": options.height,
        "pixel_format": "rgb",
        "rfilter": {"type": "box"},
    }
    return mi.load_dict(
        {
            "type": "perspective",
            "fov": math.degrees(camera.yfov_rad),
            "fov_axis": "y",
            "near_clip": 1e-3,
            "far_clip": 1e6,
            "to_world": mi.ScalarTransform4f(camera.world_from_camera) @ turn,
            "film": film,
            "sampler": {"type": "independent"},
        }
    )


def _scene_dict(scene: Scene) -> dict[str, Any]:
    finest = tuple(instance for instance in scene.instances if instance.lod_level == 0)
    mesh = merge(replace(scene, instances=finest))
    result: dict[str, Any] = {"type": "scene"}
    for index, material in enumerate(scene.materials):
        chosen = np.flatnonzero(mesh.material == index)
        if len(chosen):
            result[f"mesh{index}"] = _mesh(mesh, chosen, material, scene)
    for index, light in enumerate(scene.lights):
        if light.mode != "off":
            result[f"light{index}"] = _light(light)
    if scene.environment is not None:
        result["environment"] = _environment(scene.environment)
    return result


def _mesh(mesh: MergedMesh, triangles: NDArray[np.intp], material: Material, scene: Scene) -> Any:
    """All triangles of one material."""
    used, faces = np.unique(mesh.indices[triangles], return_inverse=True)
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(_bsdf(material, scene))
    if max(material.emission) > 0.0:
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": _emission(material, scene)})
    result = mi.Mesh(
        material.name or "mesh",
        len(used),
        len(triangles),
        has_vertex_normals=True,
        has_vertex_texcoords=True,
        props=properties,
    )
    params = mi.traverse(result)
    texcoord = material.base_color_texture.texcoord if material.base_color_texture else 0
    uv = mesh.texcoords[used, min(texcoord, 1)]
    params["vertex_positions"] = mi.Float(mesh.positions[used].ravel())
    params["vertex_normals"] = mi.Float(mesh.normals[used].ravel())
    params["vertex_texcoords"] = mi.Float(np.ascontiguousarray(uv).ravel())
    params["faces"] = mi.UInt32(faces.astype(np.uint32).ravel())
    params.update()
    return result


def _bsdf(material: Material, scene: Scene) -> dict[str, Any]:
    """Principled, wrapped for normal map, both sides, and alpha or transmission as a mask."""
    if material.unlit:
        return {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
    bsdf = _reflection(material, scene)
    if material.normal_texture is not None:
        bitmap = _bitmap(scene, material.normal_texture, None, raw=True)
        bsdf = {"type": "normalmap", "normalmap": bitmap, "nested": bsdf}
    bsdf = {"type": "twosided", "nested": bsdf}
    opacity = _opacity(material, scene)
    return bsdf if opacity is None else {"type": "mask", "opacity": opacity, "nested": bsdf}


def _reflection(material: Material, scene: Scene) -> dict[str, Any]:
    """Lambert's law where the material says so, else Disney's principled one."""
    colour = _colour(material.base_color[:3], material.base_color_texture, scene)
    if material.specular == 0.0 and material.metallic == 0.0:
        return {"type": "diffuse", "reflectance": colour}
    return {
        "type": "principled",
        "base_color": colour,
        "metallic": _factor(material.metallic, material.metallic_roughness_texture, 2, scene),
        "roughness": _factor(material.roughness, material.metallic_roughness_texture, 1, scene),
        "specular": min(material.specular * 0.5, 1.0),
    }


def _opacity(material: Material, scene: Scene) -> Any:
    if material.alpha_mode == "opaque" and material.transmission == 0.0:
        return None
    stays = 1.0 - material.transmission
    if material.alpha_mode == "opaque":
        return max(stays, 0.05)
    texture = material.base_color_texture
    if texture is None:
        return material.base_color[3] * stays
    alpha = scene.images[texture.image].pixels[..., 3] / np.float32(255) * material.base_color[3]
    if material.alpha_mode == "mask":
        alpha = (alpha >= material.alpha_cutoff).astype(np.float32)
    return _bitmap(scene, texture, (alpha * stays)[..., None], raw=True)


def _colour(factor: tuple[float, ...], texture: TextureRef | None, scene: Scene) -> dict[str, Any]:
    if texture is None:
        return {"type": "rgb", "value": list(factor)}
    from irradia.core.colour import linear_from_srgb

    linear = linear_from_srgb(scene.images[texture.image].pixels[..., :3] / np.float32(255))
    return _bitmap(scene, texture, np.clip(linear * np.asarray(factor), 0.0, 1.0), raw=True)


def _emission(material: Material, scene: Scene) -> dict[str, Any]:
    if material.emission_texture is None:
        return {"type": "rgb", "value": list(material.emission)}
    from irradia.core.colour import linear_from_srgb

    linear = linear_from_srgb(scene.images[material.emission_texture.image].pixels[..., :3] / np.float32(255))
    return _bitmap(scene, material.emission_texture, linear * np.asarray(material.emission), raw=True)


def _factor(value: float, texture: TextureRef | None, channel: int, scene: Scene) -> Any:
    if texture is None:
        return value
    pixels = scene.images[texture.image].pixels[..., channel : channel + 1] / np.float32(255)
    return _bitmap(scene, texture, pixels * value, raw=True)


def _bitmap(scene: Scene, texture: TextureRef, pixels: NDArray | None, *, raw: bool) -> dict[str, Any]:
    """A texture; ``pixels`` stand in for the image's own where factors were multiplied in."""
    if pixels is None:
        pixels = scene.images[texture.image].pixels[..., :3] / np.float32(255)
    (a, b, c), (d, e, f) = texture.uv_from_texcoord
    matrix = [[a, b, c], [d, e, f], [0.0, 0.0, 1.0]]
    return {
        "type": "bitmap",
        "bitmap": mi.Bitmap(np.ascontiguousarray(pixels, np.float32)),
        "raw": raw,
        "filter_type": "nearest" if texture.nearest else "bilinear",
        "wrap_mode": texture.wrap_s,
        "to_uv": mi.ScalarTransform3f(matrix),
    }


def _light(light: Light) -> dict[str, Any]:
    """A light without size; a measured one shines evenly with the mean of its candela."""
    strength = 1.0 if light.profile is None else mean_candela(light.profile)
    intensity = {"type": "rgb", "value": [strength * channel for channel in light.intensity]}
    if light.kind == "directional":
        return {"type": "directional", "direction": list(light.direction), "irradiance": intensity}
    if light.kind == "point" or light.profile is not None:
        return {"type": "point", "position": list(light.position), "intensity": intensity}
    target = [p + d for p, d in zip(light.position, light.direction, strict=True)]
    up = [0.0, 1.0, 0.0] if abs(light.direction[1]) < 0.99 else [1.0, 0.0, 0.0]
    return {
        "type": "spot",
        "to_world": mi.ScalarTransform4f().look_at(origin=list(light.position), target=target, up=up),
        "intensity": intensity,
        "cutoff_angle": math.degrees(light.outer_cone_rad),
        "beam_width": math.degrees(light.inner_cone_rad),
    }


def _environment(environment: Environment) -> dict[str, Any]:
    """Our map is centred on −Z, Mitsuba's begins there."""
    pixels = np.roll(environment.radiance, environment.radiance.shape[1] // 2, axis=1)
    return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(pixels, np.float32))}
