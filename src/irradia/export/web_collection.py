"""What a viewer is given: scenes with their fields and reference pictures, as a manifest names them.

docs/viewer.md describes the manifest; web/viewer reads it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from irradia import __version__
from irradia.scene.types import Camera

FORMAT = "irradia-manifest"
VERSION = 1


@dataclass(frozen=True)
class WebFile:
    """A file, and its address for the page.

    Attributes:
        path: Where it lies.
        url: Relative to the manifest, percent-encoded.
    """

    path: Path
    url: str


@dataclass(frozen=True)
class WebField:
    """Weights beside a scene.

    Attributes:
        name: For people.
    """

    name: str
    file: WebFile


@dataclass(frozen=True)
class WebReference:
    """A path-traced picture that the viewer compares with: linear radiance, diffuse transport.

    Attributes:
        name: For people.
        file: A Radiance .hdr.
        camera: That it was seen through.
        width, height: In pixels.
        spp: Samples per pixel.
    """

    name: str
    file: WebFile
    camera: Camera
    width: int
    height: int
    spp: int | None = None


@dataclass(frozen=True)
class WebScene:
    """One scene.

    Attributes:
        name: For people.
        file: A .glb.
    """

    name: str
    file: WebFile
    fields: tuple[WebField, ...] = ()
    references: tuple[WebReference, ...] = ()


@dataclass(frozen=True)
class WebCollection:
    """Everything that one page shows.

    Attributes:
        title: Of the page.
        scenes: May be none: then the page waits for files to be dropped.
        start: What the page opens with: ``scene``, ``source``, ``compare``.
    """

    title: str = "Irradia"
    scenes: tuple[WebScene, ...] = ()
    start: Mapping[str, Any] = field(default_factory=dict)

    def files(self) -> Iterator[WebFile]:
        """Every file once."""
        seen = set()
        for scene in self.scenes:
            for each in (scene, *scene.fields, *scene.references):
                if each.file.url not in seen:
                    seen.add(each.file.url)
                    yield each.file

    def manifest(self) -> dict[str, Any]:
        """The manifest as plain values."""
        return {
            "format": FORMAT,
            "version": VERSION,
            "generator": f"irradia {__version__}",
            "title": self.title,
            "scenes": [_scene(scene) for scene in self.scenes],
            **({"start": dict(self.start)} if self.start else {}),
        }


def _scene(scene: WebScene) -> dict[str, Any]:
    return {
        "name": scene.name,
        **_file(scene.file),
        "fields": [{"name": each.name, **_file(each.file)} for each in scene.fields],
        "references": [_reference(each) for each in scene.references],
    }


def _reference(reference: WebReference) -> dict[str, Any]:
    camera = reference.camera
    return {
        "name": reference.name,
        **_file(reference.file),
        "kind": "hdr",
        "spp": reference.spp,
        "width": reference.width,
        "height": reference.height,
        "camera": {
            "name": camera.name,
            "worldFromCamera": camera.world_from_camera.T.ravel().tolist(),
            "yfovRad": camera.yfov_rad,
            "aspect": camera.aspect,
        },
    }


def _file(file: WebFile) -> dict[str, Any]:
    return {"url": file.url, "bytes": file.path.stat().st_size}
