"""Numba's types of vectors, and their operators."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import lower_builtin, models, register_model, type_callable

LANES = 8
_CONTRACT = ("contract",)  # a·b + c may round once


class Vector(types.Type):
    """Numba's type of a few numbers in one register.

    Attributes:
        element: Numba's type of each.
        lanes: How many.
    """

    def __init__(self, element: types.Type, lanes: int) -> None:
        self.element = element
        self.lanes = lanes
        super().__init__(name=f"{element}x{lanes}")


float8 = Vector(types.float32, LANES)
uint8 = Vector(types.uint32, LANES)
mask8 = Vector(types.boolean, LANES)
float2 = Vector(types.float32, 2)

_LLVM_ELEMENT = {types.float32: ir.FloatType(), types.uint32: ir.IntType(32), types.boolean: ir.IntType(1)}


def llvm_type(vector: Vector) -> ir.VectorType:
    """What LLVM calls it."""
    return ir.VectorType(_LLVM_ELEMENT[vector.element], vector.lanes)


@register_model(Vector)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Vector) -> None:
        super().__init__(dmm, fe_type, llvm_type(fe_type))


# --- operators -------------------------------------------------------------------------------------------


def widened(context, builder, value, found, vector):
    """A number as the vector that it is used with; vectors as they are."""
    if isinstance(found, Vector):
        return value
    value = context.cast(builder, value, found, vector.element)
    return _spread(builder, value, llvm_type(vector))


def _spread(builder, value, vector):
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), vector.count), None)
    return builder.shuffle_vector(one, ir.Constant(vector, ir.Undefined), zeros)


def _operator(function: Callable, emit: Callable, result: Callable[[Vector], Vector]) -> None:
    """Teaches Numba a binary operator between vectors, or a vector and a number."""

    @type_callable(function)
    def of_types(context):
        def typer(a, b):
            vectors = [t for t in (a, b) if isinstance(t, Vector)]
            numbers = [t for t in (a, b) if isinstance(t, types.Number)]
            if vectors and len(vectors) + len(numbers) == 2 and vectors[0] == vectors[-1]:
                return result(vectors[0])
            return None

        return typer

    def lower(context, builder, signature, arguments):
        vector = next(t for t in signature.args if isinstance(t, Vector))
        a, b = (
            widened(context, builder, value, found, vector)
            for value, found in zip(arguments, signature.args, strict=True)
        )
        return emit(builder, a, b, vector.element)

    for pair in ((Vector, Vector), (Vector, types.Number), (types.Number, Vector)):
        lower_builtin(function, *pair)(lower)


def _arithmetic(of_floats: str, of_integers: str | None) -> Callable:
    def emit(builder, a, b, element):
        if element == types.float32:
            return getattr(builder, of_floats)(a, b, flags=_CONTRACT)
        if of_integers is None:
            raise TypeError(f"no {of_floats} of integers")
        return getattr(builder, of_integers)(a, b)

    return emit


def _comparison(symbol: str) -> Callable:
    def emit(builder, a, b, element):
        if element == types.float32:
            return builder.fcmp_ordered(symbol, a, b)  # false where either is NaN
        return builder.icmp_unsigned(symbol, a, b)

    return emit


def _of_integers(name: str) -> Callable:
    return lambda builder, a, b, element: getattr(builder, name)(a, b)


def _same(vector: Vector) -> Vector:
    return vector


for _function, _floats, _integers in (
    (operator.add, "fadd", "add"),
    (operator.sub, "fsub", "sub"),
    (operator.mul, "fmul", "mul"),
    (operator.truediv, "fdiv", None),
):
    _operator(_function, _arithmetic(_floats, _integers), _same)
for _function, _symbol in (
    (operator.lt, "<"),
    (operator.gt, ">"),
    (operator.le, "<="),
    (operator.ge, ">="),
    (operator.eq, "=="),
):
    _operator(_function, _comparison(_symbol), lambda vector: mask8)
for _function, _name in (
    (operator.and_, "and_"),
    (operator.xor, "xor"),
    (operator.lshift, "shl"),
    (operator.rshift, "lshr"),
):
    _operator(_function, _of_integers(_name), _same)
