"""How much each triangle emits, textures averaged over the part of the image that it shows."""

from __future__ import annotations

import numpy as np

from irradia.core.colour import linear_from_srgb
from irradia.scene.merge import MergedMesh
from irradia.scene.types import F64, U8, Scene, TextureRef

_SPLITS = 8  # of an edge: each triangle is looked at in 64 equal parts
_TRIANGLES_AT_ONCE = 1 << 14


def triangle_emission(scene: Scene, mesh: MergedMesh) -> F64:
    """(T, 3) mean linear radiance of each triangle's front; 0 where rays don't meet it.

    A screen whose bright part one triangle shows and whose dark part another thus gives each its
    own. Alpha is not taken off.
    """
    factors = np.array([m.emission for m in scene.materials], np.float64).reshape(-1, 3)
    radiance = factors[mesh.material]
    for index, material in enumerate(scene.materials):
        if material.emission_texture is None or max(material.emission) <= 0.0:
            continue
        triangles = np.flatnonzero(mesh.material == index)
        pixels = scene.images[material.emission_texture.image].pixels
        radiance[triangles] *= _footprint_means(mesh, triangles, material.emission_texture, pixels)
    if mesh.casts is not None:
        radiance[~mesh.casts] = 0.0
    return radiance


def _footprint_means(mesh: MergedMesh, triangles: np.ndarray, texture: TextureRef, pixels: U8) -> F64:
    """(N, 3) mean of an image over each triangle's own stretch of it."""
    levels = _box_levels(pixels)
    uv_from_texcoord = np.array(texture.uv_from_texcoord)
    means = np.empty((len(triangles), 3))
    for first in range(0, len(triangles), _TRIANGLES_AT_ONCE):
        part = triangles[first : first + _TRIANGLES_AT_ONCE]
        corners = mesh.texcoords[mesh.indices[part], texture.texcoord & 1].astype(np.float64)
        corners = corners @ uv_from_texcoord[:, :2].T + uv_from_texcoord[:, 2]
        means[first : first + len(part)] = _mean_in(levels, corners, texture)
    return means


def _mean_in(levels: list[np.ndarray], corners: F64, texture: TextureRef) -> F64:
    """Each part of a triangle takes the pixel at its centre from the level where pixels are as large
    as the part, so that no bright spot falls between.
    """
    height, width = levels[0].shape[:2]
    edges = (corners - np.roll(corners, 1, axis=1)) * (width, height)
    part_px = np.linalg.norm(edges, axis=2).max(axis=1) / _SPLITS
    level = np.clip(np.ceil(np.log2(np.maximum(part_px, 1.0))), 0, len(levels) - 1).astype(int)
    places = np.einsum("pk,nkc->npc", _part_centres(), corners)
    means = np.empty((len(corners), 3))
    for number in np.unique(level):
        chosen = level == number
        image = levels[number]
        rows, columns = image.shape[:2]
        x = _wrapped(places[chosen, :, 0], columns, texture.wrap_s)
        y = _wrapped(places[chosen, :, 1], rows, texture.wrap_t)
        means[chosen] = image[y, x].mean(axis=1, dtype=np.float64)
    return means


def _part_centres() -> F64:
    """(64, 3) barycentric centres of the equal triangles that a grid cuts a triangle into."""
    i, j = np.meshgrid(np.arange(_SPLITS), np.arange(_SPLITS), indexing="ij")
    upright = np.stack([i + 1 / 3, j + 1 / 3], axis=-1)[i + j < _SPLITS]
    turned = np.stack([i + 2 / 3, j + 2 / 3], axis=-1)[i + j < _SPLITS - 1]
    b = np.concatenate([upright, turned]) / _SPLITS
    return np.concatenate([1.0 - b.sum(axis=1, keepdims=True), b], axis=1)


def _box_levels(pixels: U8) -> list[np.ndarray]:
    """Linear RGB at full size, then halved until one pixel is left."""
    decoded = linear_from_srgb(np.arange(256, dtype=np.float32) / 255.0)
    levels = [decoded[pixels[..., :3]]]
    while max(levels[-1].shape[:2]) > 1:
        image = levels[-1]
        odd = [(0, size % 2 if size > 1 else 0) for size in image.shape[:2]]
        image = np.pad(image, (*odd, (0, 0)), mode="edge")
        for axis in (0, 1):
            if image.shape[axis] > 1:
                first, second = (image.take(range(k, image.shape[axis], 2), axis) for k in (0, 1))
                image = (first + second) * np.float32(0.5)
        levels.append(image)
    return levels


def _wrapped(position: F64, size: int, mode: str) -> np.ndarray:
    """Pixel numbers of positions in units of the image."""
    if mode == "repeat":
        position = position % 1.0
    elif mode == "mirror":
        position = 1.0 - np.abs(position % 2.0 - 1.0)
    return np.clip(np.floor(position * size), 0, size - 1).astype(int)
