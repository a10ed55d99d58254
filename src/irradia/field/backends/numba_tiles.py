"""Products of matrices with tiles: the two micro-kernels that most arithmetic of a training runs through.

A tile is (rows, 272) float32 with the features of 256 samples in its columns; see numba_encoding.py. Rows of
matrices and tiles are filled up to whole blocks of 4, matrices with zeros.

A block is 4 rows × 16 samples, in eight registers. A step along the inner rows takes 2 loads of samples, 4 of
weights and 8 fused multiply-adds, as many as two loads a cycle can feed. Blocks of 3 × 4 registers would load
less, but spill.
"""

from __future__ import annotations

from irradia.field.backends.numba_compile import inner
from irradia.field.backends.numba_encoding import TILE
from irradia.field.backends.numba_vector import fma, load8, select, splat8, store8, sums8

ROWS = 4  # of a block
_PAIR = 16  # samples in two registers


@inner
def multiply(matrix, bias, n_rows, n_inner, source, target, gate, own_gate, leak):
    """Writes matrix · source + bias, times ``leak`` where the gate isn't above 0.

    Forward, the gate is the sum itself: ``leak`` 0 is ReLU, 1 no activation. Backward, it is what the
    activation gave, whose sign is that of its argument.

    Args:
        matrix: (rows, inner), at least ``n_rows`` filled up to blocks.
        bias: (rows,).
        n_rows: Of the target; whole blocks are written.
        n_inner: Rows of the source that count.
        source: Tile.
        target: Tile.
        gate: Tile with the rows of the target; may be the target.
        own_gate: Whether the sum is its own gate, so ``gate`` isn't read.
        leak: See above.
    """
    for s in range(0, TILE, _PAIR):
        for i in range(0, n_rows, ROWS):
            a0 = a1 = splat8(bias[i])
            b0 = b1 = splat8(bias[i + 1])
            c0 = c1 = splat8(bias[i + 2])
            d0 = d1 = splat8(bias[i + 3])
            for k in range(n_inner):
                x0, x1 = load8(source, (k, s)), load8(source, (k, s + 8))
                w = splat8(matrix[i, k])
                a0, a1 = fma(w, x0, a0), fma(w, x1, a1)
                w = splat8(matrix[i + 1, k])
                b0, b1 = fma(w, x0, b0), fma(w, x1, b1)
                w = splat8(matrix[i + 2, k])
                c0, c1 = fma(w, x0, c0), fma(w, x1, c1)
                w = splat8(matrix[i + 3, k])
                d0, d1 = fma(w, x0, d0), fma(w, x1, d1)
            _store_pair(target, i, s, a0, a1, gate, own_gate, leak)
            _store_pair(target, i + 1, s, b0, b1, gate, own_gate, leak)
            _store_pair(target, i + 2, s, c0, c1, gate, own_gate, leak)
            _store_pair(target, i + 3, s, d0, d1, gate, own_gate, leak)


@inner
def _store_pair(target, row, s, z0, z1, gate, own_gate, leak):
    if own_gate:
        g0, g1 = z0, z1
    else:
        g0, g1 = load8(gate, (row, s)), load8(gate, (row, s + 8))
    # NaN isn't above 0, and leak · NaN is NaN.
    store8(target, (row, s), select(g0 > 0.0, z0, leak * z0))
    store8(target, (row, s + 8), select(g1 > 0.0, z1, leak * z1))


@inner
def add_products(delta, n_rows, source, n_columns, totals):
    """Adds delta · sourceᵀ, summed over a tile's samples: the gradient of a matrix.

    Args:
        delta: Tile with the gradient of ``n_rows`` outputs.
        n_rows: Whole blocks are taken.
        source: Tile with ``n_columns`` inputs.
        n_columns: Whole pairs are taken.
        totals: (rows / 4, columns / 2, 8), added to: each block of 4 × 2, row by row.
    """
    for i in range(0, n_rows, ROWS):
        for j in range(0, n_columns, 2):
            a0 = a1 = b0 = b1 = c0 = c1 = d0 = d1 = splat8(0.0)
            for s in range(0, TILE, 8):
                x0, x1 = load8(source, (j, s)), load8(source, (j + 1, s))
                g = load8(delta, (i, s))
                a0, a1 = fma(g, x0, a0), fma(g, x1, a1)
                g = load8(delta, (i + 1, s))
                b0, b1 = fma(g, x0, b0), fma(g, x1, b1)
                g = load8(delta, (i + 2, s))
                c0, c1 = fma(g, x0, c0), fma(g, x1, c1)
                g = load8(delta, (i + 3, s))
                d0, d1 = fma(g, x0, d0), fma(g, x1, d1)
            at = (i // ROWS, j // 2, 0)
            store8(totals, at, load8(totals, at) + sums8(a0, a1, b0, b1, c0, c1, d0, d1))


@inner
def add_row_sums(delta, n_rows, totals):
    """Adds each row's sum, in eight parts, to ``totals`` (rows, 8): the gradient of a bias."""
    for i in range(n_rows):
        total = load8(totals, (i, 0))
        for s in range(0, TILE, 8):
            total = total + load8(delta, (i, s))
        store8(totals, (i, 0), total)
