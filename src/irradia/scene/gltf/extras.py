"""Our own settings in a file: ``extras.irradia``."""

from __future__ import annotations

from irradia.scene.gltf.view import JsonView


def irradia_extras(view: JsonView) -> JsonView:
    """The object ``extras.irradia`` of ``view``, or an empty one.

    Extras may hold anything; only an object named ``irradia`` is taken for ours.
    """
    extras = view.value.get("extras") if isinstance(view.value, dict) else None
    if not isinstance(extras, dict) or not isinstance(extras.get("irradia"), dict):
        return JsonView({})
    return JsonView(extras["irradia"], f"{view.pointer}/extras/irradia")
