"""Vectors of eight numbers inside Numba kernels, in so many words.

LLVM finds vectors by itself in simple loops only; the loops that matter here hold tiles in registers over
many steps. So kernels say what stands in a register::

    total = fma(splat8(weight[i, k]), load8(features, (k, s)), total)

``+ - * /``, comparisons, and for integers ``& ^ << >>`` work lane by lane, and a number beside a vector is
spread over its lanes. Without AVX, LLVM halves the vectors. Products and sums may be fused; nothing else is
rearranged, and NaN stays NaN.

Also here: how kernels are compiled, and how the threads of a team share tasks.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any, cast

from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic as numba_intrinsic
from numba.extending import lower_builtin, models, register_model, type_callable

LANES = 8


def _stamp() -> bytes:
    """Changes with any of the kernels' files."""
    files = sorted(Path(__file__).parent.glob("numba_*.py"))
    return sha256(b"".join(file.read_bytes() for file in files)).digest()


_STAMP = _stamp()


def _compiled(function: Callable, *, nogil: bool) -> Any:
    """Compiles when first called, and keeps the code on disk.

    Numba takes that code for fresh as long as the function's own file hasn't changed. Ours holds functions
    of other files too, so all of them count.
    """
    dispatcher: Any = njit(cache=True, nogil=nogil, error_model="numpy")(function)
    dispatcher._cache._cache_file._source_stamp = _STAMP
    return dispatcher


def kernel(function: Callable) -> Any:
    """Makes what a team runs, so without Python's lock: ``kernel(thread, next_task, ...)``."""
    return _compiled(function, nogil=True)


def inner(function: Callable) -> Any:
    """Makes what kernels call."""
    return _compiled(function, nogil=False)


def intrinsic(emitter: Callable) -> Any:
    """As Numba's, whose types would have it called with what Numba calls it with."""
    return numba_intrinsic(emitter)


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


def _llvm(vector: Vector) -> ir.VectorType:
    return ir.VectorType(_LLVM_ELEMENT[vector.element], vector.lanes)


@register_model(Vector)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Vector) -> None:
        super().__init__(dmm, fe_type, _llvm(fe_type))


# --- operators -------------------------------------------------------------------------------------------


def _wide(context, builder, value, found, vector):
    """A number as the vector that it is used with; vectors as they are."""
    if isinstance(found, Vector):
        return value
    value = context.cast(builder, value, found, vector.element)
    return _spread(builder, value, _llvm(vector))


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
            _wide(context, builder, value, found, vector)
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


# --- memory ----------------------------------------------------------------------------------------------


def _address(context, builder, array_type, array, index_type, index, vector):
    """Pointer to ``vector`` in an array; no wrap-around of negative indices, no check of bounds."""
    if isinstance(index_type, types.BaseTuple):
        kinds, values = list(cast(Any, index_type)), cgutils.unpack_tuple(builder, index)
    else:
        kinds, values = [index_type], [index]
    values = [
        context.cast(builder, value, kind, types.intp) for value, kind in zip(values, kinds, strict=True)
    ]
    array = context.make_array(array_type)(context, builder, array)
    item = cgutils.get_item_pointer(context, builder, array_type, array, values, wraparound=False)
    return builder.bitcast(item, _llvm(vector).as_pointer())


def _loader(vector: Vector, summary: str) -> Any:
    def load(typing_context, array, index):
        def emit(context, builder, signature, arguments):
            of_array, of_index = signature.args
            address = _address(context, builder, of_array, arguments[0], of_index, arguments[1], vector)
            return builder.load(address, align=4)

        return vector(array, index), emit

    load.__doc__ = summary
    return intrinsic(load)


def _storer(vector: Vector, summary: str) -> Any:
    def store(typing_context, array, index, value):
        def emit(context, builder, signature, arguments):
            of_array, of_index, _ = signature.args
            address = _address(context, builder, of_array, arguments[0], of_index, arguments[1], vector)
            builder.store(arguments[2], address, align=4)
            return context.get_dummy_value()

        return types.void(array, index, value), emit

    store.__doc__ = summary
    return intrinsic(store)


