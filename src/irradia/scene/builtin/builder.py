"""Makes glTF documents in memory, so that our scenes travel the same road as a user's file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from irradia.scene.builtin.material_json import material_json
from irradia.scene.builtin.mesh import Mesh
from irradia.scene.builtin.png import encode_png
from irradia.scene.gltf.document import GltfDocument, Json
from irradia.scene.types import U8, Camera, Light, Material, Rgb, TextureRef

_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963
_FLOAT, _UNSIGNED_SHORT, _UNSIGNED_INT = 5126, 5123, 5125


class SceneBuilder:
    """Collects meshes, materials, lights and cameras and writes them as one glTF document.

    Materials, lights and cameras are given as the types that the importer returns. Calls return
    the glTF index of what they added; the same calls in the same order give the same bytes.

    Args:
        name: The document's name.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._json: Json = {
            "asset": {"version": "2.0", "generator": "Irradia"},
            "scene": 0,
            "scenes": [{"name": name, "nodes": []}],
        }
        self._buffer = bytearray()
        self._images: list[bytes] = []
        self._tile_m: list[float] = []
        self._extensions: set[str] = set()
        self._settings: Json = {}

    def texture(self, name: str, pixels: U8, *, texcoord: int = 0) -> TextureRef:
        """Adds an image, (H, W, 3) or (H, W, 4) as stored, that repeats in both directions."""
        encoded = encode_png(pixels)
        view = self._add_view(encoded)
        image = self._append("images", {"name": name, "mimeType": "image/png", "bufferView": view})
        self._images.append(encoded)
        if "samplers" not in self._json:
            self._json["samplers"] = [{"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}]
        self._append("textures", {"name": name, "source": image, "sampler": 0})
        return TextureRef(image=image, texcoord=texcoord)

    def material(self, material: Material, *, tile_m: float = 1.0) -> int:
        """Adds a material whose textures span ``tile_m`` metres of surface."""
        written = material_json(material)
        self._extensions.update(written.get("extensions", {}))
        self._tile_m.append(tile_m)
        return self._append("materials", written)

    def mesh(self, name: str, *parts: tuple[Mesh, int]) -> int:
        """Adds a mesh with one primitive for each (mesh, material index)."""
        primitives = [self._primitive(mesh, material) for mesh, material in parts]
        return self._append("meshes", {"name": name, "primitives": primitives})

    def node(
        self,
        name: str,
        *,
        mesh: int | None = None,
        translation: Sequence[float] = (0.0, 0.0, 0.0),
        yaw_deg: float = 0.0,
        scale: float | Sequence[float] = 1.0,
        lightmap_scale: float = 1.0,
    ) -> int:
        """Adds a root node: scaled, then turned about +Y, then moved."""
        node: Json = {"name": name}
        if mesh is not None:
            node["mesh"] = mesh
        if any(translation):
            node["translation"] = [_number(x) for x in translation]
        if yaw_deg:
            half = math.radians(yaw_deg) / 2
            node["rotation"] = [0.0, _number(math.sin(half)), 0.0, _number(math.cos(half))]
        if scale != 1.0:
            node["scale"] = [_number(x) for x in np.broadcast_to(scale, 3)]
        if lightmap_scale != 1.0:
            node["extras"] = {"irradia": {"lightmapScale": lightmap_scale}}
        return self._add_root(node)

    def object(self, name: str, *parts: tuple[Mesh, int], lightmap_scale: float = 1.0) -> int:
        """Adds a mesh and one node that shows it where it was modelled."""
        return self.node(name, mesh=self.mesh(name, *parts), lightmap_scale=lightmap_scale)

    def light(self, light: Light) -> int:
        """Adds a punctual light and its node; what glTF has no word for goes to ``extras.irradia``."""
        self._extensions.add("KHR_lights_punctual")
        strength = max(light.intensity)
        written: Json = {
            "name": light.name,
            "type": light.kind,
            "color": [_number(c / strength) for c in light.intensity] if strength else [1.0, 1.0, 1.0],
            "intensity": _number(strength),
        }
        if light.range_m is not None:
            written["range"] = light.range_m
        if light.kind == "spot":
            written["spot"] = {
                "innerConeAngle": _number(light.inner_cone_rad),
                "outerConeAngle": _number(light.outer_cone_rad),
            }
        settings = {
            "angleDeg": light.angle_deg or None,
            "radius": light.radius_m or None,
            "mode": light.mode if light.mode != "baked" else None,
        }
        if any(settings.values()):
            written["extras"] = {"irradia": {k: v for k, v in settings.items() if v is not None}}
        lights = self._json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})
        lights["lights"].append(written)
        node: Json = {
            "name": light.name,
            "extensions": {"KHR_lights_punctual": {"light": len(lights["lights"]) - 1}},
        }
        if any(light.position):
            node["translation"] = [_number(x) for x in light.position]
        if light.kind != "point":
            node["rotation"] = [_number(x) for x in _rotation_from_minus_z(light.direction)]
        return self._add_root(node)

    def camera(self, camera: Camera) -> int:
        """Adds a camera and its node."""
        index = self._append(
            "cameras",
            {
                "name": camera.name,
                "type": "perspective",
                "perspective": {
                    "yfov": _number(camera.yfov_rad),
                    "aspectRatio": _number(camera.aspect),
                    "znear": 0.01,
                },
            },
        )
        matrix = [_number(x) for x in np.asarray(camera.world_from_camera).T.ravel()]
        return self._add_root({"name": camera.name, "camera": index, "matrix": matrix})

    def sky(self, *, sun_elevation_deg: float, sun_azimuth_deg: float, turbidity: float, sun: bool) -> None:
        """Asks for a sky; see the package's docstring for the schema."""
        self._settings["sky"] = {
            "sunElevationDeg": sun_elevation_deg,
            "sunAzimuthDeg": sun_azimuth_deg,
            "turbidity": turbidity,
            "sun": sun,
        }

    def environment_color(self, radiance: Rgb) -> None:
        """Asks for a constant environment, linear radiance; black where a scene wants no sky."""
        self._settings["environmentColor"] = list(radiance)

    def build(self) -> GltfDocument:
        """The document; the builder is spent afterwards."""
        json = self._json
        json["extras"] = {"irradia": self._settings}
        if self._extensions:
            json["extensionsUsed"] = sorted(self._extensions)
        json["buffers"] = [{"byteLength": len(self._buffer)}]
        return GltfDocument(json, (bytes(self._buffer),), tuple(self._images), name=self._name)

    def _primitive(self, mesh: Mesh, material: int) -> Json:
        uv = mesh.uv / self._tile_m[material]
        # Whole repeats taken off keep float32 uv precise and the numbers near the unit square.
        uv = uv - np.floor(uv.min(axis=0) + 1e-6)
        index_type: type = np.uint16 if len(mesh.positions) <= 0xFFFF else np.uint32
        return {
            "attributes": {
                "POSITION": self._add_accessor(mesh.positions, "VEC3", bounds=True),
                "NORMAL": self._add_accessor(mesh.normals, "VEC3"),
                "TEXCOORD_0": self._add_accessor(uv, "VEC2"),
            },
            "indices": self._add_accessor(
                mesh.indices.astype(index_type).ravel(), "SCALAR", target=_ELEMENT_ARRAY_BUFFER
            ),
            "material": material,
        }

    def _add_accessor(
        self,
        values: NDArray,
        kind: Literal["SCALAR", "VEC2", "VEC3"],
        *,
        bounds: bool = False,
        target: int = _ARRAY_BUFFER,
    ) -> int:
        data = values if target == _ELEMENT_ARRAY_BUFFER else np.asarray(values, np.float32)
        component = {"f4": _FLOAT, "u2": _UNSIGNED_SHORT, "u4": _UNSIGNED_INT}[data.dtype.str[1:]]
        accessor: Json = {
            "bufferView": self._add_view(data.astype(data.dtype.newbyteorder("<")).tobytes(), target),
            "componentType": component,
            "count": len(data),
            "type": kind,
        }
        if bounds:
            accessor["min"], accessor["max"] = data.min(axis=0).tolist(), data.max(axis=0).tolist()
        return self._append("accessors", accessor)

    def _add_view(self, data: bytes, target: int | None = None) -> int:
        self._buffer.extend(bytes(-len(self._buffer) % 4))
        view: Json = {"buffer": 0, "byteOffset": len(self._buffer), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self._buffer.extend(data)
        return self._append("bufferViews", view)

    def _add_root(self, node: Json) -> int:
        index = self._append("nodes", node)
        self._json["scenes"][0]["nodes"].append(index)
        return index

    def _append(self, key: str, value: Any) -> int:
        entries = self._json.setdefault(key, [])
        entries.append(value)
        return len(entries) - 1


def _number(value: float) -> float:
    """A JSON number without the noise of the last bits, so that documents compare across machines."""
    return round(float(value), 9) + 0.0


def _rotation_from_minus_z(direction: ArrayLike) -> tuple[float, float, float, float]:
    """Quaternion (x, y, z, w) of the shortest turn that takes −Z to ``direction``."""
    x, y, z = np.asarray(direction, np.float64) / np.linalg.norm(direction)
    if z > 1 - 1e-9:
        return (0.0, 1.0, 0.0, 0.0)
    # The half-way construction: axis (−Z) × d = (y, −x, 0), and w = 1 + (−Z)·d, normalised.
    w = 1.0 - z
    length = math.sqrt(x * x + y * y + w * w)
    return (y / length, -x / length, 0.0, w / length)
