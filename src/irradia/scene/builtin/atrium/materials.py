"""The atrium's materials; textures are made once and shared."""

from __future__ import annotations

from dataclasses import dataclass

from irradia.scene.builtin import textures
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.cards import leaf_texture
from irradia.scene.types import Material, Rgb, TextureRef

CLOTH_COLOURS: dict[str, Rgb] = {
    "crimson": (0.72, 0.035, 0.045),
    "ultramarine": (0.04, 0.09, 0.62),
    "saffron": (0.92, 0.42, 0.03),
    "emerald": (0.03, 0.42, 0.17),
    "violet": (0.34, 0.05, 0.42),
}

FRESCO_COLOURS: dict[str, Rgb] = {
    "red": (0.62, 0.15, 0.10),
    "green": (0.24, 0.40, 0.30),
    "ochre": (0.95, 0.66, 0.32),
}
"""Factors on the plaster's texture."""

LANTERN_RADIANCE: Rgb = (60000.0, 34000.0, 12000.0)
"""Candle glass in cd/m²: bright enough to show beside the sun's 90 klx."""


@dataclass(frozen=True)
class Materials:
    """Material indices of the document; ``cloth`` and ``fresco`` by colour name."""

    plaster: int
    limestone: int
    ashlar: int
    brick: int
    white_marble: int
    red_marble: int
    green_marble: int
    court_floor: int
    tile: int
    terracotta: int
    wood: int
    bronze: int
    glass: int
    water: int
    leaves: int
    bark: int
    soil: int
    lantern: int
    cloth: dict[str, int]
    fresco: dict[str, int]


def add_materials(scene: SceneBuilder) -> Materials:
    """Adds every material of the atrium to ``scene``."""

    def stone(name: str, texture: TextureRef, tile_m: float, roughness: float) -> int:
        return scene.material(
            Material(name, base_color_texture=texture, metallic=0.0, roughness=roughness), tile_m=tile_m
        )

    def plain(name: str, rgb: Rgb, roughness: float, metallic: float = 0.0) -> int:
        return scene.material(Material(name, base_color=(*rgb, 1.0), metallic=metallic, roughness=roughness))

    weave = scene.texture("cloth", textures.cloth())
    lime = scene.texture("plaster", textures.plaster())
    return Materials(
        plaster=stone("plaster", lime, 3.2, 0.95),
        limestone=stone("limestone", scene.texture("limestone", textures.limestone()), 1.8, 0.85),
        ashlar=stone("ashlar", scene.texture("ashlar", textures.ashlar()), 1.6, 0.85),
        brick=stone("brick", scene.texture("brick", textures.brick()), 1.2, 0.9),
        white_marble=stone("white marble", scene.texture("white marble", textures.white_marble()), 2.0, 0.3),
        red_marble=stone("red marble", scene.texture("red marble", textures.red_marble()), 1.5, 0.25),
        green_marble=stone("green marble", scene.texture("green marble", textures.green_marble()), 1.5, 0.25),
        court_floor=stone("court floor", scene.texture("court floor", textures.court_floor()), 2.9, 0.3),
        tile=stone("tile", scene.texture("tile", textures.tile()), 1.6, 0.6),
        terracotta=plain("terracotta", (0.42, 0.17, 0.085), 0.8),
        wood=stone("wood", scene.texture("wood", textures.wood()), 0.8, 0.7),
        bronze=plain("bronze", (0.30, 0.21, 0.11), 0.45, metallic=1.0),
        glass=_glass(scene),
        water=plain("water", (0.02, 0.07, 0.075), 0.05),
        leaves=_leaves(scene),
        bark=plain("bark", (0.20, 0.14, 0.09), 0.9),
        soil=plain("soil", (0.07, 0.045, 0.03), 1.0),
        lantern=scene.material(
            Material(
                "lantern glass",
                base_color=(0.8, 0.7, 0.5, 1.0),
                metallic=0.0,
                roughness=0.4,
                emission=LANTERN_RADIANCE,
            )
        ),
        cloth={name: _cloth(scene, name, rgb, weave) for name, rgb in CLOTH_COLOURS.items()},
        fresco={name: _fresco(scene, name, rgb, lime) for name, rgb in FRESCO_COLOURS.items()},
    )


def _cloth(scene: SceneBuilder, name: str, rgb: Rgb, weave: TextureRef) -> int:
    material = Material(
        f"{name} cloth",
        base_color=(*rgb, 1.0),
        base_color_texture=weave,
        metallic=0.0,
        roughness=0.95,
        specular=0.3,
    )
    return scene.material(material, tile_m=0.9)


def _fresco(scene: SceneBuilder, name: str, rgb: Rgb, plaster: TextureRef) -> int:
    material = Material(
        f"{name} fresco",
        base_color=(*rgb, 1.0),
        base_color_texture=plaster,
        metallic=0.0,
        roughness=0.9,
    )
    return scene.material(material, tile_m=3.2)


def _glass(scene: SceneBuilder) -> int:
    return scene.material(
        Material(
            "stained glass",
            base_color_texture=scene.texture("stained glass", textures.stained_glass()),
            metallic=0.0,
            roughness=0.0,
            transmission=1.0,
            double_sided=True,
        ),
        tile_m=1.5,
    )


def _leaves(scene: SceneBuilder) -> int:
    return scene.material(
        Material(
            "leaves",
            base_color_texture=scene.texture("leaves", leaf_texture()),
            metallic=0.0,
            roughness=0.8,
            alpha_mode="mask",
            double_sided=True,
        ),
        tile_m=0.36,
    )
