"""What a directional lightmap accumulates beside E/π: moments of the light around a texel.

Every sample of E/π is worth ``light = L cos θ / (π p)``, with θ measured from the shading normal and
p the density of its direction. A moment is a colour whose mean over the same samples is what a
directional mode is made of:

    sh      R₀ = ∫ L dω / 4π, and ∫ L ω dω / 4π for each world axis of ω: the first two bands of
            spherical harmonics, L₀₀ = R₀ / 0.282095 and L₁ = (3 / 0.488603) · their axis' moment
    mono    R₀, and ∫ Y ω dω / 4π as the three channels of a colour, with Y the luminance of L
    rnm     ∫ L max(0, bᵢ · ω) dω / π: E/π facing each of the three directions bᵢ of RNM_BASIS

None of these carries the cosine, so under cosine-distributed rays their samples are unbounded at
grazing angles. Gather rays are therefore drawn from :data:`irradia.transport.hemispheres.MIXED`: half
of its density is uniform, so that R₀'s sample is at most L, and E/π's at most twice L.
"""

from __future__ import annotations

from typing import Literal, Protocol

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.scene.tangents import RNM_BASIS
from irradia.transport.backend import dr, mi
from irradia.transport.frames import Frame

MomentsName = Literal["sh", "mono", "rnm"]
_MIN_COSINE = 1e-6


class Moments(Protocol):
    """A set of colours that a pass adds up.

    Attributes:
        n_colours: How many.
        tangent_space: Whether frames must have tangents.
    """

    n_colours: int
    tangent_space: bool

    def terms(self, light: mi.Color3f, direction: mi.Vector3f, frame: Frame) -> list[mi.Color3f]:
        """What one sample adds to each colour.

        Args:
            light: What it adds to E/π.
            direction: World-space unit vector to where it comes from, above the surface.
            frame: At the receiver; ``light`` holds the cosine to its normal.
        """
        ...


class ShMoments:
    """Spherical harmonics of two bands, RGB."""

    n_colours = 4
    tangent_space = False

    def terms(self, light: mi.Color3f, direction: mi.Vector3f, frame: Frame) -> list[mi.Color3f]:
        """See :class:`Moments`."""
        mean = _without_cosine(light, direction, frame) * 0.25
        return [mean, mean * direction.x, mean * direction.y, mean * direction.z]


class MonoMoments:
    """Light's mean in RGB and its mean direction by luminance."""

    n_colours = 2
    tangent_space = False

    def terms(self, light: mi.Color3f, direction: mi.Vector3f, frame: Frame) -> list[mi.Color3f]:
        """See :class:`Moments`."""
        mean = _without_cosine(light, direction, frame) * 0.25
        luminance = dr.dot(mean, mi.Color3f(*LUMINANCE_WEIGHTS))
        return [mean, mi.Color3f(direction.x, direction.y, direction.z) * luminance]


class RnmMoments:
    """E/π facing the three directions of radiosity normal mapping."""

    n_colours = 3
    tangent_space = True

    def terms(self, light: mi.Color3f, direction: mi.Vector3f, frame: Frame) -> list[mi.Color3f]:
        """See :class:`Moments`."""
        radiance = _without_cosine(light, direction, frame)
        facing = [dr.dot(frame.to_world(mi.Vector3f(*map(float, b))), direction) for b in RNM_BASIS]
        return [radiance * dr.maximum(cosine, 0.0) for cosine in facing]


MOMENTS: dict[MomentsName, type[Moments]] = {"sh": ShMoments, "mono": MonoMoments, "rnm": RnmMoments}


def _without_cosine(light: mi.Color3f, direction: mi.Vector3f, frame: Frame) -> mi.Color3f:
    """L / (π p)."""
    return light * dr.rcp(dr.maximum(dr.dot(frame.normal, direction), _MIN_COSINE))
