"""Scenes: glTF in, and what the bake needs of it out.

Only the types are here at once; loading lives in :mod:`irradia.scene.load`.
"""

from irradia.scene.types import (
    Camera,
    Environment,
    Image,
    Instance,
    Light,
    Material,
    Primitive,
    Scene,
    TextureRef,
)

__all__ = [
    "Camera",
    "Environment",
    "Image",
    "Instance",
    "Light",
    "Material",
    "Primitive",
    "Scene",
    "TextureRef",
]