load8 = _loader(float8, "Eight floats of a contiguous array from an index, or a tuple of them, on.")
store8 = _storer(float8, "Writes eight floats to a contiguous array from an index on.")
load_uint8 = _loader(uint8, "Eight unsigned integers of a contiguous array from an index on.")
store_uint8 = _storer(uint8, "Writes eight unsigned integers to a contiguous array from an index on.")
load2 = _loader(float2, "Two floats of a contiguous array from an index on.")
store2 = _storer(float2, "Writes two floats to a contiguous array from an index on.")


@intrinsic
def touch(typing_context, array, index):
    """Reads at an index so that its cache line comes near. A prefetch won't do: processors drop those."""

    def emit(context, builder, signature, arguments):
        of_array, of_index = signature.args
        address = _address(context, builder, of_array, arguments[0], of_index, arguments[1], float8)
        i32 = ir.IntType(32)
        value = builder.load(builder.bitcast(address, i32.as_pointer()), align=4)
        # An empty instruction that takes the value, so that the compiler can't leave the reading out.
        builder.asm(ir.FunctionType(ir.VoidType(), [i32]), "", "r", [value], side_effect=True)
        return context.get_dummy_value()

    return types.void(array, index), emit


# --- making and joining vectors --------------------------------------------------------------------------


def _splatter(vector: Vector, summary: str) -> Any:
    def splat(typing_context, value):
        def emit(context, builder, signature, arguments):
            return _wide(context, builder, arguments[0], signature.args[0], vector)

        return (vector(value), emit) if isinstance(value, types.Number) else None

    splat.__doc__ = summary
    return intrinsic(splat)


splat8 = _splatter(float8, "A float in all eight lanes.")
splat_uint8 = _splatter(uint8, "An unsigned integer in all eight lanes.")
splat2 = _splatter(float2, "A float in both lanes.")


def _plain(kind: types.Type) -> types.Type:
    """The type that float8 arithmetic works with: vectors as they are, Python's floats as float32."""
    return kind if isinstance(kind, Vector) else types.float32


def _llvm_function(name: str, n_arguments: int, summary: str) -> Any:
    """One of LLVM's functions of floats, for a number or for every lane of a vector."""

    def emit(context, builder, signature, arguments):
        cast = [
            context.cast(builder, value, kind, signature.return_type)
            if not isinstance(kind, Vector)
            else value
            for value, kind in zip(arguments, signature.args, strict=True)
        ]
        kind = cast[0].type
        suffix = f"v{kind.count}f32" if isinstance(kind, ir.VectorType) else "f32"
        type_ = ir.FunctionType(kind, [kind] * n_arguments)
        return builder.call(
            cgutils.get_or_insert_function(builder.module, type_, f"llvm.{name}.{suffix}"), cast
        )

    def of_one(typing_context, a):
        return _plain(a)(a), emit

    def of_three(typing_context, a, b, c):
        return _plain(a)(a, b, c), emit

    call = of_one if n_arguments == 1 else of_three
    call.__doc__ = summary
    return intrinsic(call)


fma = _llvm_function("fma", 3, "a · b + c, rounded once.")
square_root = _llvm_function("sqrt", 1, "Rounded correctly.")
absolute = _llvm_function("fabs", 1, "Without its sign.")
floor = _llvm_function("floor", 1, "The whole number at or below.")
nearest = _llvm_function("rint", 1, "The nearest whole number, of two the even one.")


@intrinsic
def rounded_product(typing_context, a, b):
    """Each lane of ``a`` times the number ``b``, rounded before anything is added to it."""

    def emit(context, builder, signature, arguments):
        return builder.fmul(arguments[0], _wide(context, builder, arguments[1], signature.args[1], a))

    return a(a, b), emit


