"""MOZ_lightmap: the lightmap as loaders without our extension read it, one 8-bit sRGB PNG per page.

Hubs defined the extension when three.js still multiplied lightMap by π inside its shader, so that
``texel · intensity`` is what a white surface shows: E/π. It is so written here: ``intensity`` is the
scale alone, and a plugin for three.js r155 or newer, whose lightMap is E, sets
``lightMapIntensity = intensity · π``.

Under a sun of 100 klx shade has few of the 256 codes. So codes are dithered in linear light, the
space in which loaders filter: the mean over a few texels is right, however dark they are.
"""

from __future__ import annotations

import copy

import numpy as np
from numpy.typing import NDArray

from irradia.core.dither import dithered_srgb8
from irradia.export.primitives import MOZ_LIGHTMAP
from irradia.export.slots import Slots
from irradia.formats.png import encode_png
from irradia.scene.gltf.document import Json

_LINEAR, _CLAMP = 9729, 33071
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


class MozLightmaps:
    """Adds pages as textures, and materials that read them, to ``json``, which is changed.

    Args:
        json: The document being written.
        slots: Where image bytes go.
        pages: (P, H, W, 3) E/π.
        free_materials: Materials that nothing else uses: their first copy takes their place.
        free_textures: Textures of an earlier bake, whose places new pages take.
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
        self._json = json
        self._originals: list[Json] = copy.deepcopy(json.get("materials", []))
        self._free = set(free_materials)
        self._free_textures = list(free_textures)
        self._slots = slots
        self._pages = pages
        self._textures: dict[int, tuple[int, float]] = {}
        self._materials: dict[tuple[int | None, int, int], int] = {}

    def material(self, material: int | None, page: int, texcoord: int) -> int:
        """A copy of a material (glTF's default, if None) with the page as its lightmap."""
        key = (material, page, texcoord)
        if key not in self._materials:
            texture, intensity = self._texture(page)
            clone: Json = {} if material is None else copy.deepcopy(self._originals[material])
            clone.setdefault("extensions", {})[MOZ_LIGHTMAP] = {
                "index": texture,
                "texCoord": texcoord,
                "intensity": intensity,
            }
            if material is not None and material in self._free:
                self._free.remove(material)
                self._json["materials"][material] = clone
                self._materials[key] = material
            else:
                self._materials[key] = _append(self._json, "materials", clone)
            self._light_lower_levels(clone, page, texcoord)
        return self._materials[key]

    def _light_lower_levels(self, material: Json, page: int, texcoord: int) -> None:
        """Points a material's MSFT_lod to copies that read the page too."""
        lod = material["extensions"].get("MSFT_lod")
        if lod is not None:
            known = [index for index in lod.get("ids", []) if 0 <= index < len(self._originals)]
            lit = [self.material(index, page, texcoord) for index in known]
            material["extensions"]["MSFT_lod"] = {**lod, "ids": lit}

    @property
    def used(self) -> bool:
        """Whether any material reads a page."""
        return bool(self._materials)

    def _texture(self, page: int) -> tuple[int, float]:
        """Index of a page's texture, and its scale."""
        if page not in self._textures:
            pixels = self._pages[page]
            scale = moz_scale(pixels)
            image: Json = {"name": f"lightmap {page}", "mimeType": "image/png", "bufferView": -1}
            png = encode_png(_coded(pixels, scale))
            self._slots.add_blob(png, lambda view: image.update(bufferView=view))
            self._textures[page] = self._place(image), scale
        return self._textures[page]

    def _place(self, image: Json) -> int:
        """Index of a texture that shows ``image``."""
        if self._free_textures:
            texture = self._free_textures.pop(0)
            self._json["images"][self._json["textures"][texture]["source"]] = image
            return texture
        source = _append(self._json, "images", image)
        sampler = {"magFilter": _LINEAR, "minFilter": _LINEAR, "wrapS": _CLAMP, "wrapT": _CLAMP}
        texture = {"source": source, "sampler": _append(self._json, "samplers", sampler)}
        return _append(self._json, "textures", texture)


def _coded(page: NDArray[np.float32], scale: float) -> NDArray[np.uint8]:
    """The sRGB codes of a page over its scale, a band of rows at a time to stay small."""
    bands = [slice(start, start + _BAND_ROWS) for start in range(0, len(page), _BAND_ROWS)]
    return np.concatenate(
        [dithered_srgb8(page[band] / np.float32(scale), first_row=band.start) for band in bands]
    )


def _append(json: Json, key: str, entry: Json) -> int:
    table = json.setdefault(key, [])
    table.append(entry)
    return len(table) - 1
