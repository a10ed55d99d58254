"""Which material each primitive gets: its own, its variant's, or the default."""

from __future__ import annotations

from irradia.core.errors import InputError
from irradia.scene.gltf.materials import read_material
from irradia.scene.gltf.notes import ImportNotes
from irradia.scene.gltf.texcoord_sets import fit_texcoords
from irradia.scene.gltf.textures import Textures
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import Material

_VARIANTS = "KHR_materials_variants"


class MaterialTable:
    """The scene's materials: the file's in its order, then the default and fitted copies if needed."""

    def __init__(self, root: JsonView, textures: Textures, variant: str | None, notes: ImportNotes) -> None:
        """Reads every material of the file.

        Raises:
            InputError: One is malformed, or there is no variant called ``variant``.
        """
        self._materials = [read_material(view, textures) for view in root.items("materials")]
        self._n_in_file = len(self._materials)
        self._position = {material: index for index, material in reversed(list(enumerate(self._materials)))}
        self._variant = _variant_index(root, variant)
        self._notes = notes

    @property
    def materials(self) -> tuple[Material, ...]:
        """All materials so far; index i below the file's number is ``/materials/i``."""
        return tuple(self._materials)

    def choose(self, primitive: JsonView, n_texcoords: int) -> tuple[int, tuple[int, ...]]:
        """Index of a primitive's material, and the order in which it wants the texcoord sets."""
        index = self._stated(primitive)
        material = Material() if index is None else self._materials[index]
        fitted = fit_texcoords(material, n_texcoords)
        for field, texcoord in fitted.dropped:
            self._notes.add(
                f"material '{material.name}': its {field.replace('_', ' ')} is left out, because "
                f"TEXCOORD_{texcoord} is absent or the third set in use (at {primitive.pointer})"
            )
        if index is None or fitted.material is not material:
            index = self._add(fitted.material)
        return index, fitted.order

    def _stated(self, primitive: JsonView) -> int | None:
        """The material that the chosen variant maps the primitive to, else its own, else None."""
        extension = primitive.extension(_VARIANTS)
        if self._variant is not None and extension is not None:
            for mapping in extension.items("mappings"):
                if any(variant.value == self._variant for variant in mapping.items("variants")):
                    return mapping.index("material", self._n_in_file)
        return primitive.index("material", self._n_in_file)

    def _add(self, material: Material) -> int:
        if material not in self._position:
            self._position[material] = len(self._materials)
            self._materials.append(material)
        return self._position[material]


def _variant_index(root: JsonView, variant: str | None) -> int | None:
    if variant is None:
        return None
    extension = root.extension(_VARIANTS)
    names = [view.string("name") for view in extension.items("variants")] if extension else []
    if variant not in names:
        known = ", ".join(f"'{name}'" for name in names) if names else "none"
        raise InputError(
            f"there is no variant '{variant}'", where="--variant", fix=f"Variants in this file: {known}."
        )
    return names.index(variant)
