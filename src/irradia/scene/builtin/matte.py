"""Materials of the small scenes."""

from __future__ import annotations

from irradia.scene.types import Material, Rgb


def matte(
    name: str, reflectance: Rgb, *, emission: Rgb = (0.0, 0.0, 0.0), double_sided: bool = False
) -> Material:
    """A purely diffuse material: not metallic and without a specular coat, so that ρ is exact."""
    return Material(
        name,
        base_color=(*reflectance, 1.0),
        metallic=0.0,
        specular=0.0,
        emission=emission,
        double_sided=double_sided,
    )
