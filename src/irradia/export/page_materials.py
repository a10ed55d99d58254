"""Copies of materials that read a page of a map: what glTF binds to materials, a bake binds to objects."""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from dataclasses import dataclass

from irradia.export.slots import Slots
from irradia.scene.gltf.document import Json

_LINEAR, _CLAMP = 9729, 33071


@dataclass(frozen=True)
class PagePicture:
    """A page as the document holds it.

    Attributes:
        name: Of the image.
        png: Its bytes.
    """

    name: str
    png: bytes


class PageMaterials(ABC):
    """Adds pages as textures, and materials that read them, to ``json``, which is changed.

    Args:
        json: The document being written.
        slots: Where image bytes go.
        free_materials: Materials that nothing else uses: their first copy takes their place.
        free_textures: Textures of an earlier bake, whose places new pages take.
    """

    def __init__(
        self, json: Json, slots: Slots, *, free_materials: set[int], free_textures: list[int]
    ) -> None:
        self._json = json
        self._originals: list[Json] = copy.deepcopy(json.get("materials", []))
        self._free = set(free_materials)
        self._free_textures = list(free_textures)
        self._slots = slots
        self._textures: dict[int, int] = {}
        self._materials: dict[tuple[int | None, int, int], int] = {}

    def material(self, material: int | None, page: int, texcoord: int) -> int:
        """A copy of a material (glTF's default, if None) that reads the page."""
        key = (material, page, texcoord)
        if key not in self._materials:
            clone: Json = {} if material is None else copy.deepcopy(self._originals[material])
            self._read_page(clone, page, texcoord)
            if material is not None and material in self._free:
                self._free.remove(material)
                self._json["materials"][material] = clone
                self._materials[key] = material
            else:
                self._materials[key] = _append(self._json, "materials", clone)
            self._light_lower_levels(clone, page, texcoord)
        return self._materials[key]

    @property
    def used(self) -> bool:
        """Whether any material reads a page."""
        return bool(self._materials)

    @abstractmethod
    def _read_page(self, material: Json, page: int, texcoord: int) -> None:
        """Lets a copy read a page's texture."""

    @abstractmethod
    def _picture(self, page: int) -> PagePicture:
        """A page's image; asked once."""

    def _light_lower_levels(self, material: Json, page: int, texcoord: int) -> None:
        """Points a material's MSFT_lod to copies that read the page too."""
        lod = material.get("extensions", {}).get("MSFT_lod")
        if lod is not None:
            known = [index for index in lod.get("ids", []) if 0 <= index < len(self._originals)]
            lit = [self.material(index, page, texcoord) for index in known]
            material["extensions"]["MSFT_lod"] = {**lod, "ids": lit}

    def _texture(self, page: int) -> int:
        """Index of a page's texture."""
        if page not in self._textures:
            picture = self._picture(page)
            image: Json = {"name": picture.name, "mimeType": "image/png", "bufferView": -1}
            self._slots.add_blob(picture.png, lambda view: image.update(bufferView=view))
            self._textures[page] = self._place(image)
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


def _append(json: Json, key: str, entry: Json) -> int:
    table = json.setdefault(key, [])
    table.append(entry)
    return len(table) - 1
