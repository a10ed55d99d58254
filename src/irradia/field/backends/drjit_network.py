"""The perceptron in Dr.Jit: batched matrix products over tiles, a kernel between them.

Products are Dr.Jit's own of tensors, in float32 and with the same bits on any number of threads. Its
cooperative vectors (``drjit.nn.CoopVec``) would put all layers into one kernel, but on CUDA they are made for
halves, and everywhere they add gradients in whatever order threads come; on the CPU they were no faster.

Matrices are (out, rows) with the bias in the column after the last input and zeros after that, which stay
zero because the rows that they meet are.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any

import drjit as dr
import numpy as np

from irradia.field.backend import F32, LossName, Parameters
from irradia.field.backends.drjit_functions import ACTIVATIONS, HEADS, loss_and_slopes
from irradia.field.backends.drjit_tiles import TILE, F, Shape, address, whole_rows, write
from irradia.field.spec import FieldSpec


@dataclass
class Tape:
    """What backward needs of forward, layer by layer.

    Attributes:
        inputs: (n_tiles, rows, 512) tensor of each matrix.
        raw: (n_tiles · out · 512,) of each matrix, before activation or head.
    """

    inputs: list[Any]
    raw: list[F]


def pack(spec: FieldSpec, arrays: Parameters) -> list[F32]:
    """Matrices with their biases, as above."""
    packed = []
    for i, (n_outputs, n_inputs) in enumerate(spec.layer_shapes()):
        matrix = np.zeros((n_outputs, whole_rows(n_inputs)), np.float32)
        matrix[:, :n_inputs] = arrays[f"mlp.{i}.weight"]
        matrix[:, n_inputs] = arrays[f"mlp.{i}.bias"]
        packed.append(matrix)
    return packed


def unpack(spec: FieldSpec, packed: list[F32]) -> Parameters:
    """The inverse of :func:`pack`."""
    found: Parameters = {}
    for i, ((n_outputs, n_inputs), flat) in enumerate(zip(spec.layer_shapes(), packed, strict=True)):
        matrix = flat.reshape(n_outputs, whole_rows(n_inputs))
        found[f"mlp.{i}.weight"] = matrix[:, :n_inputs].copy()
        found[f"mlp.{i}.bias"] = matrix[:, n_inputs].copy()
    return found


def with_bias_rows(jit: ModuleType, n_features: int, n_tiles: int) -> F:
    """Memory for features (n_tiles, rows, 512), of which only the bias and what follows it are set."""
    n_rows = whole_rows(n_features)
    found = dr.empty(jit.Float, n_tiles * n_rows * TILE)
    n_more = n_rows - n_features
    thread = dr.arange(jit.UInt, n_tiles * n_more * TILE)
    row = thread // TILE % n_more
    place = (thread // (n_more * TILE) * n_rows + n_features + row) * TILE + thread % TILE
    write(found, dr.select(row == 0, jit.Float(1.0), 0.0), place)
    return found


def forward(jit: ModuleType, spec: FieldSpec, matrices: list[F], features: F, n_tiles: int) -> Tape:
    """Raw outputs of all layers from features (n_tiles, rows, 512)."""
    tape = Tape([], [])
    values = features
    for i, (n_outputs, n_inputs) in enumerate(spec.layer_shapes()):
        n_rows = whole_rows(n_inputs)
        tape.inputs.append(jit.TensorXf(values, (n_tiles, n_rows, TILE)))
        matrix = jit.TensorXf(matrices[i], (n_outputs, n_rows))
        tape.raw.append(_product(matrix, tape.inputs[-1]).array)
        if i < spec.n_hidden_layers:
            values = _activate(jit, spec, tape.raw[-1], n_tiles)
    return tape


def outputs(jit: ModuleType, spec: FieldSpec, raw: F, n: int) -> F:
    """What the head makes of the last layer, (n, n_outputs)."""
    index = dr.arange(jit.UInt, n * spec.n_outputs)
    place = address(index // spec.n_outputs, index % spec.n_outputs, spec.n_outputs)
    return HEADS[spec.head][0](dr.gather(jit.Float, raw, place))


def loss_gradient(
    jit: ModuleType, spec: FieldSpec, loss: LossName, raw: F, targets: F, shape: Shape, factor: F
) -> tuple[F, F]:
    """The loss and where backward starts.

    Args:
        jit: Array types.
        spec: Of the field.
        loss: Its name.
        raw: Of the last layer.
        targets: (n, n_outputs).
        shape: Of the batch.
        factor: 2 / (n · n_outputs).

    Returns:
        The sum of penalties of each tile, and their mean's gradient with respect to ``raw``.
    """
    n_outputs = spec.n_outputs
    value, slope = HEADS[spec.head]
    sample = dr.arange(jit.UInt, dr.width(raw) // n_outputs)
    counts = sample < shape.n
    first = dr.minimum(sample, shape.n - 1) * n_outputs
    place = address(sample, 0, n_outputs)
    of_head = [dr.gather(jit.Float, raw, place + c * TILE) for c in range(n_outputs)]
    wanted = [dr.gather(jit.Float, targets, first + c) for c in range(n_outputs)]
    penalty, slopes = loss_and_slopes(loss, [value(z) for z in of_head], wanted)
    gradient = dr.empty(jit.Float, dr.width(raw))
    for c, (z, of_output) in enumerate(zip(of_head, slopes, strict=True)):
        write(gradient, dr.select(counts, factor * of_output * slope(z), 0.0), place + c * TILE)
    penalty = dr.select(counts, penalty, 0.0)
    dr.eval(penalty, gradient)
    return dr.block_sum(penalty, TILE), gradient


def backward(
    jit: ModuleType, spec: FieldSpec, matrices: list[F], tape: Tape, gradient: F, of_features: bool
) -> tuple[list[F], F | None]:
    """Gradients of all matrices, and (n_tiles, rows, 512) of features where they are wanted."""
    found: list[F] = []
    shapes = spec.layer_shapes()
    n_tiles = tape.inputs[0].shape[0]
    for i in range(spec.n_hidden_layers, -1, -1):
        n_outputs, n_inputs = shapes[i]
        of_raw = jit.TensorXf(gradient, (n_tiles, n_outputs, TILE))
        found.insert(0, _summed(jit, _product(of_raw, tape.inputs[i], Bt=True)))
        if i == 0 and not of_features:
            return found, None
        matrix = jit.TensorXf(matrices[i], (n_outputs, whole_rows(n_inputs)))
        gradient = _product(matrix, of_raw, At=True).array
        if i > 0:
            gradient = _pass_activation(jit, spec, gradient, tape.raw[i - 1], n_tiles)
    return found, gradient


def _activate(jit: ModuleType, spec: FieldSpec, raw: F, n_tiles: int) -> F:
    """What the next matrix is multiplied with: activations, the bias's row of ones, zeros."""
    n_rows = whole_rows(spec.width)
    index = dr.arange(jit.UInt, n_tiles * n_rows * TILE)
    row = index // TILE % n_rows
    is_unit = row < spec.width
    place = (index // (n_rows * TILE) * spec.width + row) * TILE + index % TILE
    value = ACTIVATIONS[spec.activation][0](dr.gather(jit.Float, raw, place, is_unit))
    return dr.select(is_unit, value, dr.select(row == spec.width, jit.Float(1.0), 0.0))


def _pass_activation(jit: ModuleType, spec: FieldSpec, gradient: F, raw: F, n_tiles: int) -> F:
    """The gradient with respect to raw values, from that with respect to activations."""
    n_rows = whole_rows(spec.width)
    index = dr.arange(jit.UInt, n_tiles * spec.width * TILE)
    place = (index // (spec.width * TILE) * n_rows + index // TILE % spec.width) * TILE + index % TILE
    return dr.gather(jit.Float, gradient, place) * ACTIVATIONS[spec.activation][1](raw)


def _summed(jit: ModuleType, of_tiles: Any) -> F:
    """(n_tiles, out, rows) over the tiles; one product with ones, which has an order."""
    n_tiles, n_outputs, n_rows = of_tiles.shape
    ones = dr.opaque(jit.TensorXf, 1.0, (1, n_tiles))
    return _product(ones, jit.TensorXf(of_tiles.array, (n_tiles, n_outputs * n_rows))).array


def _product(a: Any, b: Any, **transposed: bool) -> Any:
    """Of tensors; the first axis of those with three is the tile."""
    return dr.matmul(a, b, **transposed)
