"""What light lies inside a baked .glb: each part with its size, nothing decoded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from irradia.export.lighting_extension import NAME
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.gltf.view import JsonView


@dataclass(frozen=True)
class BakedPart:
    """One part of a document's light.

    Attributes:
        name: Its key in IRRADIA_lighting.
        text: What it is, in words.
        n_bytes: In the file.
    """

    name: str
    text: str
    n_bytes: int


def baked_parts(document: GltfDocument) -> tuple[BakedPart, ...]:
    """The parts in the order of the extension's description; none where nothing was baked.

    Raises:
        InputError: The extension is damaged.
    """
    extension = JsonView(document.json).extension(NAME)
    if extension is None:
        return ()
    accessors = Accessors(document)
    describe = {
        "lightmap": _lightmap,
        "direct": lambda _: "first bounce of punctual lights, beside a field of indirect light",
        "directional": lambda part: f"{part.string('mode')}, {len(part.object('maps').value)} maps",
        "shadowMask": lambda part: _pages(part.length("pages")),
        "validity": lambda part: _pages(part.length("pages")),
        "probes": _probes,
        "field": lambda part: f"{part.string('mode')}, {part.string('light')} light",
    }
    return tuple(
        BakedPart(name, text(extension.object(name)), sum(_sizes(extension.object(name).value, accessors)))
        for name, text in describe.items()
        if extension.has(name)
    )


def _lightmap(part: JsonView) -> str:
    size = f"{part.integer('width')} × {part.integer('height')}"
    return f"{_pages(part.integer('pages'))} of {size}, {part.string('encoding')}"


def _pages(count: int) -> str:
    return f"{count} page{'s' if count > 1 else ''}"


def _probes(part: JsonView) -> str:
    structure = next((name for name in ("grid", "octree") if part.has(name)), "loose")
    return f"{part.integer('count'):,}, {structure}, {part.string('light')} light"


def _sizes(value: Any, accessors: Accessors) -> Iterator[int]:
    """Bytes of every buffer view that a JSON value names, however deep."""
    if isinstance(value, dict):
        if isinstance(value.get("bufferView"), int):
            yield len(accessors.read_view(value["bufferView"]))
        for child in value.values():
            yield from _sizes(child, accessors)
    elif isinstance(value, list):
        for child in value:
            yield from _sizes(child, accessors)
