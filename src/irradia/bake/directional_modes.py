"""Directional lightmaps: how light around a texel becomes maps, and how maps become E/π for a normal.

The readable definition, in NumPy; docs/directional.md has the same as shader code. All modes share
three laws: the result is E/π of the plain map where the normal is the surface's own, it is never
negative, and it is linear in the light's strength.

Every map has three channels. Those that hold light are linear and ≥ 0; the others hold numbers of
[−1, 1] as x/2 + 1/2, so that any texture format takes them and filtering keeps them in range.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.core.errors import InternalError
from irradia.scene.tangents import RNM_BASIS

DirectionalName = Literal["dominant", "rnm", "sh", "mono-sh"]
MomentsKind = Literal["sh", "mono", "rnm"]
Maps = Mapping[str, NDArray]
_LUMINANCE = np.array(LUMINANCE_WEIGHTS)
_TINY = 1e-20


@dataclass(frozen=True)
class SurfaceFrame:
    """The surface that a map is read on, each (…, 3) in world space.

    Attributes:
        normal: The interpolated vertex normal, unit.
        tangent, bitangent: As :mod:`irradia.scene.tangents` defines them; only ``rnm`` asks for them.
    """

    normal: NDArray
    tangent: NDArray | None = None
    bitangent: NDArray | None = None


class DirectionalMode(Protocol):
    """One way to store light by direction.

    Attributes:
        moments: What the bake accumulates for it; see :mod:`irradia.transport.moments`.
        maps: Names of its maps, in order.
        light_maps: Those among them that hold light.
        tangent_space: Whether its maps, and its normals, are relative to tangents.
    """

    moments: MomentsKind
    maps: tuple[str, ...]
    light_maps: tuple[str, ...]
    tangent_space: bool

    def encode(self, plain: NDArray, moments: NDArray, normals: NDArray) -> dict[str, NDArray]:
        """Makes the maps.

        Args:
            plain: (N, 3) E/π of the plain map.
            moments: (N, k, 3) means, noise and all; whatever no light could have is put right.
            normals: (N, 3) the surface's own normals.
        """
        ...

    def irradiance_over_pi(
        self, plain: NDArray, maps: Maps, normal: NDArray, surface: SurfaceFrame
    ) -> NDArray:
        """E/π for a normal.

        Args:
            plain: (…, 3) the plain map's value.
            maps: (…, 3) each map's.
            normal: (…, 3) world-space unit normal, from a normal map for instance.
            surface: Where the maps are read.
        """
        ...


class Dominant:
    """E/π and one direction that shades it by half a Lambert: Unity's directional mode.

    The direction's length is the directionality: 1 from light as one-sided as an even hemisphere's on
    (whose mean direction has length 1/2), since half a Lambert can't shade more than that.
    """

    moments: MomentsKind = "mono"
    maps: tuple[str, ...] = ("direction",)
    light_maps: tuple[str, ...] = ()
    tangent_space = False

    def encode(self, plain: NDArray, moments: NDArray, normals: NDArray) -> dict[str, NDArray]:
        """See :class:`DirectionalMode`."""
        _, mean_direction = _mono(plain, moments, normals)
        length = np.linalg.norm(mean_direction, axis=-1, keepdims=True)
        return {"direction": _coded(mean_direction * np.minimum(2.0, 1.0 / np.maximum(length, _TINY)))}

    def irradiance_over_pi(
        self, plain: NDArray, maps: Maps, normal: NDArray, surface: SurfaceFrame
    ) -> NDArray:
        """See :class:`DirectionalMode`."""
        direction = _decoded(maps["direction"])
        shade = np.maximum(0.5 + 0.5 * _dot(normal, direction), 0.0)
        own = 0.5 + 0.5 * _dot(surface.normal, direction)
        return plain * shade / np.maximum(own, 1e-4)


class RadiosityNormalMapping:
    """E/π facing three directions of tangent space (McTaggart 2004, "Half-Life 2 / Valve Source Shading").

    Ours is weighted by the cosines to the three, not by their squares: exact for light above all three
    horizons. All three are scaled alike so that the surface's own normal gets the plain map's value,
    which neither weighting does by itself (an even sky would come out 37 % too bright, or 21 % too dark).
    """

    moments: MomentsKind = "rnm"
    maps: tuple[str, ...] = ("rnm_0", "rnm_1", "rnm_2")
    light_maps: tuple[str, ...] = maps
    tangent_space = True

    def encode(self, plain: NDArray, moments: NDArray, normals: NDArray) -> dict[str, NDArray]:
        """See :class:`DirectionalMode`."""
        facing = np.maximum(moments, 0.0)
        own = facing.sum(axis=1, keepdims=True) / np.sqrt(3.0)
        share = np.where(own > 0.0, facing / np.maximum(own, _TINY), 1.0 / np.sqrt(3.0))
        values = (share * plain[:, None]).astype(np.float32)
        return {name: values[:, index] for index, name in enumerate(self.maps)}

    def irradiance_over_pi(
        self, plain: NDArray, maps: Maps, normal: NDArray, surface: SurfaceFrame
    ) -> NDArray:
        """See :class:`DirectionalMode`."""
        if surface.tangent is None or surface.bitangent is None:
            raise InternalError("rnm is decoded in tangent space, and this surface has no tangents")
        axes = (surface.tangent, surface.bitangent, surface.normal)
        total = np.zeros(np.broadcast_shapes(np.shape(plain), np.shape(normal)))
        for name, basis in zip(self.maps, RNM_BASIS, strict=True):
            cosine = sum(b * _dot(normal, axis) for b, axis in zip(basis, axes, strict=True))
            total = total + maps[name] * np.maximum(cosine, 0.0)
        return total


class SphericalHarmonics:
    """Two bands of spherical harmonics of the light around, RGB.

    ``sh_l0`` holds R₀ = ∫ L dω / 4π, ``sh_x``, ``sh_y`` and ``sh_z`` the mean direction of the light
    r = ∫ L ω dω / ∫ L dω, colour by colour. Linear SH would give E/π = R₀ (1 + 2 r · n), with half the
    contrast of a lamp and light from behind. But the surface blocks what lies below it, so that E/π
    = 4 R₀ (r · s) exactly for its own normal s. The decoder keeps that, and is also exact for a single
    lamp and for an even sky: with t = 2 r · n,

        E/π = R₀ (t + √(t² + (1 − |r|)(1 + 2|r|)(1 − (n · s)²)))

    Where it comes from: max(0, x) = (x + |x|) / 2, so E is half the sum of ∫ L (n · ω), which is
    what t stands for, and ∫ L |n · ω|, which is the root. A lamp's is |t|; what a cap of even light
    around s adds at right angles to it, (1 − r)(1 + 2r) fits within 2 % for every width of the cap.
    """

    moments: MomentsKind = "sh"
    maps: tuple[str, ...] = ("sh_l0", "sh_x", "sh_y", "sh_z")
    light_maps: tuple[str, ...] = ("sh_l0",)
    tangent_space = False

    def encode(self, plain: NDArray, moments: NDArray, normals: NDArray) -> dict[str, NDArray]:
        """See :class:`DirectionalMode`."""
        mean, vector = moments[:, 0], moments[:, 1:]
        strength = np.maximum(mean, plain / 4.0)
        direction = np.moveaxis(vector / np.maximum(strength, _TINY)[:, None], 1, 2)  # texel, colour, axis
        own = plain / np.maximum(4.0 * strength, _TINY)
        direction = _with_own_part(direction, own, normals[:, None])
        maps = {"sh_l0": strength.astype(np.float32)}
        return maps | {f"sh_{axis}": _coded(direction[..., k]) for k, axis in enumerate("xyz")}

    def irradiance_over_pi(
        self, plain: NDArray, maps: Maps, normal: NDArray, surface: SurfaceFrame
    ) -> NDArray:
        """See :class:`DirectionalMode`; ``plain`` isn't read."""
        direction = np.stack([_decoded(maps[f"sh_{axis}"]) for axis in "xyz"], axis=-1)
        lobe = sh_lobe(direction, np.expand_dims(normal, -2), np.expand_dims(surface.normal, -2))
        return maps["sh_l0"] * lobe


