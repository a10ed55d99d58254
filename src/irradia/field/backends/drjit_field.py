"""Evaluating a field in Dr.Jit."""

from __future__ import annotations

from types import ModuleType

import drjit as dr
import numpy as np

from irradia.field.backend import F32, Evaluator, Parameters
from irradia.field.backends.drjit_encoding import Constants, Placed, place_all
from irradia.field.backends.drjit_network import forward, outputs, pack, with_bias_rows
from irradia.field.backends.drjit_tiles import F, Points, Shape, n_tiles, shape_of, upload, whole_rows
from irradia.field.spec import FieldSpec

CHUNK = 1 << 18  # points at once, to bound memory


class DrJitEvaluator(Evaluator):
    """A network that only runs forward."""

    def __init__(self, spec: FieldSpec, parameters: Parameters, jit: ModuleType) -> None:
        self._spec, self._jit = spec, jit
        self._placed = place_all(spec, jit)
        self._constants = [each.fast.constants() for each in self._placed]
        encodings = (name for name in parameters if not name.startswith("mlp."))
        self._tables = {name: upload(jit, parameters[name]) for name in encodings}
        self._matrices = [upload(jit, matrix) for matrix in pack(spec, parameters)]
        dr.sync_thread()  # copying has ended

    def __call__(self, x: F32, normal: F32 | None) -> F32:
        """See the base class."""
        found = np.empty((len(x), self._spec.n_outputs), np.float32)
        for first in range(0, len(x), CHUNK):
            some = slice(first, first + CHUNK)
            found[some] = self._evaluate(x[some], None if normal is None else normal[some])
        return found

    def _evaluate(self, x: F32, normal: F32 | None) -> F32:
        jit, spec, n = self._jit, self._spec, len(x)
        shape = shape_of(jit, n)
        points = points_of(jit, x, normal, shape)
        with precise():
            features = encode(
                jit, spec, self._placed, points, self._tables, shape, self._constants, n_tiles(n)
            )
            raw = forward(jit, spec, self._matrices, features, n_tiles(n)).raw[-1]
            return outputs(jit, spec, raw, n).numpy().reshape(n, spec.n_outputs)


def precise() -> dr.scoped_set_flag:
    """Kernels traced within keep every rounding, as the reference has them."""
    return dr.scoped_set_flag(dr.JitFlag.FastMath, False)


def points_of(jit: ModuleType, x: F32, normal: F32 | None, shape: Shape) -> dict[str, Points]:
    """What each encoding sees, by its name among the parameters."""
    found = {"position": Points(upload(jit, x), shape.n)}
    if normal is not None:
        found["direction"] = Points(upload(jit, normal), shape.n)
    return found


def encode(
    jit: ModuleType,
    spec: FieldSpec,
    placed: list[Placed],
    points: dict[str, Points],
    tables: dict[str, F],
    shape: Shape,
    constants: list[Constants],
    tiles: int,
) -> F:
    """Features (tiles, rows, 512) with the bias's row."""
    n_rows = whole_rows(spec.n_inputs)
    features = with_bias_rows(jit, spec.n_inputs, tiles)
    for each, own in zip(placed, constants, strict=True):
        each.encode(features, n_rows, points[each.name], tables.get(each.name), shape, own)
    dr.eval(features)
    return features