@intrinsic
def join2(typing_context, a, b):
    """Two floats side by side."""

    def emit(context, builder, signature, arguments):
        vector = ir.Constant(_llvm(float2), ir.Undefined)
        for i, value in enumerate(arguments):
            vector = builder.insert_element(vector, value, ir.Constant(ir.IntType(32), i))
        return vector

    return float2(types.float32, types.float32), emit


@intrinsic
def select(typing_context, condition, a, b):
    """``a`` where the condition holds, else ``b``; of numbers, or lane by lane."""
    result = next((kind for kind in (a, b) if isinstance(kind, Vector)), types.float32)

    def emit(context, builder, signature, arguments):
        _, of_a, of_b = signature.args
        if isinstance(result, Vector):
            yes = _wide(context, builder, arguments[1], of_a, result)
            no = _wide(context, builder, arguments[2], of_b, result)
        else:
            yes = context.cast(builder, arguments[1], of_a, result)
            no = context.cast(builder, arguments[2], of_b, result)
        return builder.select(arguments[0], yes, no)

    return result(condition, a, b), emit


def _converter(source: Vector, target: Vector, instruction: str, summary: str) -> Any:
    def convert(typing_context, value):
        def emit(context, builder, signature, arguments):
            return getattr(builder, instruction)(arguments[0], _llvm(target))

        return (target(value), emit) if value == source else None

    convert.__doc__ = summary
    return intrinsic(convert)


# Signed conversions, as AVX2 has no unsigned ones; so both want numbers below 2^31.
whole8 = _converter(float8, uint8, "fptosi", "Floats that are whole and not negative, as integers.")
real8 = _converter(uint8, float8, "sitofp", "Integers as floats.")
bits8 = _converter(float8, uint8, "bitcast", "The bits of floats.")
of_bits8 = _converter(uint8, float8, "bitcast", "Floats of these bits.")


@intrinsic
def sums8(typing_context, a, b, c, d, e, f, g, h):
    """The eight sums over the lanes of eight vectors, as one vector.

    A tree of three levels: each adds even to odd lanes of two vectors at a time.
    """

    def emit(context, builder, signature, arguments):
        i32 = ir.IntType(32)

        def pick(x, y, lanes):
            return builder.shuffle_vector(x, y, ir.Constant(ir.VectorType(i32, LANES), lanes))

        # Within halves of four lanes, as AVX shuffles do; the last level joins the halves.
        def joined(x, y):
            even = pick(x, y, [0, 2, 8, 10, 4, 6, 12, 14])
            odd = pick(x, y, [1, 3, 9, 11, 5, 7, 13, 15])
            return builder.fadd(even, odd)

        ab, cd, ef, gh = (joined(arguments[i], arguments[i + 1]) for i in range(0, LANES, 2))
        abcd, efgh = joined(ab, cd), joined(ef, gh)
        low = pick(abcd, efgh, [0, 1, 2, 3, 8, 9, 10, 11])
        high = pick(abcd, efgh, [4, 5, 6, 7, 12, 13, 14, 15])
        return builder.fadd(low, high)

    return float8(a, b, c, d, e, f, g, h), emit


@intrinsic
def lane(typing_context, vector, index):
    """One number of a vector."""

    def emit(context, builder, signature, arguments):
        return builder.extract_element(arguments[0], builder.trunc(arguments[1], ir.IntType(32)))

    return (vector.element(vector, types.intp), emit) if isinstance(vector, Vector) else None


# --- threads ---------------------------------------------------------------------------------------------


@intrinsic
def take(typing_context, counter):
    """Counts up the (1,) int64 array by one, for all threads at once, and returns what it was."""

    def emit(context, builder, signature, arguments):
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.atomic_rmw("add", array.data, ir.Constant(ir.IntType(64), 1), "monotonic")

    return types.int64(counter), emit