class MonoSphericalHarmonics:
    """As :class:`SphericalHarmonics`, with one direction for all colours.

    ``sh_l0`` has R₀'s luminance and the plain map's colour, so that the surface's own normal gets the
    plain map's value in every channel.
    """

    moments: MomentsKind = "mono"
    maps: tuple[str, ...] = ("sh_l0", "sh_direction")
    light_maps: tuple[str, ...] = ("sh_l0",)
    tangent_space = False

    def encode(self, plain: NDArray, moments: NDArray, normals: NDArray) -> dict[str, NDArray]:
        """See :class:`DirectionalMode`."""
        strength, direction = _mono(plain, moments, normals)
        luminance = (plain @ _LUMINANCE)[:, None]
        mean = np.where(luminance > 0.0, plain * (strength / np.maximum(luminance, _TINY)), moments[:, 0])
        return {"sh_l0": np.maximum(mean, 0.0).astype(np.float32), "sh_direction": _coded(direction)}

    def irradiance_over_pi(
        self, plain: NDArray, maps: Maps, normal: NDArray, surface: SurfaceFrame
    ) -> NDArray:
        """See :class:`DirectionalMode`; ``plain`` isn't read."""
        lobe = sh_lobe(_decoded(maps["sh_direction"]), normal, surface.normal)
        return maps["sh_l0"] * lobe[..., None]


