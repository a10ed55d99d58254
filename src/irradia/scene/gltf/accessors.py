"""Accessors as arrays: every component type, normalised, sparse and interleaved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.scene.gltf.buffer_views import BufferViews
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import F32, U32

_DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_SHAPES = {  # columns, rows
    "SCALAR": (1, 1),
    "VEC2": (1, 2),
    "VEC3": (1, 3),
    "VEC4": (1, 4),
    "MAT2": (2, 2),
    "MAT3": (3, 3),
    "MAT4": (4, 4),
}
_MAX_ZEROS_BYTES = 1 << 31  # an accessor without a buffer view costs a file nothing, so it could ask for all


@dataclass(frozen=True)
class Stored:
    """An accessor's values as they are stored.

    Attributes:
        values: (count, components) in the component type; matrices column by column.
        normalized: Whether integers stand for [0, 1] or [−1, 1].
        pointer: Where it stands in the JSON.
    """

    values: NDArray
    normalized: bool
    pointer: str

    def __len__(self) -> int:
        return len(self.values)

    def floats(self, *components: int) -> F32:
        """(count, components) float32, integers normalised where they say so.

        Args:
            components: The numbers of components that are allowed here.

        Raises:
            InputError: It has another number of components, or values that are not finite.
        """
        if self.values.shape[1] not in components:
            expected = " or ".join(map(str, components))
            raise InputError(
                f"expected {expected} components, found {self.values.shape[1]}", where=self.pointer
            )
        if self.values.dtype.kind != "f":
            return self._dequantized()
        finite = np.isfinite(self.values).all(axis=1)
        if not finite.all():
            first = int(np.argmin(finite))
            raise InputError(
                f"element {first} is not finite: {self.values[first].tolist()}",
                where=self.pointer,
                fix="Repair the mesh in a modelling tool (merge by distance, recalculate normals).",
            )
        return np.array(self.values, np.float32, order="C")

    def indices(self) -> U32:
        """(count,) unsigned integers.

        Raises:
            InputError: They are no unsigned scalars.
        """
        if self.values.shape[1] != 1 or self.values.dtype.kind != "u":
            raise InputError("expected unsigned integer scalars", where=self.pointer)
        return self.values[:, 0].astype(np.uint32)

    def _dequantized(self) -> F32:
        values = self.values.astype(np.float32)
        if not self.normalized:
            return values
        values /= np.float32(np.iinfo(self.values.dtype).max)
        return np.maximum(values, np.float32(-1.0)) if self.values.dtype.kind == "i" else values


class Accessors:
    """Reads the accessors of one document."""

    def __init__(self, document: GltfDocument) -> None:
        self._root = JsonView(document.json)
        self._views = BufferViews(document)

    def read(self, index: int) -> Stored:
        """The values of accessor ``index``.

        Raises:
            InputError: It doesn't exist, or reaches outside its buffer view.
        """
        accessor = self._root.element("accessors", index)
        dtype, shape = _layout(accessor)
        count = accessor.integer("count", minimum=1)
        view_index = accessor.index("bufferView", self._root.length("bufferViews"))
        if view_index is None:
            values = _zeros(accessor, count, dtype, shape)
        else:
            values = self._gather(accessor, view_index, count, dtype, shape)
        if accessor.has("sparse"):
            values = self._with_sparse(accessor.object("sparse"), values, dtype, shape)
        return Stored(values, accessor.boolean("normalized", False), accessor.pointer)

    def read_view(self, index: int) -> memoryview:
        """The uncompressed bytes of buffer view ``index``."""
        return self._views.read(index)

    def _gather(
        self, where: JsonView, view_index: int, count: int, dtype: np.dtype, shape: tuple[int, int]
    ) -> NDArray:
        """``count`` elements of a buffer view, copied only where they are interleaved."""
        columns, rows = shape
        column_bytes = rows * dtype.itemsize
        if columns > 1:
            column_bytes = -(-column_bytes // 4) * 4  # matrix columns start on 4-byte boundaries
        element_bytes = column_bytes * columns
        data = self._views.read(view_index)
        stride = self._views.stride(view_index) or element_bytes
        start = where.integer("byteOffset", 0)
        end = start + (count - 1) * stride + element_bytes
        if end > len(data):
            raise InputError(
                f"its {count} elements end at byte {end}, the buffer view has {len(data)} bytes",
                where=where.pointer,
            )
        strided = np.ndarray(
            (count, columns, rows), dtype, data, start, (stride, column_bytes, dtype.itemsize)
        )
        return strided.reshape(count, columns * rows)

    def _with_sparse(
        self, sparse: JsonView, dense: NDArray, dtype: np.dtype, shape: tuple[int, int]
    ) -> NDArray:
        """A copy of ``dense`` with some elements replaced."""
        count = sparse.integer("count", minimum=1)
        n_views = self._root.length("bufferViews")
        where, what = sparse.object("indices"), sparse.object("values")
        index_dtype = _component_type(where)
        indices_view, values_view = where.index("bufferView", n_views), what.index("bufferView", n_views)
        if indices_view is None or values_view is None:
            raise InputError("sparse indices and values need a buffer view", where=sparse.pointer)
        indices = self._gather(where, indices_view, count, index_dtype, (1, 1))[:, 0]
        if index_dtype.kind != "u" or int(indices.max()) >= len(dense):
            raise InputError(f"expected unsigned indices below {len(dense)}", where=where.pointer)
        values = dense.copy()
        values[indices] = self._gather(what, values_view, count, dtype, shape)
        return values


def _layout(accessor: JsonView) -> tuple[np.dtype, tuple[int, int]]:
    kind = accessor.choice("type", tuple(_SHAPES))
    return _component_type(accessor), _SHAPES[kind]


def _component_type(view: JsonView) -> np.dtype:
    code = view.integer("componentType")
    if code not in _DTYPES:
        raise InputError(
            f"expected one of {', '.join(map(str, _DTYPES))}, found {code}",
            where=f"{view.pointer}/componentType",
        )
    return np.dtype(_DTYPES[code])


def _zeros(accessor: JsonView, count: int, dtype: np.dtype, shape: tuple[int, int]) -> NDArray:
    n_bytes = count * shape[0] * shape[1] * dtype.itemsize
    if n_bytes > _MAX_ZEROS_BYTES:
        raise InputError(
            f"expected at most {_MAX_ZEROS_BYTES} bytes without a buffer view, found {n_bytes}",
            where=f"{accessor.pointer}/count",
        )
    return np.zeros((count, shape[0] * shape[1]), dtype)
