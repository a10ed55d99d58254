"""Distributions of directions about a normal that gather rays are drawn from."""

from __future__ import annotations

import math
from typing import Protocol

from irradia.transport.backend import dr, mi
from irradia.transport.sampling import cosine_hemisphere


class Hemisphere(Protocol):
    """A distribution over the directions about +Z."""

    def draw(self, u: mi.Point2f) -> mi.Vector3f:
        """A direction for two random numbers in [0, 1)."""
        ...

    def density(self, cosine: mi.Float) -> mi.Float:
        """Solid-angle density at an angle above the plane."""
        ...


class CosineHemisphere:
    """cos θ / π: every sample of E/π is the radiance itself."""

    def draw(self, u: mi.Point2f) -> mi.Vector3f:
        """See :class:`Hemisphere`."""
        return cosine_hemisphere(u)

    def density(self, cosine: mi.Float) -> mi.Float:
        """See :class:`Hemisphere`."""
        return cosine * (1.0 / math.pi)


class MixedHemisphere:
    """Half uniform, half by the cosine: for estimates both with and without the cosine.

    Its distribution of c = cos θ, (c + c²) / 2, is inverted as one, so that the stratification of
    random numbers survives.
    """

    def draw(self, u: mi.Point2f) -> mi.Vector3f:
        """See :class:`Hemisphere`."""
        v = 1.0 - u.x  # in (0, 1], so that no direction lies in the plane
        cosine = 4.0 * v / (1.0 + dr.sqrt(1.0 + 8.0 * v))
        sine = dr.sqrt(dr.maximum(1.0 - cosine * cosine, 0.0))
        sin_phi, cos_phi = dr.sincos(2.0 * math.pi * u.y)
        return mi.Vector3f(sine * cos_phi, sine * sin_phi, cosine)

    def density(self, cosine: mi.Float) -> mi.Float:
        """See :class:`Hemisphere`."""
        return (1.0 / (4.0 * math.pi)) + cosine * (1.0 / (2.0 * math.pi))


COSINE: Hemisphere = CosineHemisphere()
MIXED: Hemisphere = MixedHemisphere()
