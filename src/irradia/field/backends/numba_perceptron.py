"""The perceptron on tiles: forward, loss, backward and gradients of its matrices in one pass over each tile.

So a tile's activations never leave the second-level cache.
"""

from __future__ import annotations

import numpy as np

from irradia.field.backends.numba_adam import adam_sweep
from irradia.field.backends.numba_compile import inner, kernel, take
from irradia.field.backends.numba_encoding import TILE
from irradia.field.backends.numba_functions import (
    STRAIGHT,
    bend,
    head8,
    loss_and_delta,
    multiply_tiles,
    transpose_target,
)
from irradia.field.backends.numba_network import N_PARTS
from irradia.field.backends.numba_tiles import ROWS, add_products, add_row_sums, multiply
from irradia.field.backends.numba_vector import load8, splat8, store8

_STRAIGHT_ON = np.float32(1.0)  # the leak of no activation


@inner
def forward_tile(network, features, hidden, slopes, raw):
    """From features to outputs before the head, which go to ``raw``."""
    sizes = network.sizes
    n_hidden = len(sizes) - 2
    source = features
    for layer in range(n_hidden):
        target = hidden[layer]
        _ahead(network, layer, source, target, network.leak)
        if network.curve != STRAIGHT:
            bend(target, slopes[layer], sizes[layer + 1], network.curve)
        source = target
    _ahead(network, n_hidden, source, raw, _STRAIGHT_ON)


@inner
def _ahead(network, layer, source, target, leak):
    """Sums of a layer, and ReLU or its leaky kin."""
    sizes = network.sizes
    multiply(
        network.matrices[layer],
        network.biases[layer],
        sizes[layer + 1],
        sizes[layer],
        source,
        target,
        target,
        True,
        leak,
    )


@inner
def _back(network, layer, delta, n_rows, target, gate, own_gate, leak):
    """Gradient with respect to a layer's first ``n_rows`` inputs, or to the sums that ReLU made them from."""
    n_out = network.sizes[layer + 1]
    multiply(network.transposed[layer], network.no_bias, n_rows, n_out, delta, target, gate, own_gate, leak)


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
        for layer in range(len(network.matrices)):
            n_rows, n_pairs = _blocks(network, layer)
            matrices[layer, :n_rows, :n_pairs] = 0.0
        biases[:] = 0.0
        total = 0.0
        for tile in range(part * n_tiles // N_PARTS, (part + 1) * n_tiles // N_PARTS):
            total += _train_tile(
                thread, network, features[tile], n_gradients, target, tile, loss, scratch, matrices, biases
            )
        totals.loss[part] = total


@inner
def _blocks(network, layer):
    """Rows and columns of blocks that a layer's matrix takes of the square."""
    n_out, n_in = network.sizes[layer + 1], network.sizes[layer]
    return (n_out + ROWS - 1) // ROWS, (n_in + 1) // 2


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
        _back(network, layer, delta, n_in, below, source, False, network.leak)
        if network.curve != STRAIGHT:
            multiply_tiles(below, slopes[layer - 1], n_in)
        delta, below = below, delta
    if n_gradients > 0:
        _back(network, 0, delta, n_gradients, features, features, True, _STRAIGHT_ON)
    return total


@kernel
def update_network(thread, next_task, network, totals, matrices, biases, learns, gradients, adam):
    """Adam on matrices and biases; task: a layer.

    Args:
        thread, next_task: See numba_team.py.
        network: Network.
        totals: Totals.
        matrices: Learned, (layers · R · R,) each.
        biases: Learned, (layers · R,) each.
        learns: (layers, 2) whether matrix and bias learn.
        gradients: (layers, R + 1, R) zeros, and zeros again afterwards.
        adam: Adam.
    """
    n_layers, side = gradients.shape[0], gradients.shape[2]
    while True:
        layer = take(next_task)
        if layer >= n_layers:
            break
        gradient = gradients[layer]
        if learns[layer, 0]:
            _sum_matrices(totals.matrices, layer, _blocks(network, layer), gradient)
            adam_sweep(matrices, layer * side * side, side * side, gradient.ravel(), adam)
        if learns[layer, 1]:
            _sum_biases(totals.biases, layer, gradient[side])
            adam_sweep(biases, layer * side, side, gradient[side], adam)


@inner
def _sum_matrices(parts, layer, n_blocks, gradient):
    """Sums the parts in order, and undoes the blocks."""
    for i in range(n_blocks[0]):
        for j in range(n_blocks[1]):
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
