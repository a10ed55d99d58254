"""How much each light source matters: mean unoccluded irradiance, by formula, without rays.

Good to a factor of a few, which is what it takes to notice a lamp in watts beside a sun in lux.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from irradia.core.colour import linear_from_srgb, luminance
from irradia.scene.environment import mean_radiance
from irradia.scene.light_profile import light_candela
from irradia.scene.merge import MergedMesh
from irradia.scene.surface import SurfaceSamples, sample_surface, triangle_areas
from irradia.scene.types import F64, Light, Material, Rgb, Scene

N_SAMPLES = 4096
MAX_CONTRAST = 1e4
NEAREST_SHARE_OF_SIZE = 0.01  # a lamp that touches a surface would count without bound

SourceKind = Literal["directional", "point", "spot", "emissive", "environment"]


@dataclass(frozen=True)
class SourceEstimate:
    """One light source's share.

    Attributes:
        mean_irradiance_rgb: E averaged over the scene's surfaces, nothing in the way: lux where
            lights are photometric, else W·m⁻².
    """

    kind: SourceKind
    name: str
    mean_irradiance_rgb: Rgb

    @property
    def mean_irradiance(self) -> float:
        """Rec.709 luminance of the mean."""
        return float(luminance(self.mean_irradiance_rgb))


def estimate_sources(scene: Scene, mesh: MergedMesh) -> tuple[SourceEstimate, ...]:
    """Every source, the strongest first; equally strong ones in the scene's order."""
    samples = sample_surface(mesh, N_SAMPLES)
    sources = [*_lights(scene, samples), *_emitters(scene, mesh)]
    if scene.environment is not None:
        irradiance = np.pi * mean_radiance(scene.environment)
        sources.append(SourceEstimate("environment", scene.environment.name, _rgb(irradiance)))
    return tuple(sorted(sources, key=lambda source: -source.mean_irradiance))


def contrast_warning(sources: tuple[SourceEstimate, ...]) -> str | None:
    """A remark where sources that emit anything differ by more than 10⁴."""
    lit = [source for source in sources if source.mean_irradiance > 0.0]
    if not lit:
        return None
    strongest = max(lit, key=lambda source: source.mean_irradiance)
    weakest = min(lit, key=lambda source: source.mean_irradiance)
    ratio = strongest.mean_irradiance / weakest.mean_irradiance
    if ratio <= MAX_CONTRAST:
        return None
    return (
        f"{strongest.kind} {strongest.name!r} is {ratio:.1e} times as strong as {weakest.kind}"
        f" {weakest.name!r}: are both in the same units (lux and candela)?"
    )


def _lights(scene: Scene, samples: SurfaceSamples) -> Iterator[SourceEstimate]:
    if len(samples.positions) == 0:
        return
    size = float(np.linalg.norm(np.ptp(samples.positions, axis=0)))
    for index, light in enumerate(scene.lights):
        if light.mode == "off":
            continue
        factor = (
            _directional(light, samples) if light.kind == "directional" else _punctual(light, samples, size)
        )
        irradiance = np.asarray(light.intensity) * factor
        yield SourceEstimate(light.kind, light.name or f"light {index}", _rgb(irradiance))


def _directional(light: Light, samples: SurfaceSamples) -> float:
    """Mean clamped cosine."""
    return float(np.maximum(samples.normals @ -np.asarray(light.direction), 0.0).mean())


def _punctual(light: Light, samples: SurfaceSamples, size: float) -> float:
    """Mean of cosine over squared distance, in the cone and range where there is one."""
    to_light = np.asarray(light.position) - samples.positions
    distance = np.maximum(np.linalg.norm(to_light, axis=1), NEAREST_SHARE_OF_SIZE * size)
    direction = to_light / distance[:, None]
    factor = np.maximum(np.einsum("nk,nk->n", direction, samples.normals), 0.0) / distance**2
    if light.profile is not None:
        factor = factor * light_candela(light, -direction)
    elif light.kind == "spot":
        factor = factor * _cone(light, -direction @ np.asarray(light.direction))
    if light.range_m is not None:
        factor = factor * np.clip(1.0 - (distance / light.range_m) ** 4, 0.0, 1.0)
    return float(factor.mean())


def _cone(light: Light, cosine: F64) -> F64:
    """KHR_lights_punctual's falloff between the inner and the outer cone."""
    inner, outer = np.cos(light.inner_cone_rad), np.cos(light.outer_cone_rad)
    return np.clip((cosine - outer) / max(inner - outer, 1e-3), 0.0, 1.0) ** 2


def _emitters(scene: Scene, mesh: MergedMesh) -> Iterator[SourceEstimate]:
    """Per material: its power, π · radiance · area, spread over all surfaces."""
    areas = np.bincount(mesh.material, triangle_areas(mesh), minlength=len(scene.materials))
    for index, material in enumerate(scene.materials):
        if areas[index] <= 0.0 or max(material.emission) <= 0.0:
            continue
        emitting = areas[index] * (2.0 if material.double_sided else 1.0)
        radiance = np.asarray(material.emission) * _mean_emission_texture(scene, material)
        irradiance = np.pi * radiance * emitting / areas.sum()
        yield SourceEstimate("emissive", material.name or f"material {index}", _rgb(irradiance))


def _mean_emission_texture(scene: Scene, material: Material) -> F64:
    """(3,) linear mean of the whole image, wherever the texture coordinates lie in it."""
    if material.emission_texture is None:
        return np.ones(3)
    pixels = scene.images[material.emission_texture.image].pixels
    decoded = linear_from_srgb(np.arange(256) / 255.0).astype(np.float64)
    counts = [np.bincount(pixels[..., channel].ravel(), minlength=256) for channel in range(3)]
    return np.array([count @ decoded for count in counts]) / (pixels.shape[0] * pixels.shape[1])


def _rgb(values: F64) -> Rgb:
    return (float(values[0]), float(values[1]), float(values[2]))
