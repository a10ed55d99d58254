"""From accumulated moments to finished directional maps: denoise, fill, close seams, dilate, encode.

Signed moments are denoised as light: beside R₀ = ∫ L dω / 4π stands R₀ plus the moment of an axis,
∫ L (1 + ω) dω / 4π, which is never negative, noise included, and about as bright. The filter keeps
every chart's mean of both, so that the difference keeps its mean too. Maps are encoded last, texel by
texel beside the finished plain map: what no light can have, a mean direction longer than 1 or one that
contradicts the plain map, is put right there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.bake.denoise import denoise as remove_noise
from irradia.bake.dilate import dilate
from irradia.bake.directional_modes import MODES, DirectionalName
from irradia.bake.finish import Finisher, FinishOptions
from irradia.bake.texels import TexelSet
from irradia.core.colour import luminance
from irradia.core.progress import Progress
from irradia.scene.merge import MergedMesh
from irradia.scene.types import F32

_BAND_TEXELS = 1 << 18  # encoded at a time, so that large pages need no copies in double precision


@dataclass(frozen=True)
class DirectionalMaps:
    """What a directional mode adds to the plain lightmap.

    Attributes:
        mode: Which.
        pages: By map name, (P, H, W, 3) float32; see ``DirectionalMode.maps``.
    """

    mode: DirectionalName
    pages: dict[str, NDArray[np.float32]]


def finish_directional(
    mode: DirectionalName,
    texels: TexelSet,
    plain_pages: F32,
    moments: F32,
    normals: F32,
    valid: NDArray[np.bool_],
    *,
    denoise: bool,
    progress: Progress,
    finisher: Finisher | None = None,
) -> DirectionalMaps:
    """Makes the maps of a directional mode, consistent with the finished plain map.

    Args:
        mode: Which.
        texels: The covered texels.
        plain_pages: (P, H, W, 3) E/π, finished.
        moments: (N, k, 3) means of the mode's moments.
        normals: (N, 3) from :func:`texel_normals`.
        valid: (N,) False where texels take light from their chart.
        denoise: Whether to remove noise.
        progress: Shows the stages of the finisher.
        finisher: What finished the plain map, if it did more than remove noise.
    """
    finisher = finisher or Finisher(texels, valid, FinishOptions(denoise=denoise), progress)
    n_moments = moments.shape[1]

    def denoiser(values: F32, kept: TexelSet) -> F32:
        clean = denoise_directional(mode, values.reshape(-1, n_moments, 3), kept, progress)
        return clean.reshape(values.shape)

    finished = finisher.companion(
        moments.reshape(-1, 3 * n_moments),
        plain_pages,
        denoiser=denoiser,
        close_seams=not MODES[mode].tangent_space,  # across one, tangents may turn
    )
    return DirectionalMaps(mode, _encode(mode, plain_pages, finished, dilate(normals, texels)))


def _encode(mode: DirectionalName, plain_pages: F32, moments: F32, normals: F32) -> dict[str, F32]:
    """All pages, band by band."""
    maps = {name: np.empty_like(plain_pages) for name in MODES[mode].maps}
    plain, own = plain_pages.reshape(-1, 3), normals.reshape(-1, 3)
    rows = moments.reshape(len(plain), -1, 3)
    for first in range(0, len(plain), _BAND_TEXELS):
        band = slice(first, first + _BAND_TEXELS)
        unit = own[band] / np.maximum(np.linalg.norm(own[band], axis=1, keepdims=True), 1e-20)
        encoded = MODES[mode].encode(
            plain[band].astype(np.float64), rows[band].astype(np.float64), unit.astype(np.float64)
        )
        for name, values in encoded.items():
            maps[name].reshape(-1, 3)[band] = values
    return maps


def denoise_directional(mode: DirectionalName, moments: F32, texels: TexelSet, progress: Progress) -> F32:
    """Removes the noise of (N, k, 3) moments; chart means stay.

    Raises:
        MissingDependencyError: The denoiser is not installed or doesn't load here.
    """

    def clean(values: F32) -> F32:
        return remove_noise(np.ascontiguousarray(np.maximum(values, 0.0), np.float32), texels, progress)

    if MODES[mode].moments == "rnm":
        return np.stack([clean(moments[:, k]) for k in range(moments.shape[1])], axis=1)
    mean = moments[:, 0]
    clean_mean = clean(mean)
    if MODES[mode].moments == "sh":
        signed = [clean(mean + moments[:, k]) - clean_mean for k in (1, 2, 3)]
    else:
        grey, clean_grey = luminance(mean)[:, None], luminance(clean_mean)[:, None]
        signed = [clean(grey + moments[:, 1]) - clean_grey]
    return np.stack([clean_mean, *signed], axis=1)


def texel_normals(mesh: MergedMesh, texels: TexelSet) -> F32:
    """(N, 3) mean vertex normal over each texel's sub-samples, unit: the surface's own normal."""
    result = np.empty((len(texels.pixel), 3), np.float32)
    for first in range(0, len(result), _BAND_TEXELS // 8):
        band = np.arange(first, min(first + _BAND_TEXELS // 8, len(result)))
        triangle, weights = texels.take(band).locate(mesh)
        normals = (mesh.normals[mesh.indices[triangle]] * weights[..., None]).sum(axis=2)
        normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-20)
        mean = normals.sum(axis=1)
        length = np.linalg.norm(mean, axis=1, keepdims=True)
        result[band] = np.where(length > 1e-6, mean / np.maximum(length, 1e-20), normals[:, 0])
    return result
