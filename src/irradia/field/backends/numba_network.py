"""A perceptron's parameters, gradients and scratch memory as its kernels want them.

Every matrix stands in a square that all fit in, filled up with zeros: one kernel then serves every number of
layers and every width, and the zeros stay zero.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from irradia.field.backend import F32, Parameters
from irradia.field.backends.numba_encoding import STRIDE
from irradia.field.backends.numba_functions import (
    CURVES,
    HEADS,
    LEAKS,
    STRAIGHT,
)
from irradia.field.backends.numba_tiles import ROWS
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
