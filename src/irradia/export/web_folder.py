"""Finds what there is to show: in folders of results, in scenes and weights that are named one by one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from irradia.core.errors import InputError
from irradia.export.web_collection import WebCollection, WebField, WebFile, WebReference, WebScene
from irradia.export.web_views import StoredView, read_record, read_views

FIELD_ENDS = (".safetensors", ".safetensors.zst", ".bin")
SCENE_FILE = "scene.baked.glb"
_RECORDS = ("bake.json", "eval.json")
_GLB_MAGIC = b"glTF"
_FIX = "Give a folder of `irradia bake`, a .glb, or weights beside one of them."


@dataclass(frozen=True)
class Found:
    """What lies in one place.

    Attributes:
        scenes: Files, each with its name for people.
        fields: Files of weights.
        views: Reference pictures.
    """

    scenes: tuple[tuple[str, Path], ...] = ()
    fields: tuple[Path, ...] = ()
    views: tuple[StoredView, ...] = ()


def collect(paths: Sequence[Path], fields: Sequence[Path] = ()) -> WebCollection:
    """Everything that some paths hold, with addresses.

    What lies in the folder of a scene goes with it; all else goes with every scene.

    Args:
        paths: Folders, .glb files and weights; none makes a page that waits for files.
        fields: Further weights.

    Raises:
        InputError: A file is missing or of no kind that is shown, or there is no scene among them.
    """
    places = [_find(path) for path in (*paths, *fields)]
    loose = [place for place in places if not place.scenes]
    scenes = [place for place in places if place.scenes]
    if places and not scenes:
        raise InputError("found no scene (.glb)", where=str((*paths, *fields)[0]), fix=_FIX)
    addresses = _Addresses()
    shown = [_scene(name, path, place, loose, addresses) for place in scenes for name, path in place.scenes]
    title = ", ".join(dict.fromkeys(scene.name for scene in shown)) or "Irradia"
    return WebCollection(title, tuple(shown))


def find_fields(folder: Path, *, deep: bool = False) -> tuple[Path, ...]:
    """The files of weights in a folder, by name; a .bin that is something else is left out.

    Args:
        folder: Where to look.
        deep: In folders within it as well.
    """
    there = folder.rglob("*") if deep else folder.iterdir()
    return tuple(path for path in sorted(there) if path.is_file() and _is_field(path))


def _find(path: Path) -> Found:
    if path.is_dir():
        return _in_folder(path)
    if not path.is_file():
        raise InputError("there is no such file or folder", where=str(path))
    if _ends(path, FIELD_ENDS):
        return Found(fields=(path,))
    if not _ends(path, (".glb",)):
        raise InputError("expected a folder, a .glb or weights", where=str(path), fix=_FIX)
    with path.open("rb") as stream:
        if stream.read(4) != _GLB_MAGIC:
            raise InputError("expected a .glb, found another kind of file", where=str(path))
    if path.name == SCENE_FILE and any((path.parent / name).is_file() for name in _RECORDS):
        return _in_folder(path.parent)
    return Found(((path.stem, path),))


def _in_folder(folder: Path) -> Found:
    """A folder's baked scene, or else all of its scenes; with its weights and references."""
    records = {name: read_record(folder / name) for name in _RECORDS}
    views = [
        view for name, record in records.items() for view in read_views(folder, record, str(folder / name))
    ]
    fields = find_fields(folder)
    if (folder / SCENE_FILE).is_file():
        name = str(records["bake.json"].get("scene") or folder.resolve().name)
        return Found(((name, folder / SCENE_FILE),), fields, tuple(views))
    scenes = tuple((path.stem, path) for path in sorted(folder.glob("*.glb")))
    if not (scenes or fields or views):
        raise InputError("found neither a scene nor weights in this folder", where=str(folder), fix=_FIX)
    return Found(scenes, fields, tuple(views))


class _Addresses:
    """Hands out addresses: a number and the file's name, the same for the same file."""

    def __init__(self) -> None:
        self._numbers: dict[Path, int] = {}

    def of(self, path: Path) -> WebFile:
        number = self._numbers.setdefault(path, len(self._numbers))
        return WebFile(path, f"files/{number}/{quote(path.name, safe='')}")


def _scene(name: str, path: Path, place: Found, loose: Sequence[Found], addresses: _Addresses) -> WebScene:
    weights = _beside(path, [*place.fields, *(path for other in loose for path in other.fields)])
    views = [*place.views, *(view for other in loose for view in other.views)]
    return WebScene(
        name,
        addresses.of(path),
        tuple(WebField(label, addresses.of(path)) for label, path in _labelled(weights)),
        tuple(_reference(view, addresses) for view in views),
    )


def _beside(scene: Path, weights: Sequence[Path]) -> Sequence[Path]:
    """Weights without copies of the field that the scene has inside, which the viewer shows anyway."""
    from irradia.export.field_extension import baked_field_bytes, read_baked_document

    if not weights:
        return weights
    try:
        inside = baked_field_bytes(read_baked_document(scene))
    except InputError:  # not baked, or damaged: the viewer tells of it
        return weights
    return [path for path in weights if inside is None or not _holds(path, inside)]


def _holds(path: Path, data: bytes) -> bool:
    return path.stat().st_size == len(data) and path.read_bytes() == data


def _labelled(files: Sequence[Path]) -> list[tuple[str, Path]]:
    """Files once each, by name without ending; with their ending or folder where that is taken."""
    unique = list({path.resolve(): path for path in files}.values())
    labels = [field_name(path) for path in unique]
    for longer in (lambda path: path.name, lambda path: f"{path.resolve().parent.name}/{path.name}"):
        count = Counter(labels)
        labels = [longer(p) if count[label] > 1 else label for label, p in zip(labels, unique, strict=True)]
    return list(zip(labels, unique, strict=True))


def field_name(path: Path) -> str:
    """A file's name without the ending of weights."""
    end = max((end for end in FIELD_ENDS if _ends(path, (end,))), key=len, default="")
    return path.name[: len(path.name) - len(end)]


def _reference(view: StoredView, addresses: _Addresses) -> WebReference:
    name = f"reference, {view.camera.name}" if view.camera.name else "reference"
    return WebReference(name, addresses.of(view.path), view.camera, view.width, view.height, view.spp)


def _is_field(path: Path) -> bool:
    if path.name.lower().endswith(".bin"):
        return _is_field_bin(path)
    return _ends(path, FIELD_ENDS)


def _is_field_bin(path: Path) -> bool:
    """Probes and samples may be a .bin as well."""
    from irradia.formats.field_bin import decode_field_bin

    try:
        decode_field_bin(path.read_bytes(), str(path))
    except InputError:
        return False
    return True


def _ends(path: Path, ends: Sequence[str]) -> bool:
    return path.name.lower().endswith(tuple(ends))
