"""The one way in: a file or a built-in scene by name."""

from __future__ import annotations

from dataclasses import dataclass

from irradia.scene.gltf import GltfDocument, document_to_scene, read_document
from irradia.scene.types import Scene

BUILTIN_PREFIX = "builtin:"


@dataclass(frozen=True)
class LoadOptions:
    """How a scene is taken from its file.

    Attributes:
        pose_time: Seconds into the animations; None takes the rest pose.
        variant: Name of a material variant; None takes each primitive's own material.
    """

    pose_time: float | None = None
    variant: str | None = None


def load_scene(spec: str, options: LoadOptions | None = None) -> Scene:
    """Loads a .gltf, a .glb, or ``builtin:NAME``.

    Raises:
        InputError: There is no such file or scene, or it is malformed.
    """
    options = options or LoadOptions()
    document = load_document(spec)
    return document_to_scene(document, pose_time=options.pose_time, variant=options.variant)


def load_document(spec: str) -> GltfDocument:
    """The document behind a path or ``builtin:NAME``; see :func:`load_scene`."""
    if not spec.startswith(BUILTIN_PREFIX):
        return read_document(spec)
    from irradia.scene.builtin import build_document

    return build_document(spec.removeprefix(BUILTIN_PREFIX))
