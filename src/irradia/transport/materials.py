"""Materials as one table: what a surface reflects, emits and lets through, for diffuse transport.

The diffuse transport of Irradia replaces a material by its reflectance ρ: the share of cosine-
distributed light that it reflects, diffuse and specular together. With Schlick's Fresnel term,
whose cosine-weighted mean is F0·20/21 + F90/21, and multiple scattering between microfacets
compensated, so that roughness doesn't matter:

    ρ = (1 − metallic) · base · (1 − max F̄) + F̄

A material of no specular (KHR_materials_specular's factor 0) thus reflects its base colour exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irradia.scene.types import Material
from irradia.transport.backend import dr, mi
from irradia.transport.textures import NO_TEXTURE, TextureTable

MAX_REFLECTANCE = 0.98
_ALPHA = {"opaque": 0, "mask": 1, "blend": 2}
_FLOATS_PER_ROW = 24
_SLOTS_PER_ROW = 8
DOUBLE_SIDED, UNLIT, EMISSIVE, FILTERS = 1, 2, 4, 8


@dataclass
class Appearance:
    """What a surface does with light at one point.

    Attributes:
        reflectance: ρ of the light that stops here, after alpha and transmission took their share.
        through: Share that passes unbent, coloured.
        coverage: Alpha after the alpha mode: the share of the surface that is there at all.
    """

    reflectance: mi.Color3f
    through: mi.Color3f
    coverage: mi.Float

    @property
    def pass_probability(self) -> mi.Float:
        """How often a ray is let through: by the energy that passes against what stays.

        A little is added to what stays, so that a surface that only emits is met too.
        """
        passes = dr.mean(self.through)
        stays = dr.mean(self.reflectance) + 0.05 * self.coverage
        return dr.select(passes > 0.0, passes / dr.maximum(passes + stays, 1e-20), 0.0)


class MaterialTable:
    """Every material's factors and texture slots, uploaded.

    Attributes:
        flags: (n_materials,) NumPy: DOUBLE_SIDED | UNLIT | EMISSIVE | FILTERS.
        clamped: (n_materials,) NumPy: whether the factors alone ask for more than MAX_REFLECTANCE.
    """

    def __init__(self, materials: tuple[Material, ...], textures: TextureTable) -> None:
        self._textures = textures
        self.flags = np.array([_flags(m) for m in materials], np.uint32)
        self.clamped = np.array([max(_constant_reflectance(m)) > MAX_REFLECTANCE for m in materials])
        slots = np.array([_slots(m, textures) for m in materials], np.uint32).reshape(-1, _SLOTS_PER_ROW)
        self._textured = slots.any(axis=0)
        self._floats = mi.Float(np.array([_floats(m) for m in materials], np.float32).ravel())
        self._slots = mi.UInt32(slots.ravel())
        self._device_flags = mi.UInt32(self.flags)

    def flags_of(self, material: mi.UInt32, active: mi.Bool) -> mi.UInt32:
        """The flag bits of each lane's material."""
        return dr.gather(mi.UInt32, self._device_flags, material, active)

    def emission(self, material: mi.UInt32, uv0: mi.Point2f, uv1: mi.Point2f, active: mi.Bool) -> mi.Color3f:
        """Emitted radiance."""
        value = self._rgb(material, 8, active)
        return value * self._texture(2, material, uv0, uv1, True, active).rgb if self._textured[2] else value

    def appearance(
        self, material: mi.UInt32, uv0: mi.Point2f, uv1: mi.Point2f, colour: mi.Vector4f, active: mi.Bool
    ) -> Appearance:
        """Reflectance and pass-through; ``colour`` is the interpolated vertex colour."""
        base, alpha = self._base(material, uv0, uv1, colour, active)
        metallic = self._float(material, 4, active)
        if self._textured[1]:
            metallic = metallic * self._texture(1, material, uv0, uv1, False, active).rgb.z
        transmission = self._float(material, 5, active)
        if self._textured[3]:
            transmission = transmission * self._texture(3, material, uv0, uv1, False, active).rgb.x
        transmission = transmission * (1.0 - metallic)

        fresnel = self._mean_fresnel(material, base, metallic, uv0, uv1, active)
        diffuse = base * (1.0 - metallic) * (1.0 - dr.max(fresnel))
        opaque = dr.minimum(diffuse * (1.0 - transmission) + fresnel, MAX_REFLECTANCE)
        unlit = (self.flags_of(material, active) & UNLIT) != 0
        reflectance = dr.select(unlit, 0.0, opaque * alpha)
        through = mi.Color3f(1.0 - alpha) + diffuse * (alpha * transmission)
        return Appearance(reflectance, through, alpha)

    def _base(
        self, material: mi.UInt32, uv0: mi.Point2f, uv1: mi.Point2f, colour: mi.Vector4f, active: mi.Bool
    ) -> tuple[mi.Color3f, mi.Float]:
        """Base colour, and the alpha that the alpha mode makes of it."""
        factor = dr.gather(mi.Vector4f, self._floats, material * (_FLOATS_PER_ROW // 4), active)
        base = mi.Color3f(factor.x, factor.y, factor.z) * mi.Color3f(colour.x, colour.y, colour.z)
        alpha = factor.w * colour.w
        if self._textured[0]:
            texel = self._texture(0, material, uv0, uv1, True, active)
            base, alpha = base * texel.rgb, alpha * texel.alpha
        mode = self._float(material, 6, active)
        cutoff = self._float(material, 7, active)
        masked = dr.select(alpha >= cutoff, mi.Float(1.0), 0.0)
        return base, dr.select(mode == 0.0, 1.0, dr.select(mode == 1.0, masked, dr.clip(alpha, 0.0, 1.0)))

    def _mean_fresnel(
        self,
        material: mi.UInt32,
        base: mi.Color3f,
        metallic: mi.Float,
        uv0: mi.Point2f,
        uv1: mi.Point2f,
        active: mi.Bool,
    ) -> mi.Color3f:
        """F̄: the cosine-weighted mean of Schlick's Fresnel term."""
        weight = self._float(material, 11, active)
        dielectric = self._rgb(material, 12, active)
        if self._textured[4]:
            weight = weight * self._texture(4, material, uv0, uv1, False, active).alpha
        if self._textured[5]:
            dielectric = dielectric * self._texture(5, material, uv0, uv1, True, active).rgb
        f0 = dr.lerp(dr.minimum(dielectric, 1.0) * weight, base, metallic)
        f90 = dr.lerp(weight, mi.Float(1.0), metallic)
        return f0 * (20.0 / 21.0) + f90 * (1.0 / 21.0)

    def _texture(
        self, column: int, material: mi.UInt32, uv0: mi.Point2f, uv1: mi.Point2f, srgb: bool, active: mi.Bool
    ):
        slot = dr.gather(mi.UInt32, self._slots, material * _SLOTS_PER_ROW + column, active)
        return self._textures.sample(slot, uv0, uv1, srgb=srgb, active=active)

    def _float(self, material: mi.UInt32, column: int, active: mi.Bool) -> mi.Float:
        return dr.gather(mi.Float, self._floats, material * _FLOATS_PER_ROW + column, active)

    def _rgb(self, material: mi.UInt32, column: int, active: mi.Bool) -> mi.Color3f:
        return mi.Color3f(*[self._float(material, column + i, active) for i in range(3)])


def _flags(m: Material) -> int:
    filters = m.alpha_mode != "opaque" or m.transmission > 0.0
    emits = max(m.emission) > 0.0
    return DOUBLE_SIDED * m.double_sided | UNLIT * m.unlit | EMISSIVE * emits | FILTERS * filters


def _floats(m: Material) -> list[float]:
    f0 = ((m.ior - 1.0) / (m.ior + 1.0)) ** 2 if m.ior > 0.0 else 1.0
    row = [*m.base_color, m.metallic, m.transmission, float(_ALPHA[m.alpha_mode]), m.alpha_cutoff]
    row += [*m.emission, m.specular, *(f0 * c for c in m.specular_color)]
    return row + [0.0] * (_FLOATS_PER_ROW - len(row))


def _slots(m: Material, textures: TextureTable) -> list[int]:
    used = [
        m.base_color_texture,
        m.metallic_roughness_texture,
        m.emission_texture,
        m.transmission_texture,
        m.specular_texture,
        m.specular_color_texture,
    ]
    row = [textures.add(t) for t in used]
    return row + [NO_TEXTURE] * (_SLOTS_PER_ROW - len(row))


def _constant_reflectance(m: Material) -> list[float]:
    """ρ from the factors alone, to warn about materials that would never let light die."""
    if m.unlit:
        return [0.0]
    f0 = ((m.ior - 1.0) / (m.ior + 1.0)) ** 2
    rho = []
    for base, tint in zip(m.base_color[:3], m.specular_color, strict=True):
        dielectric = min(f0 * tint, 1.0) * m.specular
        fresnel = (dielectric * (1 - m.metallic) + base * m.metallic) * 20 / 21
        fresnel += (m.specular * (1 - m.metallic) + m.metallic) / 21
        rho.append((1 - m.metallic) * base * (1 - fresnel) + fresnel)
    return rho if m.base_color_texture is None else [0.0]
