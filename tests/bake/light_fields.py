"""Light around a surface point with an answer by quadrature, for tests of directional modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.scene.tangents import RNM_BASIS

TANGENT = np.array([0.8, -0.6, 0.0])
NORMAL = np.array([0.36, 0.48, 0.8])
BITANGENT = np.cross(NORMAL, TANGENT)
AXES = np.stack([TANGENT, BITANGENT, NORMAL])


@dataclass(frozen=True)
class LightField:
    """Radiance over the hemisphere about NORMAL.

    Attributes:
        directions: (M, 3).
        light: (M, 3) radiance times solid angle.
    """

    directions: NDArray
    light: NDArray

    def over_pi(self, normal: NDArray) -> NDArray:
        """(3,) E/π for a normal."""
        return np.maximum(self.directions @ normal, 0.0) @ self.light / np.pi

    def moments(self, kind: str) -> NDArray:
        """(k, 3) as ``irradia.transport.moments`` defines them."""
        if kind == "rnm":
            return np.maximum(RNM_BASIS @ AXES @ self.directions.T, 0.0) @ self.light / np.pi
        mean = self.light.sum(axis=0) / (4.0 * np.pi)
        if kind == "sh":
            return np.concatenate([mean[None], self.directions.T @ self.light / (4.0 * np.pi)])
        grey = self.light @ np.array(LUMINANCE_WEIGHTS)
        return np.stack([mean, grey @ self.directions / (4.0 * np.pi)])


def lamp(towards: NDArray, colour: tuple[float, float, float] = (2.0, 1.5, 1.0)) -> LightField:
    """A small lamp in a direction of the surface's own frame (z is its normal)."""
    direction = np.asarray(towards, np.float64) / np.linalg.norm(towards)
    return LightField((direction @ AXES)[None], np.array([colour]))


def sky(colour: tuple[float, float, float] = (0.5, 0.7, 1.0), n: int = 20_000) -> LightField:
    """Even light from the whole hemisphere, in ``n`` directions."""
    z = (np.arange(n) + 0.5) / n
    phi = np.arange(n) * np.pi * (3.0 - np.sqrt(5.0))
    s = np.sqrt(1.0 - z * z)
    local = np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=1)
    return LightField(local @ AXES, np.tile(np.array(colour) * 2.0 * np.pi / n, (n, 1)))


def both(first: LightField, second: LightField) -> LightField:
    """The light of two fields."""
    return LightField(
        np.concatenate([first.directions, second.directions]), np.concatenate([first.light, second.light])
    )


def some_fields(count: int = 24) -> list[LightField]:
    """Lamps and skies at random."""
    rng = np.random.default_rng(5)
    fields = []
    for _ in range(count):
        towards = rng.normal(size=3)
        towards[2] = abs(towards[2]) + 0.05
        field = both(lamp(towards, tuple(rng.exponential(size=3))), sky(tuple(rng.random(3) * rng.random())))
        fields.append(field)
    return fields
