"""Normal textures on the device: the shading normal that a material shows at a point.

Only where light is received is this asked for: a lightmap baked with normal maps stores E/π for the
mapped normal. Hit points keep the vertex normal, as their light is read from such a map or averaged
over the texture anyway.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irradia.scene.types import Scene
from irradia.transport.backend import dr, mi
from irradia.transport.frames import TangentFrames
from irradia.transport.geometry import SurfacePoint
from irradia.transport.textures import NO_TEXTURE, TextureTable
from irradia.transport.world import World


class NormalMaps:
    """The normal textures of a scene.

    Args:
        scene: Materials and images.
        frames: Tangents of its merged mesh.
    """

    def __init__(self, scene: Scene, frames: TangentFrames) -> None:
        self._frames = frames
        self._textures = TextureTable(scene.images)
        slots = [self._textures.add(material.normal_texture) for material in scene.materials]
        self._textures.freeze()
        self._slots = mi.UInt32(np.array(slots, np.uint32))
        self._scales = mi.Float(np.array([m.normal_scale for m in scene.materials], np.float32))
        self.any = any(slot != NO_TEXTURE for slot in slots)

    def apply(
        self, world: World, point: SurfacePoint, triangle: mi.UInt32, bary: mi.Point2f, active: mi.Bool
    ) -> SurfacePoint:
        """The point with its material's normal in place of the interpolated one."""
        if not self.any:
            return point
        return replace(point, ns=self._normal(world, point.ns, triangle, bary, active))

    def _normal(
        self, world: World, ns: mi.Vector3f, triangle: mi.UInt32, bary: mi.Point2f, active: mi.Bool
    ) -> mi.Vector3f:
        material = world.geometry.vertices(triangle, active).w
        slot = dr.gather(mi.UInt32, self._slots, material, active)
        mapped = active & (slot != NO_TEXTURE)
        uv0, uv1, _ = world.geometry.texcoords(triangle, bary, mapped)
        texel = self._textures.sample(slot, uv0, uv1, srgb=False, active=mapped).rgb
        scale = dr.gather(mi.Float, self._scales, material, mapped)
        local = mi.Vector3f(texel.x * 2.0 - 1.0, texel.y * 2.0 - 1.0, texel.z * 2.0 - 1.0)
        local = local * mi.Vector3f(scale, scale, 1.0)
        bent = dr.normalize(self._frames.at(triangle, bary, ns, mapped).to_world(local))
        return dr.select(mapped & dr.isfinite(bent.x), bent, ns)
