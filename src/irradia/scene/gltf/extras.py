"""Our own settings in a file: ``extras.irradia``."""

from __future__ import annotations

from collections.abc import Collection

from irradia.core.names import did_you_mean
from irradia.scene.gltf.notes import ImportNotes
from irradia.scene.gltf.view import JsonView


def irradia_extras(view: JsonView) -> JsonView:
    """The object ``extras.irradia`` of ``view``, or an empty one.

    Extras may hold anything; only an object named ``irradia`` is taken for ours.
    """
    extras = view.value.get("extras") if isinstance(view.value, dict) else None
    if not isinstance(extras, dict) or not isinstance(extras.get("irradia"), dict):
        return JsonView({})
    return JsonView(extras["irradia"], f"{view.pointer}/extras/irradia")


def note_unknown_keys(extras: JsonView, known: Collection[str], notes: ImportNotes) -> None:
    """Notes settings that nobody reads; misspelt ones would be missed in silence."""
    for key, view in extras.entries():
        if key not in known:
            notes.add(f"{view.pointer} is not a setting of Irradia's. {did_you_mean(key, known)}")
