"""Vertex data in floats, morph targets blended in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.gltf.stored import StoredPrimitive
from irradia.scene.types import F32, U32

_COMPONENTS = {"POSITION": (3,), "NORMAL": (3,), "TEXCOORD": (2,), "COLOR": (3, 4)}


@dataclass(frozen=True)
class Vertices:
    """A primitive's vertices in object space.

    Attributes:
        positions: (V, 3).
        normals: (V, 3), not yet unit, or None.
        texcoords: Each (V, 2).
        colors: (V, 4) linear, or None.
        tangents: (V, 4), or None where the file has none that hold in this pose.
    """

    positions: F32
    normals: F32 | None
    texcoords: tuple[F32, ...]
    colors: F32 | None
    tangents: F32 | None = None

    def take(self, source: U32) -> Vertices:
        """The vertices numbered ``source``, in that order."""
        return Vertices(
            self.positions[source],
            None if self.normals is None else self.normals[source],
            tuple(texcoord[source] for texcoord in self.texcoords),
            None if self.colors is None else self.colors[source],
            None if self.tangents is None else self.tangents[source],
        )

    def moved(self, positions: F32, normals: F32 | None) -> Vertices:
        """The same vertices elsewhere, their tangents lost."""
        return replace(self, positions=positions, normals=normals, tangents=None)


def blend_vertices(stored: StoredPrimitive, weights: tuple[float, ...]) -> Vertices:
    """The primitive's vertices with its morph targets added at ``weights``.

    Raises:
        InputError: A value is not finite, or an attribute has the wrong number of components.
    """
    n_texcoords = sum(1 for _ in _numbered(stored, "TEXCOORD"))
    normals = _blend(stored, "NORMAL", weights) if "NORMAL" in stored.attributes else None
    colors = _blend(stored, "COLOR_0", weights) if "COLOR_0" in stored.attributes else None
    if colors is not None and colors.shape[1] == 3:
        colors = np.column_stack([colors, np.ones(len(colors), np.float32)])
    return Vertices(
        positions=_blend(stored, "POSITION", weights),
        normals=normals,
        texcoords=tuple(_blend(stored, f"TEXCOORD_{i}", weights) for i in range(n_texcoords)),
        colors=None if colors is None else np.clip(colors, 0.0, 1.0),
        tangents=None if normals is None or any(weights) else _tangents(stored),
    )


def morph_weights(stored: StoredPrimitive, weights: tuple[float, ...]) -> tuple[float, ...]:
    """One weight for each target: the first ones of ``weights``, or 0.

    Raises:
        InputError: There are more weights than targets.
    """
    n_targets = len(stored.targets)
    if weights and n_targets and len(weights) != n_targets:
        raise InputError(
            f"expected {n_targets} morph weights, found {len(weights)}", where=f"{stored.pointer}/targets"
        )
    return weights if n_targets and weights else (0.0,) * n_targets


def _blend(stored: StoredPrimitive, name: str, weights: tuple[float, ...]) -> F32:
    components = _COMPONENTS[name.partition("_")[0]]
    values = stored.attributes[name].floats(*components)
    for weight, target in zip(weights, stored.targets, strict=True):
        if weight and name in target:
            values += np.float32(weight) * target[name].floats(values.shape[1])
    return values


def _tangents(stored: StoredPrimitive) -> F32 | None:
    """The file's tangents where they are usable; they can always be derived, so bad ones are no error."""
    tangents = stored.attributes.get("TANGENT")
    if tangents is None or tangents.values.shape[1] != 4 or not np.isfinite(tangents.values).all():
        return None
    return tangents.floats(4)


def _numbered(stored: StoredPrimitive, name: str) -> Iterator[str]:
    """NAME_0, NAME_1 … for as long as the primitive has them."""
    index = 0
    while f"{name}_{index}" in stored.attributes:
        yield f"{name}_{index}"
        index += 1
