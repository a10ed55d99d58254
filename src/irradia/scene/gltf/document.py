"""A glTF document as it stands in the file: parsed JSON and raw buffers, nothing interpreted."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

Json = dict[str, Any]


@dataclass(frozen=True)
class GltfDocument:
    """JSON and buffers; what the baker doesn't touch is written back from here unchanged.

    Attributes:
        json: The parsed document. Treat it as read-only; exporters work on a deep copy.
        buffers: Bytes of each buffer, in order; external ones and data URIs resolved.
        images: Encoded bytes (PNG, JPEG, WebP …) of each image, by image index.
        base: Folder that relative URIs refer to; None for documents made in memory.
    """

    json: Json
    buffers: tuple[bytes, ...]
    images: tuple[bytes, ...] = field(default=(), repr=False)
    base: Path | None = None
    name: str = "scene"
