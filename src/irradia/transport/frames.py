"""Tangent frames at surface points, for what is defined across the surface and not along it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.sampling import to_world


@dataclass
class Frame:
    """A right- or left-handed frame on the surface; see :mod:`irradia.scene.tangents`.

    Attributes:
        tangent, bitangent: World-space unit vectors across the normal.
        normal: The shading normal that cosines are measured from.
    """

    tangent: mi.Vector3f
    bitangent: mi.Vector3f
    normal: mi.Vector3f

    @staticmethod
    def around(normal: mi.Vector3f) -> Frame:
        """A frame for what needs no tangent: its tangents are 0."""
        return Frame(mi.Vector3f(0.0), mi.Vector3f(0.0), normal)

    def to_world(self, local: mi.Vector3f) -> mi.Vector3f:
        """A tangent-space vector in world space."""
        return self.tangent * local.x + self.bitangent * local.y + self.normal * local.z


class TangentFrames:
    """Tangents of a merged mesh, on the device.

    Args:
        tangents: (T, 3, 4) from :func:`irradia.scene.tangents.world_tangents`.
    """

    def __init__(self, tangents: NDArray[np.float32]) -> None:
        self._tangents = mi.Float(np.ascontiguousarray(tangents, np.float32).ravel())

    def at(self, triangle: mi.UInt32, bary: mi.Point2f, normal: mi.Vector3f, active: mi.Bool) -> Frame:
        """The frame on a triangle, its tangent interpolated and made square to ``normal``.

        Where corners' tangents cancel out, any direction across the normal serves.
        """
        tangent, sign = mi.Vector3f(0.0), mi.Float(1.0)
        for corner, weight in enumerate((1.0 - bary.x - bary.y, bary.x, bary.y)):
            value = dr.gather(mi.Vector4f, self._tangents, 3 * triangle + corner, active)
            tangent += mi.Vector3f(value.x, value.y, value.z) * weight
            sign = value.w
        tangent = tangent - normal * dr.dot(tangent, normal)
        length = dr.norm(tangent)
        across = to_world(normal, mi.Vector3f(1.0, 0.0, 0.0))
        tangent = dr.select(length > 1e-6, tangent / length, across)
        return Frame(tangent, dr.cross(normal, tangent) * sign, normal)
