"""A small scene for the plugin of three.js: cubes that share a mesh, a pane of glass, four lights."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irradia.core.rng import Seed
from irradia.export.glb import Companions, write_baked_glb
from irradia.export.shadow_mask_extension import BakedShadows
from irradia.field.native_fields import decode_field, encode_field
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.shapes import centred_box, face, floor
from irradia.scene.gltf import document_to_scene
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera, Light, LightMode, Material, Scene

from .made_light import FIELDS, N_PAGES, PAGE_PX, bounds, made_field, made_grid, made_layout, made_pages

CUBES_M = ((-0.8, 0.25, 0.0), (0.0, 0.25, -0.6), (0.8, 0.25, 0.0))
TORCHES_M = {"point": (-1.0, 1.0, 0.5), "spot": (1.0, 1.5, 0.5), "directional": (0.3, 1.0, 0.6)}
MASK_CHANNELS, MASK_SHARES = (3, 0, 1), (0.2, 0.8)  # channels by torch, shares by page
VALIDITIES = ((0, 255), (1, 128))  # codes by page
PANE_M = np.array([(0.4, 0.0, 0.5), (1.0, 0.0, 0.5), (1.0, 0.5, 0.5), (0.4, 0.5, 0.5)])


def write_court(
    path: Path,
    *,
    instanced: bool = False,
    torch: LightMode = "baked",
    direct: bool = False,
    sun: LightMode | None = None,
) -> None:
    """The court in light that was made up, with a field of indirect light and probes.

    Args:
        path: The .glb.
        instanced: The cubes come by EXT_mesh_gpu_instancing, not as nodes; nothing else differs.
        torch: Mode of its lights but for the first, which is baked.
        direct: With a map of direct light.
        sun: Mode of a light without a node, as the sky's; None is no sun.
    """
    scene = court(instanced, torch)
    if sun is not None:
        scene = replace(scene, lights=(*scene.lights, Light("directional", (1.0, 1.0, 1.0), mode=sun)))
    field = decode_field(made_field(FIELDS["identity"], bounds(scene))).field
    indirect = replace(field, frame=replace(field.frame, quantity="indirect"))
    masked = BakedShadows(made_mask(), (None, *MASK_CHANNELS)) if torch == "mixed" else None
    companions = Companions(
        shadows=masked,
        direct=made_pages(Seed(6), 0.2, 0.6) if direct else None,
        probes=made_grid(*bounds(scene)),
        field=encode_field(indirect),
        validity=made_validity(),
    )
    write_baked_glb(path, scene, made_layout(scene), made_pages(Seed(4), 0.5, 1.5), companions)


def made_mask() -> NDArray[np.float32]:
    """(P, H, W, 4) shares of light: of every torch the page's own, of nobody else any."""
    pages = np.zeros((N_PAGES, PAGE_PX, PAGE_PX, 4), np.float32)
    pages[..., MASK_CHANNELS] = np.reshape(MASK_SHARES, (N_PAGES, 1, 1, 1))
    return pages


def made_validity() -> NDArray[np.uint8]:
    """(P, H, W) codes that change from texel to texel, each page with two of its own."""
    rng = Seed(8).numpy()
    choices = rng.integers(0, 2, (N_PAGES, PAGE_PX, PAGE_PX))
    return np.stack([np.take(np.uint8(codes), page) for codes, page in zip(VALIDITIES, choices, strict=True)])


def court(instanced: bool, torch: LightMode) -> Scene:
    """A matte floor, three glossy cubes, a pane in front of one of them."""
    builder = SceneBuilder("court")
    glossy = builder.material(Material("glossy", (0.6, 0.3, 0.2, 1.0), metallic=0.0, roughness=0.4))
    glass = Material("glass", (0.2, 0.9, 0.2, 0.3), metallic=0.0, alpha_mode="blend")
    builder.object(
        "floor", (floor(3, 3), builder.material(matte("white", (0.8, 0.8, 0.8), double_sided=True)))
    )
    builder.object("pane", (face(PANE_M), builder.material(glass)))
    cube = builder.mesh("cube", (centred_box((0.5, 0.5, 0.5)), glossy))
    if instanced:
        builder.node("cubes", mesh=cube)
    else:
        for i, place in enumerate(CUBES_M):
            builder.node(f"cube {i}", mesh=cube, translation=place)
    builder.light(Light("point", (4.0, 3.0, 2.0), position=(0.0, 1.5, 0.5), name="lamp"))
    for kind, place in TORCHES_M.items():
        towards = tuple(-x for x in place)
        light = Light(kind, (1.0, 2.0, 3.0), position=place, direction=towards, name=kind, mode=torch)
        builder.light(replace(light, inner_cone_rad=0.3, outer_cone_rad=0.5) if kind == "spot" else light)
    builder.camera(Camera(look_at((0.0, 1.6, 2.4), (0.0, 0.2, 0.0)), yfov_rad=0.9, name="camera"))
    builder.environment_color((0.0, 0.0, 0.0))
    document = builder.build()
    return document_to_scene(in_instances(document) if instanced else document)


def in_instances(document: GltfDocument) -> GltfDocument:
    """Its node "cubes" with an instance at each place."""
    json, binary = dict(document.json), document.buffers[0]
    places = np.array(CUBES_M, "<f4").tobytes()
    view = {"buffer": 0, "byteOffset": len(binary), "byteLength": len(places)}
    accessor = {"bufferView": len(json["bufferViews"]), "componentType": 5126, "count": 3, "type": "VEC3"}
    instancing = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": len(json["accessors"])}}}
    nodes = [
        {**node, "extensions": instancing} if node["name"] == "cubes" else node for node in json["nodes"]
    ]
    json.update(
        nodes=nodes,
        bufferViews=[*json["bufferViews"], view],
        accessors=[*json["accessors"], accessor],
        buffers=[{"byteLength": len(binary) + len(places)}],
        extensionsUsed=[*json["extensionsUsed"], *instancing],
    )
    return replace(document, json=json, buffers=(binary + places,))
