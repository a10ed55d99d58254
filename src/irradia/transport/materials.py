"""Materials as one table: what a surface reflects, emits and lets through, for diffuse transport.

The diffuse transport of Irradia replaces a material by its reflectance ρ: the share of cosine-
distributed light that it reflects, diffuse and specular together. With Schlick's Fresnel term,
whose cosine-weighted mean is F0·20/21 + F90/21, and multiple scattering between microfacets
compensated, so that roughness doesn't matter:

    ρ = (1 − metallic) · base · (1 − max F̄) + F̄

A material of no specular (KHR_materials_specular's factor 0) thus reflects its base colour exactly.

Diffuse transmission sends a share of the diffuse part through the surface; see docs/surfaces.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irradia.scene.types import Material
from irradia.transport.backend import dr, mi
from irradia.transport.textures import Footprint, Rgba, TextureTable

MAX_REFLECTANCE = 0.98
_ALPHA = {"opaque": 0, "mask": 1, "blend": 2}
_FLOATS_PER_ROW = 24
# A material's texture slots: the field of Material, and whether RGB is an sRGB-coded colour.
_COLUMNS = (
    ("base_color_texture", True),
    ("metallic_roughness_texture", False),
    ("emission_texture", True),
    ("transmission_texture", False),
    ("specular_texture", False),
    ("specular_color_texture", True),
    ("diffuse_transmission_texture", False),
    ("diffuse_transmission_color_texture", True),
)
_BASE, _METALLIC, _EMISSION, _TRANSMISSION, _SPECULAR, _SPECULAR_COLOR = range(6)
_DIFFUSE_TRANSMISSION, _DIFFUSE_TRANSMISSION_COLOR = 6, 7
DOUBLE_SIDED, UNLIT, EMISSIVE, FILTERS, TRANSLUCENT = 1, 2, 4, 8, 32
_MAX_SIDE_RATIO = 16.0  # light from behind counts at most this much more than a dark surface's own


@dataclass
class Appearance:
    """What a surface does with light at one point.

    Attributes:
        reflectance: ρ of the light that stops here, after alpha and transmission took their share; what
            a lightmap's E/π is multiplied by. Diffuse transmission doesn't lower it.
        through: Share that passes unbent, coloured.
        coverage: Alpha after the alpha mode: the share of the surface that is there at all.
        reflected, transmitted: R and T: the shares that leave diffusely on the side where light came
            from, and on the other.
    """

    reflectance: mi.Color3f
    through: mi.Color3f
    coverage: mi.Float
    reflected: mi.Color3f
    transmitted: mi.Color3f

    @property
    def pass_probability(self) -> mi.Float:
        """How often a ray is let through: by the energy that passes against what stays.

        A little is added to what stays, so that a surface that only emits is met too.
        """
        passes = dr.mean(self.through)
        stays = dr.mean(self.reflected + self.transmitted) + 0.05 * self.coverage
        return dr.select(passes > 0.0, passes / dr.maximum(passes + stays, 1e-20), 0.0)


@dataclass
class _Lookup:
    """Where a material is asked for its looks."""

    material: mi.UInt32
    uv0: mi.Point2f
    uv1: mi.Point2f
    active: mi.Bool
    footprint: Footprint | None = None


class MaterialTable:
    """Every material's factors and texture slots, uploaded.

    Attributes:
        flags: (n_materials,) NumPy: DOUBLE_SIDED | UNLIT | EMISSIVE | FILTERS | TRANSLUCENT.
        clamped: (n_materials,) NumPy: whether the factors alone ask for more than MAX_REFLECTANCE.
    """

    def __init__(self, materials: tuple[Material, ...], textures: TextureTable) -> None:
        self._textures = textures
        self.flags = np.array([_flags(m) for m in materials], np.uint32)
        self.clamped = np.array([max(_constant_reflectance(m)) > MAX_REFLECTANCE for m in materials])
        slots = np.array([_slots(m, textures) for m in materials], np.uint32).reshape(-1, len(_COLUMNS))
        self._textured = slots.any(axis=0)
        self._translucent = bool((self.flags & TRANSLUCENT).any())
        self._floats = mi.Float(np.array([_floats(m) for m in materials], np.float32).ravel())
        self._slots = mi.UInt32(slots.ravel())
        self._device_flags = mi.UInt32(self.flags)

    def flags_of(self, material: mi.UInt32, active: mi.Bool) -> mi.UInt32:
        """The flag bits of each lane's material."""
        return dr.gather(mi.UInt32, self._device_flags, material, active)

    def emission(self, material: mi.UInt32, uv0: mi.Point2f, uv1: mi.Point2f, active: mi.Bool) -> mi.Color3f:
        """Emitted radiance."""
        at = _Lookup(material, uv0, uv1, active)
        value = self._rgb(at, 8)
        return value * self._texture(at, _EMISSION).rgb if self._textured[_EMISSION] else value

    def appearance(
        self,
        material: mi.UInt32,
        uv0: mi.Point2f,
        uv1: mi.Point2f,
        colour: mi.Vector4f,
        active: mi.Bool,
        footprint: Footprint | None = None,
    ) -> Appearance:
        """Reflectance and pass-through.

        Args:
            material: By lane.
            uv0: First texture coordinate set.
            uv1: Second set.
            colour: The interpolated vertex colour.
            active: Lanes that need a value.
            footprint: What the lookup stands for; only with textures that have mip levels.
        """
        at = _Lookup(material, uv0, uv1, active, footprint)
        base, alpha = self._base(at, colour)
        metallic = self._float(at, 4)
        if self._textured[_METALLIC]:
            metallic = metallic * self._texture(at, _METALLIC).rgb.z
        transmission = self._float(at, 5)
        if self._textured[_TRANSMISSION]:
            transmission = transmission * self._texture(at, _TRANSMISSION).rgb.x
        transmission = transmission * (1.0 - metallic)

        fresnel = self._mean_fresnel(at, base, metallic)
        diffuse = base * (1.0 - metallic) * (1.0 - dr.max(fresnel))
        opaque = dr.minimum(diffuse * (1.0 - transmission) + fresnel, MAX_REFLECTANCE)
        unlit = (self.flags_of(material, active) & UNLIT) != 0
        reflectance = dr.select(unlit, 0.0, opaque * alpha)
        through = mi.Color3f(1.0 - alpha) + diffuse * (alpha * transmission)
        looks = Appearance(reflectance, through, alpha, reflected=reflectance, transmitted=mi.Color3f(0.0))
        if self._translucent:
            stays = (1.0 - metallic) * (1.0 - transmission) * (1.0 - dr.max(fresnel))
            share, tint = self._diffuse_transmission(at)
            self._split(looks, base * (stays * (1.0 - share)) + fresnel, tint * (stays * share), ~unlit)
        return looks

    def _base(self, at: _Lookup, colour: mi.Vector4f) -> tuple[mi.Color3f, mi.Float]:
        """Base colour, and the alpha that the alpha mode makes of it."""
        factor = dr.gather(mi.Vector4f, self._floats, at.material * (_FLOATS_PER_ROW // 4), at.active)
        base = mi.Color3f(factor.x, factor.y, factor.z) * mi.Color3f(colour.x, colour.y, colour.z)
        alpha = factor.w * colour.w
        if self._textured[_BASE]:
            texel = self._texture(at, _BASE)
            base, alpha = base * texel.rgb, alpha * texel.alpha
        mode = self._float(at, 6)
        cutoff = self._float(at, 7)
        masked = dr.select(alpha >= cutoff, mi.Float(1.0), 0.0)
        return base, dr.select(mode == 0.0, 1.0, dr.select(mode == 1.0, masked, dr.clip(alpha, 0.0, 1.0)))

    def _mean_fresnel(self, at: _Lookup, base: mi.Color3f, metallic: mi.Float) -> mi.Color3f:
        """F̄: the cosine-weighted mean of Schlick's Fresnel term."""
        weight = self._float(at, 11)
        dielectric = self._rgb(at, 12)
        if self._textured[_SPECULAR]:
            weight = weight * self._texture(at, _SPECULAR).alpha
        if self._textured[_SPECULAR_COLOR]:
            dielectric = dielectric * self._texture(at, _SPECULAR_COLOR).rgb
        f0 = dr.lerp(dr.minimum(dielectric, 1.0) * weight, base, metallic)
        f90 = dr.lerp(weight, mi.Float(1.0), metallic)
        return f0 * (20.0 / 21.0) + f90 * (1.0 / 21.0)

    def _diffuse_transmission(self, at: _Lookup) -> tuple[mi.Float, mi.Color3f]:
        """Share of the diffuse part that goes through, and its colour."""
        share, tint = self._float(at, 15), self._rgb(at, 16)
        if self._textured[_DIFFUSE_TRANSMISSION]:
            share = share * self._texture(at, _DIFFUSE_TRANSMISSION).alpha
        if self._textured[_DIFFUSE_TRANSMISSION_COLOR]:
            tint = tint * self._texture(at, _DIFFUSE_TRANSMISSION_COLOR).rgb
        return share, dr.minimum(tint, 1.0)

    @staticmethod
    def _split(looks: Appearance, reflected: mi.Color3f, transmitted: mi.Color3f, lit: mi.Bool) -> None:
        """Sets R and T of a surface; together they stay below the limit of reflectance."""
        scale = dr.minimum(MAX_REFLECTANCE / dr.maximum(reflected + transmitted, 1e-6), 1.0) * looks.coverage
        looks.reflected = dr.select(lit, reflected * scale, 0.0)
        looks.transmitted = dr.select(lit, transmitted * scale, 0.0)
        looks.reflectance = dr.maximum(looks.reflectance, looks.transmitted * (1.0 / _MAX_SIDE_RATIO))

    def _texture(self, at: _Lookup, column: int) -> Rgba:
        slot = dr.gather(mi.UInt32, self._slots, at.material * len(_COLUMNS) + column, at.active)
        srgb = _COLUMNS[column][1]
        return self._textures.sample(
            slot, at.uv0, at.uv1, srgb=srgb, active=at.active, footprint=at.footprint
        )

    def _float(self, at: _Lookup, column: int) -> mi.Float:
        return dr.gather(mi.Float, self._floats, at.material * _FLOATS_PER_ROW + column, at.active)

    def _rgb(self, at: _Lookup, column: int) -> mi.Color3f:
        return mi.Color3f(*[self._float(at, column + i) for i in range(3)])


def _flags(m: Material) -> int:
    filters = m.alpha_mode != "opaque" or m.transmission > 0.0
    emits = max(m.emission) > 0.0
    shines_through = m.diffuse_transmission * max(m.diffuse_transmission_color) > 0.0 and not m.unlit
    return (
        DOUBLE_SIDED * m.double_sided
        | UNLIT * m.unlit
        | EMISSIVE * emits
        | FILTERS * filters
        | TRANSLUCENT * shines_through
    )


def _floats(m: Material) -> list[float]:
    f0 = ((m.ior - 1.0) / (m.ior + 1.0)) ** 2 if m.ior > 0.0 else 1.0
    row = [*m.base_color, m.metallic, m.transmission, float(_ALPHA[m.alpha_mode]), m.alpha_cutoff]
    row += [*m.emission, m.specular, *(f0 * c for c in m.specular_color)]
    row += [m.diffuse_transmission, *m.diffuse_transmission_color]
    return row + [0.0] * (_FLOATS_PER_ROW - len(row))


def _slots(m: Material, textures: TextureTable) -> list[int]:
    return [textures.add(getattr(m, field), srgb=srgb) for field, srgb in _COLUMNS]


def _constant_reflectance(m: Material) -> list[float]:
    """ρ from the factors alone, to warn about materials that would never let light die."""
    if m.unlit:
        return [0.0]
    f0 = ((m.ior - 1.0) / (m.ior + 1.0)) ** 2
    rho = []
    for base, through, tint in zip(
        m.base_color[:3], m.diffuse_transmission_color, m.specular_color, strict=True
    ):
        dielectric = min(f0 * tint, 1.0) * m.specular
        fresnel = (dielectric * (1 - m.metallic) + base * m.metallic) * 20 / 21
        fresnel += (m.specular * (1 - m.metallic) + m.metallic) / 21
        leaves = base + (min(through, 1.0) - base) * m.diffuse_transmission
        rho.append((1 - m.metallic) * leaves * (1 - fresnel) + fresnel)
    return rho if m.base_color_texture is None else [0.0]
