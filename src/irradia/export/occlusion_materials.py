"""Ambient occlusion as glTF's materials read it: ``occlusionTexture``, one 8-bit PNG per page."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.export.page_materials import PageMaterials, PagePicture
from irradia.export.slots import Slots
from irradia.formats.png import encode_png
from irradia.scene.gltf.document import Json


class OcclusionMaterials(PageMaterials):
    """Materials whose occlusion texture is a baked page, in place of any that they had.

    Args:
        json, slots, free_materials, free_textures: See :class:`PageMaterials`.
        pages: (P, H, W, 3) openness in [0, 1], linear; glTF reads the first channel.
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

    def _read_page(self, material: Json, page: int, texcoord: int) -> None:
        material["occlusionTexture"] = {"index": self._texture(page), "texCoord": texcoord}

    def _picture(self, page: int) -> PagePicture:
        return PagePicture(f"occlusion {page}", encode_png(linear_codes(self._pages[page])))


def linear_codes(openness: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(…, C) values in [0, 1] as the nearest of 256 linear codes of their first channel, (…)."""
    return np.round(np.clip(openness[..., 0], 0.0, 1.0) * 255.0).astype(np.uint8)
