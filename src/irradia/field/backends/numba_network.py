"""The perceptron on tiles: forward, loss, backward and gradients of its matrices in one pass over each tile.

So a tile's activations never leave the second-level cache. Every matrix stands in a square that all fit in,
filled up with zeros: one kernel then serves every number of layers and every width, and the zeros stay zero.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from irradia.field.backend import F32, Parameters
from irradia.field.backends.numba_adam import adam_sweep
from irradia.field.backends.numba_compile import inner, kernel, take
from irradia.field.backends.numba_encoding import STRIDE, TILE
from irradia.field.backends.numba_functions import (
    CURVES,
    HEADS,
    LEAKS,
    STRAIGHT,
    bend,
    head8,
    loss_and_delta,
    multiply_tiles,
    transpose_target,
)
from irradia.field.backends.numba_tiles import ROWS, add_products, add_row_sums, multiply
from irradia.field.backends.numba_vector import load8, splat8, store8
from irradia.field.spec import FieldSpec

# Gradients are summed over so many runs of tiles, then over the runs in order: as many as threads can share,
# and always the same number, so that the number of threads doesn't show in the bits.
N_PARTS = 32


class Network(NamedTuple):
    """A perceptron as kernels see it.

    Attributes:
        matrices: (layers, R, R), each [out, in] in its corner.
        transposed: (layers, R, R), each [in, out].
        biases: (layers, R).
        no_bias: (R,) zeros.
        sizes: (layers + 1,) numbers of inputs, hidden units and outputs.
        leak, curve: The activation; see numba_functions.py.
        head: By number.
    """

    matrices: F32
    transposed: F32
    biases: F32
    no_bias: F32
    sizes: NDArray[np.int64]
    leak: np.float32
    curve: int
    head: int


class Scratch(NamedTuple):
    """Memory for each thread's tile.

    Attributes:
        hidden: (threads, hidden layers, R, 272) activations.
        slopes: The same, of curved activations; (threads, 1, R, 272) unused for straight ones.
        deltas: (threads, 2, R, 272) gradients with respect to one layer's sums, and to the next's.
        target: (threads, outputs + 1, 272).
    """

    hidden: F32
    slopes: F32
    deltas: F32
    target: F32


class Totals(NamedTuple):
    """Sums over a batch, in parts.

    Attributes:
        matrices: (32, layers, R / 4, R / 2, 8); see numba_tiles.add_products.
        biases: (32, layers, R, 8).
        loss: (32,) float64.
    """

    matrices: F32
    biases: F32
    loss: NDArray[np.float64]


def whole_blocks(n: int) -> int:
    """Rows that ``n`` rows take, filled up to blocks."""
    return -(-n // ROWS) * ROWS


def square_of(spec: FieldSpec) -> int:
    """R: rows and columns that hold every matrix of a spec."""
    return whole_blocks(max(spec.n_inputs, spec.width, spec.n_outputs))


def pack(spec: FieldSpec, parameters: Parameters) -> tuple[F32, F32]:
    """Matrices (layers, R, R) and biases (layers, R) filled up with zeros."""
    n_layers, side = spec.n_hidden_layers + 1, square_of(spec)
    matrices = np.zeros((n_layers, side, side), np.float32)
    biases = np.zeros((n_layers, side), np.float32)
    for i, (n_out, n_in) in enumerate(spec.layer_shapes()):
        matrices[i, :n_out, :n_in] = parameters[f"mlp.{i}.weight"]
        biases[i, :n_out] = parameters[f"mlp.{i}.bias"]
    return matrices, biases


def unpack(spec: FieldSpec, matrices: F32, biases: F32) -> Parameters:
    """What :func:`pack` packed, copied."""
    found: Parameters = {}
    for i, (n_out, n_in) in enumerate(spec.layer_shapes()):
        found[f"mlp.{i}.weight"] = matrices[i, :n_out, :n_in].copy()
        found[f"mlp.{i}.bias"] = biases[i, :n_out].copy()
    return found


def make_network(spec: FieldSpec, matrices: F32, biases: F32) -> Network:
    """A perceptron from packed parameters, which it shares; ``transposed`` is not yet filled."""
    sizes = [spec.n_inputs, *[out for out, _ in spec.layer_shapes()]]
    return Network(
        matrices,
        np.zeros_like(matrices),
        biases,
        np.zeros(biases.shape[1], np.float32),
        np.array(sizes, np.int64),
        np.float32(LEAKS.get(spec.activation, 1.0)),
        CURVES.index(spec.activation) if spec.activation in CURVES else STRAIGHT,
        HEADS.index(spec.head),
    )


def make_scratch(spec: FieldSpec, n_threads: int, *, training: bool) -> Scratch:
    """Tiles for the threads of a team; those that only training needs are left out otherwise."""
    side, curved = square_of(spec), spec.activation in CURVES
    n_slopes = spec.n_hidden_layers if curved else 1
    return Scratch(
        np.zeros((n_threads, spec.n_hidden_layers, side, STRIDE), np.float32),
        np.zeros((n_threads, n_slopes, side, STRIDE), np.float32),
        np.zeros((n_threads, 2 if training else 1, side, STRIDE), np.float32),
        np.zeros((n_threads, spec.n_outputs + 1 if training else 1, STRIDE), np.float32),
    )


def make_totals(spec: FieldSpec) -> Totals:
    """Zeros."""
    n_layers, side = spec.n_hidden_layers + 1, square_of(spec)
    return Totals(
        np.zeros((N_PARTS, n_layers, side // ROWS, side // 2, 8), np.float32),
        np.zeros((N_PARTS, n_layers, side, 8), np.float32),
        np.zeros(N_PARTS, np.float64),
    )


@inner
def forward_tile(network, features, hidden, slopes, raw):
    """From features to outputs before the head, which go to ``raw``."""
    sizes = network.sizes
    n_hidden = len(sizes) - 2
    source = features
    for layer in range(n_hidden):
        target = hidden[layer]
        n_out = sizes[layer + 1]
        multiply(
            network.matrices[layer],
            network.biases[layer],
            n_out,
            sizes[layer],
            source,
            target,
            target,
            True,
            network.leak,
        )
        if network.curve != STRAIGHT:
            bend(target, slopes[layer], n_out, network.curve)
        source = target
    multiply(
        network.matrices[n_hidden],
        network.biases[n_hidden],
        sizes[n_hidden + 1],
        sizes[n_hidden],
        source,
        raw,
        raw,
        True,
        np.float32(1.0),
    )


@kernel
def infer(thread, next_task, network, features, scratch, first, outputs):
    """Outputs after the head of tiles of features; task: a tile.

    Args:
        thread, next_task: See numba_team.py.
        network: Network.
        features: (n_tiles, rows, 272).
        scratch: Scratch.
        first: Of the samples in ``outputs`` that the first tile holds.
        outputs: (N, n_outputs), written.
    """
    n_outputs = network.sizes[-1]
    raw = scratch.deltas[thread, 0]
    while True:
        tile = take(next_task)
        if tile >= features.shape[0]:
            break
        forward_tile(network, features[tile], scratch.hidden[thread], scratch.slopes[thread], raw)
        for c in range(n_outputs):
            for s in range(0, TILE, 8):
                store8(raw, (c, s), head8(load8(raw, (c, s)), network.head)[0])
        start = first + tile * TILE
        for s in range(min(TILE, len(outputs) - start)):
            for c in range(n_outputs):
                outputs[start + s, c] = raw[c, s]


@kernel
def train(thread, next_task, network, features, n_gradients, target, loss, scratch, totals):
    """Loss of a batch and its gradients with respect to matrices, biases and features; task: a part.

    Args:
        thread, next_task: See numba_team.py.
        network: Network.
        features: (n_tiles, rows, 272); rows below ``n_gradients``, in whole blocks, become the loss's
            gradient with respect to them.
        n_gradients: 0 where no encoding learns.
        target: (N, n_outputs).
        loss: By number.
        scratch: Scratch.
        totals: Totals, written.
    """
    n_tiles = features.shape[0]
    while True:
        part = take(next_task)
        if part >= N_PARTS:
            break
        matrices, biases = totals.matrices[part], totals.biases[part]
        matrices[:] = 0.0
        biases[:] = 0.0
        total = 0.0
        for tile in range(part * n_tiles // N_PARTS, (part + 1) * n_tiles // N_PARTS):
            total += _train_tile(
                thread, network, features[tile], n_gradients, target, tile, loss, scratch, matrices, biases
            )
        totals.loss[part] = total


@inner
def _train_tile(thread, network, features, n_gradients, target, tile, loss, scratch, matrices, biases):
    sizes = network.sizes
    n_hidden = len(sizes) - 2
    n_samples, n_outputs = target.shape
    hidden, slopes = scratch.hidden[thread], scratch.slopes[thread]
    delta, below = scratch.deltas[thread, 0], scratch.deltas[thread, 1]

    # --- forward and loss ---
    forward_tile(network, features, hidden, slopes, delta)
    first = tile * TILE
    wanted = scratch.target[thread]
    transpose_target(target, first, min(TILE, n_samples - first), wanted)
    gradient_scale = np.float32(2.0 / (n_samples * n_outputs))
    total = loss_and_delta(delta, wanted, n_outputs, network.head, loss, gradient_scale)

    # --- backward; delta is the gradient with respect to a layer's sums ---
    for layer in range(n_hidden, -1, -1):
        source = features
        if layer > 0:
            source = hidden[layer - 1]
        n_out, n_in = sizes[layer + 1], sizes[layer]
        add_products(delta, n_out, source, n_in, matrices[layer])
        add_row_sums(delta, n_out, biases[layer])
        if layer == 0:
            break
        multiply(
            network.transposed[layer],
            network.no_bias,
            n_in,
            n_out,
            delta,
            below,
            source,
            False,
            network.leak,
        )
        if network.curve != STRAIGHT:
            multiply_tiles(below, slopes[layer - 1], n_in)
        delta, below = below, delta
    if n_gradients > 0:
        multiply(
            network.transposed[0],
            network.no_bias,
            n_gradients,
            sizes[1],
            delta,
            features,
            features,
            True,
            np.float32(1.0),
        )
    return total


@kernel
def update_network(thread, next_task, totals, learned_matrices, learned_biases, learns, gradients, adam):
    """Adam on matrices and biases; task: a layer.

    Args:
        thread, next_task: See numba_team.py.
        totals: Totals.
        learned_matrices: Learned, (layers · R · R,) each.
        learned_biases: Learned, (layers · R,) each.
        learns: (layers, 2) whether matrix and bias learn.
        gradients: (layers, R + 1, R) scratch memory.
        adam: Adam.
    """
    n_layers, side = gradients.shape[0], gradients.shape[2]
    while True:
        layer = take(next_task)
        if layer >= n_layers:
            break
        gradient = gradients[layer]
        if learns[layer, 0]:
            _sum_matrices(totals.matrices, layer, gradient)
            adam_sweep(learned_matrices, layer * side * side, side * side, gradient.ravel(), adam)
        if learns[layer, 1]:
            _sum_biases(totals.biases, layer, gradient[side])
            adam_sweep(learned_biases, layer * side, side, gradient[side], adam)


@inner
def _sum_matrices(parts, layer, gradient):
    """Sums the parts in order, and undoes the blocks."""
    for i in range(parts.shape[2]):
        for j in range(parts.shape[3]):
            total = splat8(0.0)
            for part in range(N_PARTS):
                total = total + load8(parts, (part, layer, i, j, 0))
            store8(parts, (0, layer, i, j, 0), total)
            for k in range(8):
                gradient[i * ROWS + k // 2, j * 2 + k % 2] = parts[0, layer, i, j, k]


@inner
def _sum_biases(parts, layer, gradient):
    for i in range(parts.shape[2]):
        total = 0.0
        for part in range(N_PARTS):
            for k in range(8):
                total += parts[part, layer, i, k]
        gradient[i] = total
