"""Bakes one task with Blender Cycles. Runs inside the peer's environment: needs bpy and NumPy only.

    python cycles_bake.py TASK.npz RESULT.npz --samples 64 --threads 2 --seed 1

TASK.npz is what ``bench/support/bake_task.py`` writes: triangles in glTF's axes, materials as plain
colours, lights in photometric or radiometric units, all alike. RESULT.npz holds ``pages``
(P, H, W, 3), E/π with row 0 at the top, ``bake_s`` (the bake operator's wall time: Cycles' scene
sync, BVH, tracing, and the pages' read-back) and ``setup_s`` (importing bpy and building its scene).

Blender's bake of type DIFFUSE without colour divides the reflected light by the albedo, which leaves
E/π. The known answers of ``bench/support/known_answers.py`` hold all conversions here to account.
"""

from __future__ import annotations

import argparse
import math
import sys
import time

_START = time.perf_counter()

import bpy  # noqa: E402
import numpy as np  # noqa: E402
from cycles_materials import material, new_image  # noqa: E402

# Far above what reaches the eye: Russian roulette ends paths, not a bounce limit.
MAX_BOUNCES = 256

# glTF is +Y up, Blender +Z up: (x, y, z) becomes (x, −z, y).
_BLENDER_FROM_GLTF = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], np.float32)


def main() -> None:
    """Reads, builds, bakes, writes."""
    arguments = _parse()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with np.load(arguments.task) as file:
        task = {name: file[name] for name in file.files}
    pages = [_page(task, index) for index in range(int(task["n_pages"]))]
    _set_up_cycles(arguments)
    _add_mesh(task, pages)
    for index in range(len(task["light_kind"])):
        _add_light(task, index)
    _add_environment(task["environment"])
    setup_s = time.perf_counter() - _START

    start = time.perf_counter()
    bpy.ops.object.bake(
        type="DIFFUSE",
        pass_filter={"DIRECT", "INDIRECT"},
        target="IMAGE_TEXTURES",
        margin=0,
        use_clear=True,
        uv_layer="lightmap",
    )
    result = np.stack([_read_image(page) for page in pages])
    bake_s = time.perf_counter() - start
    np.savez(arguments.result, pages=result, bake_s=bake_s, setup_s=setup_s, version=bpy.app.version_string)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Bakes a task with Blender Cycles.")
    parser.add_argument("task")
    parser.add_argument("result")
    parser.add_argument("--samples", type=int, required=True)
    parser.add_argument("--threads", type=int, required=True)
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args(sys.argv[1:])


def _set_up_cycles(arguments: argparse.Namespace) -> None:
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode = "FIXED"
    scene.render.threads = arguments.threads
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = arguments.samples
    cycles.seed = arguments.seed
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    # Nothing that trades bias for speed: same answer first, then time.
    cycles.sample_clamp_direct = 0.0
    cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.use_fast_gi = False
    for kind in ("max", "diffuse", "transmission", "transparent_max"):
        setattr(cycles, f"{kind}_bounces", MAX_BOUNCES)
    scene.view_settings.view_transform = "Raw"


def _page(task: dict, index: int) -> bpy.types.Image:
    """A black float image that one page is baked to."""
    width, height = int(task["width_px"]), int(task["height_px"])
    return bpy.data.images.new(f"page {index}", width, height, float_buffer=True, is_data=True)


