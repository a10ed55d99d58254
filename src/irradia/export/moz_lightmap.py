"""MOZ_lightmap: the lightmap as loaders without our extension read it, one 8-bit sRGB PNG per page.

Hubs defined the extension when three.js still multiplied lightMap by π inside its shader, so that
``texel · intensity`` is what a white surface shows: E/π. It is so written here: ``intensity`` is the
scale alone, and a plugin for three.js r155 or newer, whose lightMap is E, sets
``lightMapIntensity = intensity · π``.

Under a sun of 100 klx shade has few of the 256 codes. So codes are dithered in linear light, the
space in which loaders filter: the mean over a few texels is right, however dark they are.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.core.dither import dithered_srgb8
from irradia.export.page_materials import PageMaterials, PagePicture
from irradia.export.primitives import MOZ_LIGHTMAP
from irradia.export.slots import Slots
from irradia.formats.png import encode_png
from irradia.scene.gltf.document import Json

_CLIPPED_PERCENTILE = 99.95
_MAX_HEADROOM = 4.0
_BAND_ROWS = 256


def moz_scale(page: NDArray[np.float32]) -> float:
    """The power of two that one 8-bit page divides by.

    It covers the page's maximum; but where that is over 4 times the 99.95th percentile of lit texels
    (a lamp's halo, a sunny sill), it covers the percentile and clips the rest: 8 bits have no codes
    to spare for it, and everything else would band.
    """
    brightest = page.max(axis=-1)
    brightest = brightest[brightest > 0.0]
    if brightest.size == 0:
        return 1.0
    high = float(np.percentile(brightest, _CLIPPED_PERCENTILE))
    top = float(brightest.max())
    covered = top if top <= _MAX_HEADROOM * high else high
    return 2.0 ** int(np.ceil(np.log2(covered)))


class MozLightmaps(PageMaterials):
    """Materials whose MOZ_lightmap reads a page.

    Args:
        json, slots, free_materials, free_textures: See :class:`PageMaterials`.
        pages: (P, H, W, 3) E/π.
    """

    def __init__(
        self,
        json: Json,
        slots: Slots,
        pages: NDArray[np.float32],
        *,
        free_materials: set[int],
        free_textures: list[int],
    ) -> None:
        super().__init__(json, slots, free_materials=free_materials, free_textures=free_textures)
        self._pages = pages
        self._intensity: dict[int, float] = {}

    def _read_page(self, material: Json, page: int, texcoord: int) -> None:
        texture = self._texture(page)
        material.setdefault("extensions", {})[MOZ_LIGHTMAP] = {
            "index": texture,
            "texCoord": texcoord,
            "intensity": self._intensity[page],
        }

    def _picture(self, page: int) -> PagePicture:
        scale = moz_scale(self._pages[page])
        self._intensity[page] = scale
        return PagePicture(f"lightmap {page}", encode_png(_coded(self._pages[page], scale)))


def _coded(page: NDArray[np.float32], scale: float) -> NDArray[np.uint8]:
    """The sRGB codes of a page over its scale, a band of rows at a time to stay small."""
    bands = [slice(start, start + _BAND_ROWS) for start in range(0, len(page), _BAND_ROWS)]
    return np.concatenate(
        [dithered_srgb8(page[band] / np.float32(scale), first_row=band.start) for band in bands]
    )
