"""What a command reads of a scene: files by their names and hashes, never by their folders here.

Datasets, fields and bakes keep it, so that what belongs together can be told from what doesn't.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any, Protocol

from irradia.cli.lighting import LightOptions
from irradia.core import provenance
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.load import LoadOptions
from irradia.scene.types import Scene


class LitScene(Protocol):
    """A job's choices that decide a scene and its light."""

    @property
    def scene(self) -> str:
        """A file or ``builtin:NAME``."""
        ...

    @property
    def load(self) -> LoadOptions:
        """Which state of the file is meant."""
        ...

    @property
    def light(self) -> LightOptions:
        """Light from outside."""
        ...

    @property
    def overrides(self) -> tuple[str, ...]:
        """Materials to replace; see :mod:`irradia.scene.material_override_file`."""
        ...

    @property
    def ies(self) -> tuple[str, ...]:
        """Measured distributions for lights; see :mod:`irradia.scene.ies_option`."""
        ...


def scene_config(job: LitScene) -> dict[str, Any]:
    """A scene's choices as plain values."""
    light = asdict(job.light) | {"env": job.light.env.name if job.light.env else None}
    return {
        "scene": Path(job.scene).name,
        "load": asdict(job.load),
        "light": light,
        "overrides": [_without_folder(spec) for spec in job.overrides],
        "ies": [_without_folder(spec) for spec in job.ies],
    }


def scene_inputs(job: LitScene, scene: Scene) -> dict[str, str]:
    """SHA-256 of a scene and of each file that lights or changes it, by name."""
    found = {Path(job.scene).name: scene_hash(scene)}
    for path in _files(job):
        name = path.name
        while name in found:  # of two folders
            name = f"{name}'"
        found[name] = provenance.sha256_file(path)
    return found


def scene_origin(job: LitScene, scene: Scene) -> dict[str, Any]:
    """Both, as a dataset's provenance holds them; what JSON gives back."""
    return json.loads(json.dumps({"config": scene_config(job), "inputs": scene_inputs(job, scene)}))


def scene_hash(scene: Scene) -> str:
    """SHA-256 over the document with all that it refers to."""
    document: GltfDocument | None = scene.document
    if document is None:
        return provenance.sha256_bytes(scene.name.encode())
    text = json.dumps(document.json, sort_keys=True, separators=(",", ":")).encode()
    return provenance.sha256_bytes(text, *document.buffers, *document.images)


def _files(job: LitScene) -> Iterator[Path]:
    if job.light.env is not None:
        yield job.light.env
    for spec in (*job.overrides, *job.ies):
        written = _named_file(spec)
        if written:
            yield Path(written)
            yield from _images_of(Path(written))


def _images_of(path: Path) -> Iterator[Path]:
    """Files that a .json of overrides names beside itself."""
    if path.suffix.lower() != ".json":
        return
    texts: list[Any] = [json.loads(path.read_text(encoding="utf-8"))]
    while texts:
        value = texts.pop()
        if isinstance(value, str) and (path.parent / value).is_file():
            yield path.parent / value
        elif isinstance(value, (dict, list)):
            texts += value.values() if isinstance(value, dict) else value


def _named_file(spec: str) -> str:
    """The file in ``FILE`` or ``NAME=FILE``, as it is written there; empty where there is none."""
    return next((part for part in (spec, spec.rpartition("=")[2]) if Path(part).is_file()), "")


def _without_folder(spec: str) -> str:
    """The same with the file's bare name."""
    written = _named_file(spec)
    return spec.removesuffix(written) + Path(written).name if written else spec
