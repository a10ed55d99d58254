"""Sums that don't depend on their order.

Many samples meet in one entry of a table, and which of them adds first changes from run to run; floats
would round differently each time. Here gradients are added as 64-bit integers, of which no order loses
anything: the same bits on any number of threads, on the GPU too, with 40 bits below the batch's largest.
"""

from __future__ import annotations

import math
from types import ModuleType
from typing import Any

import drjit as dr

from irradia.field.backends.drjit_tiles import F, U

_EXPONENT = 23  # bits below a float's exponent


def room_for(n: int) -> int:
    """What :func:`scale_of` has to know of a batch of ``n``: no sum may leave 63 bits."""
    # The largest gradient is below 2^(e − 126), e its stored exponent, and a sample's weights sum to 1. So
    # sums stay below 2^62 if they are multiplied by 2^(b − 127) with b = 315 − log2 n − e.
    return 315 - math.ceil(math.log2(max(n, 2)))


def scale_of(jit: ModuleType, gradients: F, room: U) -> tuple[F, F]:
    """Powers of two to multiply with before adding and after.

    Args:
        jit: Array types.
        gradients: All that will be added. If one isn't finite, all sums come out as NaN.
        room: From :func:`room_for`.
    """
    # As whole numbers, floats without sign are in the same order, and above them all is what isn't a number.
    bits: U = dr.reinterpret_array(jit.UInt, dr.abs(gradients))
    exponent: U = dr.max(bits) >> _EXPONENT
    # These are all powers that are normal floats; the last bits of gradients below 1e-25 are lost to that.
    stored = dr.clip(jit.Int(room) - jit.Int(exponent), 1, 253)
    before = dr.reinterpret_array(jit.Float, jit.UInt(stored) << _EXPONENT)
    after = dr.reinterpret_array(jit.Float, jit.UInt(254 - stored) << _EXPONENT)
    return before, dr.select(exponent == 255, dr.nan, after)


def add(jit: ModuleType, target: Any, value: F, index: U) -> None:
    """Adds a scaled value to a UInt64, which wraps as signed numbers do."""
    whole = dr.reinterpret_array(jit.UInt64, jit.Int64(value))
    dr.scatter_reduce(dr.ReduceOp.Add, target, whole, index)


def total(jit: ModuleType, sums: Any, after: F) -> F:
    """The sums as floats."""
    return jit.Float(dr.reinterpret_array(jit.Int64, sums)) * after