def _add_mesh(task: dict, pages: list[bpy.types.Image]) -> None:
    """All triangles as one selected object, a material slot for each material on each page."""
    corners = task["positions"].reshape(-1, 3) @ _BLENDER_FROM_GLTF.T
    n_corners = len(corners)
    mesh = bpy.data.meshes.new("scene")
    mesh.vertices.add(n_corners)
    mesh.vertices.foreach_set("co", corners.ravel())
    mesh.loops.add(n_corners)
    mesh.loops.foreach_set("vertex_index", np.arange(n_corners, dtype=np.int32))
    mesh.polygons.add(n_corners // 3)
    mesh.polygons.foreach_set("loop_start", np.arange(0, n_corners, 3, dtype=np.int32))
    for name in ("lightmap", "texture"):
        uv = task[f"{name}_uv"].reshape(-1, 2).copy()
        uv[:, 1] = 1.0 - uv[:, 1]  # Blender's origin is at the bottom
        mesh.uv_layers.new(name=name, do_init=False).uv.foreach_set("vector", uv.ravel())
    mesh.uv_layers.active = mesh.uv_layers["lightmap"]

    keys = np.stack([task["material"], task["page"]], axis=1)
    slots, slot_of_triangle = np.unique(keys, axis=0, return_inverse=True)
    for index, page in slots:
        mesh.materials.append(material(task, int(index), pages[page] if page >= 0 else None))
    mesh.polygons.foreach_set("material_index", slot_of_triangle.ravel().astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(n_corners // 3, bool))
    mesh.update()
    mesh.normals_split_custom_set(task["normals"].reshape(-1, 3) @ _BLENDER_FROM_GLTF.T)

    scene_object = bpy.data.objects.new("scene", mesh)
    bpy.context.collection.objects.link(scene_object)
    bpy.context.view_layer.objects.active = scene_object
    scene_object.select_set(True)


def _add_light(task: dict, index: int) -> None:
    """A punctual light: a sun's strength is its irradiance, as lux; a lamp's watts are 4π times candela."""
    kind = str(task["light_kind"][index])
    intensity = task["light_intensity"][index].astype(np.float64)
    strength = float(intensity.max())
    if strength <= 0.0:
        return
    light = bpy.data.lights.new(f"light {index}", {"directional": "SUN", "point": "POINT"}[kind])
    light.color = intensity / strength
    holder = bpy.data.objects.new(light.name, light)
    if kind == "directional":
        light.energy = strength
        light.angle = math.radians(float(task["light_angle_deg"][index]))
        holder.rotation_mode = "QUATERNION"
        direction = _BLENDER_FROM_GLTF @ task["light_direction"][index].astype(np.float32)
        holder.rotation_quaternion = _rotation_from_minus_z(direction)
    else:
        light.energy = strength * 4.0 * math.pi
        light.shadow_soft_size = 0.0
        holder.location = _BLENDER_FROM_GLTF @ task["light_position"][index].astype(np.float32)
    bpy.context.collection.objects.link(holder)


def _rotation_from_minus_z(direction: np.ndarray) -> tuple[float, float, float, float]:
    """Quaternion (w, x, y, z) that turns −Z, along which Blender's lights shine, to ``direction``."""
    x, y, z = (float(v) for v in direction / np.linalg.norm(direction))
    if z > 1.0 - 1e-9:
        return (0.0, 1.0, 0.0, 0.0)
    w = 1.0 - z
    length = math.sqrt(x * x + y * y + w * w)
    return (w / length, y / length, -x / length, 0.0)


def _add_environment(radiance: np.ndarray) -> None:
    """The equirectangular map, unfiltered as in Irradia; black where there is none.

    Blender's centre column looks along +X, Irradia's along −Z, which is Blender's +Y: a quarter turn.
    """
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    background = tree.nodes.new("ShaderNodeBackground")
    output = tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    background.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    if radiance.size == 0:
        return
    width = radiance.shape[1]
    if width % 4:
        raise SystemExit(f"an environment map's width must be a multiple of 4, found {width}")
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = new_image("environment", np.roll(radiance, -width // 4, axis=1))
    texture.interpolation = "Closest"
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = max(width, 4)


def _read_image(image: bpy.types.Image) -> np.ndarray:
    """(H, W, 3), row 0 at the top."""
    width, height = image.size
    rgba = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(rgba)
    return rgba.reshape(height, width, 4)[::-1, :, :3].copy()


if __name__ == "__main__":
    main()
