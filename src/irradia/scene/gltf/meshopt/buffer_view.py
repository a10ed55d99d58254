"""One compressed buffer view: checked, decoded, filtered.

This work is based on: the bitstream and filters that KHR_meshopt_compression specifies, appendices
A and B (Kapoulkine et al.), of which EXT_meshopt_compression is a part.
"""

from __future__ import annotations

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.gltf.meshopt.attributes import decode_attributes
from irradia.scene.gltf.meshopt.filters import FILTERS
from irradia.scene.gltf.meshopt.indices import decode_index_sequence, decode_triangles
from irradia.scene.gltf.view import JsonView

_MODES = ("ATTRIBUTES", "TRIANGLES", "INDICES")
_MAX_BYTES = 1 << 31
# The sparsest block spends 2 bits on 16 bytes, and a triangle one byte on 12. Anything that claims
# to unpack to more is damaged, and isn't given the memory.
_MAX_RATIO = 1 << 12


def decode_buffer_view(extension: JsonView, data: memoryview) -> bytes:
    """The uncompressed bytes of a buffer view.

    Args:
        extension: The extension's object on the buffer view.
        data: The compressed bytes that it refers to.

    Raises:
        InputError: The parameters contradict each other, or the stream is damaged.
    """
    mode = extension.choice("mode", _MODES)
    count, stride = extension.integer("count", minimum=1), extension.integer("byteStride", minimum=1)
    name = extension.choice("filter", tuple(FILTERS), "NONE")
    _check_layout(extension, mode, count, stride, name)
    if count * stride > min(_MAX_BYTES, len(data) * _MAX_RATIO):
        raise InputError(
            f"{len(data)} bytes can't hold {count} elements of {stride} bytes", where=extension.pointer
        )
    stream = np.frombuffer(data, np.uint8)
    try:
        if mode == "ATTRIBUTES":
            return FILTERS[name].apply(decode_attributes(stream, count, stride)).tobytes()
        decode = decode_triangles if mode == "TRIANGLES" else decode_index_sequence
        return decode(stream, count).astype("<u2" if stride == 2 else "<u4").tobytes()
    except ValueError as error:
        raise InputError(f"this meshopt stream is damaged: {error}", where=extension.pointer) from error


def _check_layout(extension: JsonView, mode: str, count: int, stride: int, name: str) -> None:
    if mode == "ATTRIBUTES":
        valid = stride % 4 == 0 and stride <= 256 and FILTERS[name].takes(stride)
    else:
        valid = stride in (2, 4) and name == "NONE" and (mode == "INDICES" or count % 3 == 0)
    if not valid:
        raise InputError(
            f"mode {mode} with filter {name} doesn't take {count} elements of {stride} bytes",
            where=extension.pointer,
        )
