"""Vectors of eight numbers inside Numba kernels, in so many words.

LLVM finds vectors by itself in simple loops only; the loops that matter here hold tiles in registers over
many steps. So kernels say what stands in a register::

    total = fma(splat8(weight[i, k]), load8(features, (k, s)), total)

``+ - * /``, comparisons, and for integers ``& ^ << >>`` work lane by lane, and a number beside a vector is
spread over its lanes. Without AVX, LLVM halves the vectors. Products and sums may be fused; nothing else is
rearranged, and NaN stays NaN.
"""

from __future__ import annotations

from typing import Any, cast

from llvmlite import ir
from numba import types
from numba.core import cgutils

from irradia.field.backends.numba_compile import intrinsic
from irradia.field.backends.numba_vector_type import (
    LANES,
    Vector,
    float2,
    float8,
    llvm_type,
    uint8,
    widened,
)

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
    return builder.bitcast(item, llvm_type(vector).as_pointer())


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
            return widened(context, builder, arguments[0], signature.args[0], vector)

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
        return builder.fmul(arguments[0], widened(context, builder, arguments[1], signature.args[1], a))

    return a(a, b), emit


@intrinsic
def join2(typing_context, a, b):
    """Two floats side by side."""

    def emit(context, builder, signature, arguments):
        vector = ir.Constant(llvm_type(float2), ir.Undefined)
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
            yes = widened(context, builder, arguments[1], of_a, result)
            no = widened(context, builder, arguments[2], of_b, result)
        else:
            yes = context.cast(builder, arguments[1], of_a, result)
            no = context.cast(builder, arguments[2], of_b, result)
        return builder.select(arguments[0], yes, no)

    return result(condition, a, b), emit


def _converter(source: Vector, target: Vector, instruction: str, summary: str) -> Any:
    def convert(typing_context, value):
        def emit(context, builder, signature, arguments):
            return getattr(builder, instruction)(arguments[0], llvm_type(target))

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
