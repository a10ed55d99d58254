"""EXT_mesh_gpu_instancing: many placements of one node's mesh."""

from __future__ import annotations

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.transforms import trs_matrix
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import F64


def read_gpu_instances(node: JsonView, accessors: Accessors) -> F64 | None:
    """(N, 4, 4) node_from_instance, or None where the node isn't instanced.

    Raises:
        InputError: The attributes differ in length.
    """
    extension = node.extension("EXT_mesh_gpu_instancing")
    if extension is None:
        return None
    attributes = extension.object("attributes")
    columns = {
        name: accessors.read(attributes.integer(name)).floats(components).astype(np.float64)
        for name, components in (("TRANSLATION", 3), ("ROTATION", 4), ("SCALE", 3))
        if attributes.has(name)
    }
    lengths = {len(values) for values in columns.values()}
    if len(lengths) != 1:
        raise InputError(
            "expected TRANSLATION, ROTATION or SCALE, all of one length", where=attributes.pointer
        )
    count = lengths.pop()
    return trs_matrix(
        columns.get("TRANSLATION", np.zeros((count, 3))),
        columns.get("ROTATION", np.tile((0.0, 0.0, 0.0, 1.0), (count, 1))),
        columns.get("SCALE", np.ones((count, 3))),
    )
