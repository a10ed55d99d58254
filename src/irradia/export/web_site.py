"""A folder that any static host shows: the viewer, its manifest and the files."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from irradia.core.errors import InputError
from irradia.core.files import write_atomic, write_text_atomic
from irradia.export.web_collection import FORMAT, WebCollection
from irradia.export.web_viewer import PAGE, Viewer

MANIFEST = "manifest.json"


def write_site(folder: Path, viewer: Viewer, collection: WebCollection) -> list[str]:
    """Writes a site; every address in it is relative. An earlier one of ours in that folder is replaced.

    Args:
        folder: Where to; the page comes last, so that it never names what isn't there.
        viewer: The page and its parts.
        collection: What it shows.

    Returns:
        The files written, relative to ``folder``.

    Raises:
        InputError: Another site is there.
        OSError: It can't be written.
    """
    before = _earlier(folder)
    parts = {name: path for name, path in viewer.files.items() if name != PAGE}
    shown = {_place(file.url): file.path for file in collection.files()}
    for name, path in (parts | shown).items():
        _copy(path, folder / name)
    write_text_atomic(folder / MANIFEST, json.dumps(collection.manifest(), indent=2, allow_nan=False) + "\n")
    write_text_atomic(folder / PAGE, viewer.page(MANIFEST))
    for name in before - set(shown):
        _remove(folder, name)
    return sorted([*parts, *shown, MANIFEST, PAGE])


def _place(url: str) -> str:
    """Where the file of an address lies: hosts decode what browsers send."""
    from urllib.parse import unquote

    return unquote(url)


def _copy(source: Path, target: Path) -> None:
    with source.open("rb") as read, write_atomic(target) as written:
        shutil.copyfileobj(read, written)


def _earlier(folder: Path) -> set[str]:
    """The files that an earlier site of ours shows.

    Raises:
        InputError: What is there isn't ours.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError("expected a folder, found a file", where=str(folder))
    if not (folder / PAGE).exists():
        return set()
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        if manifest["format"] != FORMAT:
            raise ValueError(manifest["format"])
        listed = [each for s in manifest["scenes"] for each in (s, *s["fields"], *s["references"])]
        return {_place(each["url"]) for each in listed}
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise InputError(
            "another site is in this folder", where=str(folder), fix="Choose a new folder."
        ) from error


def _remove(folder: Path, name: str) -> None:
    """A file of an earlier site, with its folder if that is empty then; a name that leads elsewhere stays."""
    path = folder / name
    if folder.resolve() not in path.resolve().parents or not path.is_file():
        return
    path.unlink()
    if not any(path.parent.iterdir()):
        path.parent.rmdir()