MODES: dict[DirectionalName, DirectionalMode] = {
    "dominant": Dominant(),
    "rnm": RadiosityNormalMapping(),
    "sh": SphericalHarmonics(),
    "mono-sh": MonoSphericalHarmonics(),
}


def sh_lobe(direction: NDArray, normal: NDArray, surface_normal: NDArray) -> NDArray:
    """E/π over R₀ for light of mean direction ``direction``; see :class:`SphericalHarmonics`.

    Args:
        direction: (…, 3) r, at most 1 long.
        normal: (…, 3) the normal that is lit.
        surface_normal: (…, 3) the surface's own.
    """
    length = np.minimum(np.linalg.norm(direction, axis=-1), 1.0)
    t = 2.0 * (direction * normal).sum(-1)
    bent = np.maximum(1.0 - (normal * surface_normal).sum(-1) ** 2, 0.0)
    return np.maximum(t + np.sqrt(t**2 + (1.0 - length) * (1.0 + 2.0 * length) * bent), 0.0)


def sh_linear(maps: Maps, normal: NDArray) -> NDArray:
    """E/π as engines without the surface's normal read the maps of ``sh``: L1 SH, clamped at 0."""
    direction = np.stack([_decoded(maps[f"sh_{axis}"]) for axis in "xyz"], axis=-1)
    t = 2.0 * (direction * np.expand_dims(normal, -2)).sum(-1)
    return maps["sh_l0"] * np.maximum(1.0 + t, 0.0)


def _mono(plain: NDArray, moments: NDArray, normals: NDArray) -> tuple[NDArray, NDArray]:
    """Luminance of R₀, (N, 1), and the mean direction, (N, 3), consistent with the plain map."""
    own_light = plain @ _LUMINANCE
    strength = np.maximum(moments[:, 0] @ _LUMINANCE, own_light / 4.0)
    direction = moments[:, 1] / np.maximum(strength, _TINY)[:, None]
    own = own_light / np.maximum(4.0 * strength, _TINY)
    return strength[:, None], _with_own_part(direction, own, normals)


def _with_own_part(direction: NDArray, own: NDArray, normals: NDArray) -> NDArray:
    """Mean directions whose part along the surface's normal is ``own``, none longer than 1."""
    across = direction - normals * _dot(direction, normals)
    length = np.linalg.norm(across, axis=-1)
    room = np.sqrt(np.maximum(1.0 - own**2, 0.0))
    across = across * np.minimum(1.0, room / np.maximum(length, _TINY))[..., None]
    return across + normals * own[..., None]


def _dot(a: NDArray, b: NDArray) -> NDArray:
    """(…, 1)."""
    return (a * b).sum(-1, keepdims=True)


def _coded(signed: NDArray) -> NDArray[np.float32]:
    return (0.5 * np.clip(signed, -1.0, 1.0) + 0.5).astype(np.float32)


def _decoded(stored: NDArray) -> NDArray:
    return 2.0 * np.asarray(stored, np.float64) - 1.0
