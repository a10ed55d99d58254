"""EXT_mesh_gpu_instancing written out as nodes, for loaders that can't place a lightmap by instance."""

from __future__ import annotations

from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import Json
from irradia.scene.types import Scene

GPU_INSTANCING = "EXT_mesh_gpu_instancing"
_PROPERTIES = (("TRANSLATION", "translation", 3), ("ROTATION", "rotation", 4), ("SCALE", "scale", 3))


def write_out_gpu_instances(json: Json, scene: Scene, accessors: Accessors) -> list[int]:
    """Gives every GPU instance a child node with the mesh, in ``json``, which is changed.

    The instanced node keeps its transform, children and animations. Instances without a size, which
    the scene leaves out, get no node.

    Returns:
        The node of each of the scene's instances.
    """
    node_of_instance = [instance.node_index for instance in scene.instances]
    children: dict[tuple[int, int], int] = {}
    for index, instance in enumerate(scene.instances):
        if instance.gpu_instance is None:
            continue
        key = (instance.node_index, instance.gpu_instance)
        if key not in children:
            children[key] = _add_child(json, *key, accessors)
        node_of_instance[index] = children[key]
    for node_index, _ in children:
        node = json["nodes"][node_index]
        node.pop("mesh", None)
        node.pop("weights", None)
        node.get("extensions", {}).pop(GPU_INSTANCING, None)
        if "extensions" in node and not node["extensions"]:
            del node["extensions"]
    return node_of_instance


def _add_child(json: Json, node_index: int, gpu_instance: int, accessors: Accessors) -> int:
    parent = json["nodes"][node_index]
    attributes = parent["extensions"][GPU_INSTANCING]["attributes"]
    child: Json = {
        "name": f"{parent.get('name', f'node {node_index}')} {gpu_instance}",
        "mesh": parent["mesh"],
    }
    if "weights" in parent:
        child["weights"] = parent["weights"]
    for attribute, name, n_components in _PROPERTIES:
        if attribute in attributes:
            values = accessors.read(attributes[attribute]).floats(n_components)
            child[name] = values[gpu_instance].tolist()
    json["nodes"].append(child)
    parent.setdefault("children", []).append(len(json["nodes"]) - 1)
    return len(json["nodes"]) - 1
