"""KHR_draco_mesh_compression, decoded by Google's Draco (DracoPy)."""

from __future__ import annotations

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.gltf.accessors import Accessors, Stored
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import U32


def decode_draco(
    extension: JsonView, accessors: Accessors, declared: dict[str, Stored]
) -> tuple[dict[str, Stored], U32]:
    """Decodes a primitive's Draco buffer.

    Args:
        extension: The primitive's extension object.
        accessors: Reads the buffer view.
        declared: The primitive's accessors: they say what is normalised, and name errors.

    Returns:
        The compressed attributes and (3T,) triangle indices.

    Raises:
        InputError: The data is damaged, or lacks an attribute that the extension names.
    """
    import DracoPy

    data = bytes(accessors.read_view(extension.integer("bufferView")))
    try:
        mesh = DracoPy.decode(data)
    except (ValueError, RuntimeError, DracoPy.FileTypeException) as error:
        raise InputError(f"this Draco data is damaged: {error}", where=extension.pointer) from error
    by_id = {attribute["unique_id"]: attribute["data"] for attribute in mesh.attributes}
    attributes = {}
    for name, _ in extension.object("attributes").entries():
        unique_id = extension.object("attributes").integer(name)
        if unique_id not in by_id or name not in declared:
            raise InputError(
                f"the Draco data has no attribute {unique_id} for {name}", where=extension.pointer
            )
        values = np.asarray(by_id[unique_id])
        values = values.reshape(len(values), -1)
        attributes[name] = Stored(values, declared[name].normalized, declared[name].pointer)
    faces = getattr(mesh, "faces", None)
    if faces is None:
        raise InputError("this Draco data holds points, not triangles", where=extension.pointer)
    return attributes, np.asarray(faces).astype(np.uint32).ravel()
