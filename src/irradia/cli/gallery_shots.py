"""What a gallery shows: a picture of each way in which a scene's light is held."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from irradia.core.errors import InputError
from irradia.export.web_collection import WebField, WebScene
from irradia.report import text


@dataclass(frozen=True)
class Shot:
    """One picture to be taken.

    Attributes:
        name: Its label.
        source: As the viewer calls it.
        scene: What the viewer is given: no more than it needs.
        field: What is shown of it, where it is one.
    """

    name: str
    source: str
    scene: WebScene
    field: WebField | None = None


def find_shots(scene: WebScene, *, with_reference: bool = True) -> list[Shot]:
    """Reference and lightmap where there are any, the field inside the scene, then the others by name.

    Args:
        scene: With every field.
        with_reference: Leaves it out where False: it shows what its own camera sees.

    Raises:
        InputError: There is no field.
    """
    inside = _inside(scene.file.path)
    bare = replace(scene, fields=())
    shots = [Shot("reference", "reference", bare)] if scene.references and with_reference else []
    shots += [Shot("lightmap", "lightmap", bare)] if "lightmap" in inside else []
    shots += [Shot("field in the scene", "field", bare)] if "field" in inside else []
    shots += [Shot(each.name, "field:0", replace(scene, fields=(each,)), each) for each in scene.fields]
    if not any(shot.source.startswith("field") for shot in shots):
        raise InputError(
            "found no weights", where=str(scene.file.path.parent), fix="Make some with `irradia train`."
        )
    return shots


def damage(field: WebField) -> str:
    """What is wrong with a file of weights, so that nobody waits for a browser to find out."""
    from irradia.field.files import read_field

    try:
        read_field(field.file.path)
    except InputError as error:
        return error.message
    return ""


def remark(shot: Shot) -> str:
    """What a field costs; what light a picture holds."""
    if shot.source == "reference":
        spp = shot.scene.references[0].spp
        return "path-traced" if spp is None else f"path-traced, {spp} samples a pixel"
    if shot.field is None:
        return f"in {shot.scene.file.path.name}"
    return text.size(shot.field.file.path.stat().st_size)


def _inside(path: Path) -> set[str]:
    """What a .glb holds of ours."""
    from irradia.export.lighting_extension import NAME
    from irradia.scene.gltf import read_document
    from irradia.scene.gltf.view import JsonView

    extension = JsonView(read_document(path).json).extension(NAME)
    return {name for name in ("lightmap", "field") if extension is not None and extension.has(name)}
