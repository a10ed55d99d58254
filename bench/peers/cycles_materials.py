"""A task's materials as Blender nodes. Runs inside the peer's environment, beside ``cycles_bake.py``.

With base colour b, alpha a (after the alpha mode) and transmission t:

    diffuse reflection   b · a · (1 − t)     of the front; of both sides where double-sided
    let through unbent   1 − a + b · a · t
    emission             of the front; of both sides where double-sided

As in Irradia the back of a single-sided surface blocks light and reflects none.
"""

from __future__ import annotations

import bpy
import numpy as np

OPAQUE, MASK = 0, 1


def material(task: dict, index: int, page: bpy.types.Image | None) -> bpy.types.Material:
    """The material, with the page as its bake target where it has one."""
    made = bpy.data.materials.new(f"material {index}")
    made.use_nodes = True
    made.node_tree.nodes.clear()
    nodes = _Nodes(made.node_tree)
    double_sided = bool(task["double_sided"][index])
    front = None if double_sided else nodes.one_minus(nodes.new("NewGeometry").outputs["Backfacing"])
    colour, alpha = _base(nodes, task, index)
    passing = float(task["transmission"][index])

    closures = []
    if task["base_color"][index].any() and passing < 1.0:
        reflected = nodes.scaled(colour, alpha, 1.0 - passing, front)
        closures.append(nodes.closure("BsdfDiffuse", Color=reflected))
    if passing > 0.0 or alpha is not None:
        let_through = nodes.scaled(colour, alpha, passing)
        if alpha is not None:
            let_through = nodes.math("ADD", let_through, nodes.one_minus(alpha), vector=True)
        closures.append(nodes.closure("BsdfTransparent", Color=let_through))
    if task["emission"][index].any():
        emitted = nodes.scaled(nodes.colour(task["emission"][index]), front)
        closures.append(nodes.closure("Emission", Color=emitted, Strength=1.0))
        made.cycles.emission_sampling = "FRONT_BACK" if double_sided else "FRONT"
    nodes.output(closures)
    if page is not None:
        target = nodes.new("TexImage")
        target.image = page
        made.node_tree.nodes.active = target  # where the bake goes
    return made


def _base(nodes: _Nodes, task: dict, index: int) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket | None]:
    """Base colour, and alpha after the alpha mode; None where the surface is opaque."""
    factor = task["base_color"][index]
    colour, alpha = nodes.colour(factor[:3]), nodes.value(factor[3])
    image = int(task["texture"][index])
    if image >= 0:
        texture = nodes.new("TexImage")
        texture.image = _texture(image, task[f"image_{image}"])
        texture.interpolation = "Closest" if task["nearest"][index] else "Linear"
        wrap = str(task["wrap"][index])
        texture.extension = {"repeat": "REPEAT", "clamp": "EXTEND", "mirror": "MIRROR"}[wrap]
        uv = nodes.new("UVMap")
        uv.uv_map = "texture"
        nodes.link(uv.outputs[0], texture.inputs["Vector"])
        colour = nodes.scaled(texture.outputs["Color"], colour)
        alpha = nodes.math("MULTIPLY", texture.outputs["Alpha"], alpha)
    mode = int(task["alpha_mode"][index])
    if mode == OPAQUE:
        return colour, None
    if mode == MASK:
        below = nodes.math("LESS_THAN", alpha, nodes.value(task["alpha_cutoff"][index]))
        return colour, nodes.one_minus(below)
    return colour, alpha


class _Nodes:
    """Short names for making and linking nodes."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self._tree = tree
        self.link = tree.links.new

    def new(self, kind: str) -> bpy.types.Node:
        return self._tree.nodes.new(f"ShaderNode{kind}")

    def colour(self, rgb: np.ndarray) -> bpy.types.NodeSocket:
        """A constant, of any magnitude."""
        node = self.new("CombineXYZ")
        for channel in range(3):
            node.inputs[channel].default_value = float(rgb[channel])
        return node.outputs[0]

    def value(self, number: float) -> bpy.types.NodeSocket:
        node = self.new("Value")
        node.outputs[0].default_value = float(number)
        return node.outputs[0]

    def math(
        self, operation: str, a: bpy.types.NodeSocket, b: bpy.types.NodeSocket, *, vector: bool = False
    ) -> bpy.types.NodeSocket:
        node = self.new("VectorMath" if vector else "Math")
        node.operation = operation
        self.link(a, node.inputs[0])
        self.link(b, node.inputs[1])
        return node.outputs[0]

    def one_minus(self, x: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        return self.math("SUBTRACT", self.value(1.0), x)

    def scaled(
        self, colour: bpy.types.NodeSocket, *factors: bpy.types.NodeSocket | float | None
    ) -> bpy.types.NodeSocket:
        """The colour times sockets and numbers; None and 1 are left out."""
        for factor in factors:
            if factor is None or (isinstance(factor, float) and factor == 1.0):
                continue
            socket = self.value(factor) if isinstance(factor, float) else factor
            colour = self.math("MULTIPLY", colour, socket, vector=True)
        return colour

    def closure(self, kind: str, **inputs: bpy.types.NodeSocket | float) -> bpy.types.NodeSocket:
        node = self.new(kind)
        for name, value in inputs.items():
            if isinstance(value, float):
                node.inputs[name].default_value = value
            else:
                self.link(value, node.inputs[name])
        return node.outputs[0]

    def output(self, closures: list[bpy.types.NodeSocket]) -> None:
        """Adds all closures up."""
        while len(closures) > 1:
            add = self.new("AddShader")
            self.link(closures.pop(), add.inputs[0])
            self.link(closures.pop(), add.inputs[1])
            closures.append(add.outputs[0])
        surface = self.new("OutputMaterial").inputs["Surface"]
        for closure in closures:
            self.link(closure, surface)


def new_image(name: str, linear: np.ndarray) -> bpy.types.Image:
    """A float image from (H, W, 3 or 4) linear values, row 0 at the top; alpha is data."""
    height, width, channels = linear.shape
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :channels] = linear[::-1]
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=True, is_data=True)
    image.alpha_mode = "CHANNEL_PACKED"
    image.pixels.foreach_set(rgba.ravel())
    image.update()
    image.pack()
    return image


def _texture(index: int, coded: np.ndarray) -> bpy.types.Image:
    """Decoded before it is filtered, as in Irradia."""
    name = f"image {index}"
    if name in bpy.data.images:
        return bpy.data.images[name]
    values = coded.astype(np.float32) / 255.0
    rgb = values[..., :3]
    values[..., :3] = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return new_image(name, values)
