"""Eight vectors of eight as a matrix in registers, turned over.

Parameters of a texel lie side by side in memory, samples of a tile do too; so between them rows must become
columns.
"""

from __future__ import annotations

from llvmlite import ir
from numba import types

from irradia.field.backends.numba_compile import intrinsic
from irradia.field.backends.numba_vector_type import LANES, float8

# Lanes of two vectors, of the second from 8 on. Each step stays within halves of four lanes, as the cheap
# shuffles do, but the last.
_LOW_SINGLES, _HIGH_SINGLES = (0, 8, 1, 9, 4, 12, 5, 13), (2, 10, 3, 11, 6, 14, 7, 15)
_LOW_PAIRS, _HIGH_PAIRS = (0, 1, 8, 9, 4, 5, 12, 13), (2, 3, 10, 11, 6, 7, 14, 15)
_LOW_HALVES, _HIGH_HALVES = (0, 1, 2, 3, 8, 9, 10, 11), (4, 5, 6, 7, 12, 13, 14, 15)


@intrinsic
def transpose8(typing_context, a, b, c, d, e, f, g, h):
    """Lane i of the k-th vector becomes lane k of the i-th of the eight that come back."""
    result = types.UniTuple(float8, LANES)

    def emit(context, builder, signature, arguments):
        def pick(x, y, lanes):
            mask = ir.Constant(ir.VectorType(ir.IntType(32), LANES), list(lanes))
            return builder.shuffle_vector(x, y, mask)

        r = arguments
        r = [pick(r[i], r[i + 1], m) for i in (0, 2, 4, 6) for m in (_LOW_SINGLES, _HIGH_SINGLES)]
        # Now r[2 k] and r[2 k + 1] hold rows 2 k and 2 k + 1, lane by lane.
        r = [
            pick(r[i + j], r[i + j + 2], m) for i in (0, 4) for j in (0, 1) for m in (_LOW_PAIRS, _HIGH_PAIRS)
        ]
        # And r[i], r[i + 4] hold columns i and i + 4 of the upper and the lower four rows.
        r = [pick(r[i], r[i + 4], m) for m in (_LOW_HALVES, _HIGH_HALVES) for i in range(4)]
        return context.make_tuple(builder, result, r)

    return result(a, b, c, d, e, f, g, h), emit
