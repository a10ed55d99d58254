"""Light from the environment map."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.scene.types import Environment
from irradia.transport.alias import AliasTable
from irradia.transport.backend import dr, mi


class EnvironmentLight:
    """An equirectangular map, piecewise constant, sampled by luminance and solid angle."""

    def __init__(self, environment: Environment) -> None:
        radiance = environment.radiance.astype(np.float64)
        self._height, self._width = radiance.shape[:2]
        edges = np.cos(np.linspace(0.0, math.pi, self._height + 1))
        self._solid_angle = (edges[:-1] - edges[1:]) * (2.0 * math.pi / self._width)
        luminance = radiance @ np.array(LUMINANCE_WEIGHTS)
        weights = luminance * self._solid_angle[:, None]
        self.sampled = luminance.max() > 0.0 and _is_uneven(luminance, self._solid_angle)
        texels = np.zeros((self._height, self._width, 4), np.float32)
        texels[..., :3] = radiance
        if self.sampled:
            texels[..., 3] = weights / weights.sum() / self._solid_angle[:, None]
            self._alias = AliasTable(weights.ravel())
        self._texels = mi.Float(texels.ravel())
        self._edges = mi.Float(edges.astype(np.float32))

    def lookup(self, direction: mi.Vector3f, active: mi.Bool) -> tuple[mi.Color3f, mi.Float]:
        """Radiance from a direction, and the density of sampling it."""
        u = dr.atan2(direction.x, -direction.z) * (0.5 / math.pi) + 0.5
        v = dr.safe_acos(direction.y) * (1.0 / math.pi)
        x = dr.clip(mi.Int32(u * self._width), 0, self._width - 1)
        y = dr.clip(mi.Int32(v * self._height), 0, self._height - 1)
        texel = dr.gather(mi.Vector4f, self._texels, mi.UInt32(y * self._width + x), active)
        return mi.Color3f(texel.x, texel.y, texel.z), texel.w

    def backdrop(self, direction: mi.Vector3f, active: mi.Bool) -> mi.Color3f:
        """Radiance filtered between pixels, for rays straight from a camera."""
        x = (dr.atan2(direction.x, -direction.z) * (0.5 / math.pi) + 0.5) * self._width - 0.5
        y = dr.safe_acos(direction.y) * (self._height / math.pi) - 0.5
        x0, y0 = dr.floor(x), dr.floor(y)
        total = mi.Color3f(0.0)
        for j, wy in ((0.0, 1.0 - (y - y0)), (1.0, y - y0)):
            for i, wx in ((0.0, 1.0 - (x - x0)), (1.0, x - x0)):
                row = dr.clip(y0 + j, 0.0, self._height - 1.0)
                column = x0 + i
                column = dr.select(
                    column < 0.0, self._width - 1.0, dr.select(column < self._width, column, 0.0)
                )
                index = mi.UInt32(row) * self._width + mi.UInt32(column)
                texel = dr.gather(mi.Vector4f, self._texels, index, active)
                total += mi.Color3f(texel.x, texel.y, texel.z) * (wx * wy)
        return total

    def sample(self, u: mi.Point2f, active: mi.Bool) -> tuple[mi.Vector3f, mi.Color3f, mi.Float]:
        """A direction, its radiance and its density."""
        index, fresh = self._alias.sample(u.x, active)
        y = index // self._width
        x = index - y * self._width
        top = dr.gather(mi.Float, self._edges, y, active)
        bottom = dr.gather(mi.Float, self._edges, y + 1, active)
        cos_theta = dr.lerp(top, bottom, u.y)
        sin_theta = dr.safe_sqrt(1.0 - cos_theta * cos_theta)
        phi = ((mi.Float(x) + fresh) / self._width - 0.5) * (2.0 * math.pi)
        sin_phi, cos_phi = dr.sincos(phi)
        texel = dr.gather(mi.Vector4f, self._texels, index, active)
        direction = mi.Vector3f(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta)
        return direction, mi.Color3f(texel.x, texel.y, texel.z), texel.w


def _is_uneven(luminance: NDArray[np.float64], solid_angle: NDArray[np.float64]) -> bool:
    """Whether a map has anything that cosine-distributed rays alone would find too rarely."""
    weights = np.broadcast_to(solid_angle[:, None], luminance.shape)
    mean = np.average(luminance, weights=weights)
    return bool(np.average((luminance / mean) ** 2, weights=weights) > 3.0)
