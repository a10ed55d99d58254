"""A scene as the baker sees it: posed, decoded, engine-neutral. NumPy arrays and plain values only.

World space is glTF's: metres, right-handed, +Y up. Colours are linear Rec.709 unless a name says
``srgb``. Transforms are named target_from_source and act on column vectors.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from irradia.scene.gltf.document import GltfDocument

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
U32 = NDArray[np.uint32]
U8 = NDArray[np.uint8]

WrapMode = Literal["repeat", "clamp", "mirror"]
AlphaMode = Literal["opaque", "mask", "blend"]
LightKind = Literal["directional", "point", "spot"]
LightMode = Literal["baked", "mixed", "realtime", "off"]


@dataclass(frozen=True)
class Image:
    """A decoded image, 8 bits a channel, row 0 at the top.

    Attributes:
        pixels: (height, width, 4) as stored: sRGB-coded where its use says colour.
    """

    name: str
    pixels: U8


@dataclass(frozen=True)
class TextureRef:
    """How a material reads an image.

    Attributes:
        image: Index into ``Scene.images``.
        texcoord: Which of the primitive's ``texcoords`` is read.
        uv_from_texcoord: (2, 3), KHR_texture_transform; identity by default.
        wrap_s, wrap_t: Behaviour outside [0, 1].
        nearest: Whether magnification takes the nearest texel instead of filtering.
    """

    image: int
    texcoord: int = 0
    uv_from_texcoord: tuple[tuple[float, float, float], tuple[float, float, float]] = (
        (1.0, 0.0, 0.0),
        (0.0, 1.0, 0.0),
    )
    wrap_s: WrapMode = "repeat"
    wrap_t: WrapMode = "repeat"
    nearest: bool = False


Rgb = tuple[float, float, float]


@dataclass(frozen=True)
class Material:
    """Metallic-roughness with the extensions that diffuse transport needs; texture × factor each.

    Attributes:
        base_color: Linear RGB and alpha.
        emission: Linear radiance, strength multiplied in.
        specular: KHR_materials_specular's factor on the dielectric F0 (0 makes it purely diffuse).
        transmission: Share of light that passes unbent, tinted by the base colour.
        diffuse_transmission: Share of the diffuse part that leaves through the back.
        unlit: The base colour is shown as it is: the surface blocks light, reflects none and
            takes no lightmap.
    """

    name: str = ""
    base_color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    base_color_texture: TextureRef | None = None
    metallic: float = 1.0
    roughness: float = 1.0
    metallic_roughness_texture: TextureRef | None = None
    emission: Rgb = (0.0, 0.0, 0.0)
    emission_texture: TextureRef | None = None
    normal_texture: TextureRef | None = None
    normal_scale: float = 1.0
    alpha_mode: AlphaMode = "opaque"
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    unlit: bool = False
    ior: float = 1.5
    specular: float = 1.0
    specular_texture: TextureRef | None = None
    specular_color: Rgb = (1.0, 1.0, 1.0)
    specular_color_texture: TextureRef | None = None
    transmission: float = 0.0
    transmission_texture: TextureRef | None = None
    diffuse_transmission: float = 0.0
    diffuse_transmission_texture: TextureRef | None = None
    diffuse_transmission_color: Rgb = (1.0, 1.0, 1.0)
    diffuse_transmission_color_texture: TextureRef | None = None


@dataclass(frozen=True)
class Primitive:
    """Triangles in object space, morphs and skins applied (a skinned primitive is posed in world
    space and used by one instance whose transform is the identity).

    Attributes:
        positions: (V, 3).
        normals: (V, 3) unit; flat ones have been made where the file has none.
        texcoords: Each (V, 2), as many as the file has.
        colors: (V, 4) linear, or None.
        indices: (T, 3); strips and fans unrolled, degenerate triangles removed.
        material: Index into ``Scene.materials``.
        mesh_index, primitive_index: Where it stands in the glTF.
        vertex_source: (V,) the glTF vertex that each vertex comes from (flat normals split some).
        tangents: (V, 4) the file's tangents and the sign of their bitangents, or None where it has
            none or a pose has bent them.
    """

    positions: F32
    normals: F32
    texcoords: tuple[F32, ...]
    colors: F32 | None
    indices: U32
    material: int
    mesh_index: int
    primitive_index: int
    vertex_source: U32
    name: str = ""
    tangents: F32 | None = None


@dataclass(frozen=True)
class Instance:
    """One placement of a primitive.

    Attributes:
        primitive: Index into ``Scene.primitives``.
        world_from_object: (4, 4).
        node_index: The glTF node.
        gpu_instance: Index within EXT_mesh_gpu_instancing, or None.
        lightmap_scale: From ``extras.irradia.lightmapScale``; 0 takes no lightmap.
        casts: Whether it blocks and reflects light for others.
        lod_group: Which MSFT_lod family it belongs to, or None; members of one family don't see
            each other.
        lod_level: 0 is the finest, the one that the rest of the scene sees.
    """

    primitive: int
    world_from_object: F64
    node_index: int
    gpu_instance: int | None = None
    lightmap_scale: float = 1.0
    casts: bool = True
    lod_group: int | None = None
    lod_level: int = 0
    name: str = ""


@dataclass(frozen=True)
class IesProfile:
    """A measured luminous intensity distribution (IES LM-63), full sphere.

    Attributes:
        candela: (V, H) at equal steps of vertical angle 0 … 180° from the light's axis and of
            horizontal angle 0 … 360°, first and last column the same direction.
    """

    candela: F32
    name: str = ""


@dataclass(frozen=True)
class Light:
    """A punctual light (KHR_lights_punctual): candela, or lux for directional, times linear colour.

    Attributes:
        intensity: Linear RGB: colour × intensity.
        direction: World-space unit vector along which light travels.
        angle_deg: Angular diameter of a directional light; 0 casts sharp shadows.
        radius_m: Radius of a point or spot light's sphere; 0 casts sharp shadows.
        range_m: Cut-off distance, or None.
        mode: ``baked``: all its light is in the maps. ``mixed``: its first bounce is lit live, with
            a baked shadow mask. ``realtime``: its first bounce is lit and shadowed live. ``off``: it
            has no part in the bake.
        profile: Replaces the cone; ``intensity`` then multiplies its candela.
        up: World-space unit vector across ``direction``: where the profile's horizontal 0° points.
        node_index: The glTF node, or None for light from elsewhere.
    """

    kind: LightKind
    intensity: Rgb
    position: Rgb = (0.0, 0.0, 0.0)
    direction: Rgb = (0.0, 0.0, -1.0)
    range_m: float | None = None
    inner_cone_rad: float = 0.0
    outer_cone_rad: float = 0.7853981633974483
    angle_deg: float = 0.0
    radius_m: float = 0.0
    mode: LightMode = "baked"
    profile: IesProfile | None = None
    up: Rgb = (0.0, 1.0, 0.0)
    name: str = ""
    node_index: int | None = field(default=None, compare=False)


@dataclass(frozen=True)
class Camera:
    """A pinhole camera looking along its −Z.

    Attributes:
        yfov_rad: Vertical field of view.
    """

    world_from_camera: F64
    yfov_rad: float
    aspect: float = 16.0 / 9.0
    name: str = ""


@dataclass(frozen=True)
class Environment:
    """Radiance from infinitely far away.

    Attributes:
        radiance: (height, width, 3) equirectangular, row 0 toward +Y. Column u = 0.5 (the centre)
            looks along −Z and u grows toward +X: direction = (sin φ sin θ, cos θ, −cos φ sin θ)
            with φ = 2π(u − 0.5) and θ = πv. Rotation and strength are already applied.
    """

    radiance: F32
    name: str = ""


@dataclass(frozen=True)
class Scene:
    """Everything that the bake needs, and the document it came from."""

    name: str
    primitives: tuple[Primitive, ...]
    instances: tuple[Instance, ...]
    materials: tuple[Material, ...]
    images: tuple[Image, ...]
    lights: tuple[Light, ...] = ()
    cameras: tuple[Camera, ...] = ()
    environment: Environment | None = None
    notes: tuple[str, ...] = ()
    document: GltfDocument | None = field(default=None, repr=False, compare=False)

    @property
    def n_triangles(self) -> int:
        """Triangles with every instance counted."""
        return sum(len(self.primitives[i.primitive].indices) for i in self.instances)
