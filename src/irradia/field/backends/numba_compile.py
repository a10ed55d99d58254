"""How kernels are compiled, and how the threads of a team share their tasks."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic as numba_intrinsic


def stamped_files() -> list[Path]:
    """All files that kernels are made of, those too whose constants are compiled into them."""
    here = Path(__file__).parent
    defined = [*here.parent.glob("*.py"), *here.parent.glob("encodings/*.py"), *here.glob("numba_*.py")]
    return sorted([*defined, here.parents[1] / "core" / "colour.py"])


def _stamp() -> bytes:
    """Changes with any of these files."""
    return sha256(b"".join(file.read_bytes() for file in stamped_files())).digest()


_STAMP = _stamp()


def _compiled(function: Callable, *, nogil: bool) -> Any:
    """Compiles when first called, and keeps the code on disk.

    Numba takes that code for fresh as long as the function's own file hasn't changed. Ours holds functions
    and constants of other files too, so all of them count.
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


@intrinsic
def take(typing_context, counter):
    """Counts up the (1,) int64 array by one, for all threads at once, and returns what it was."""

    def emit(context, builder, signature, arguments):
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.atomic_rmw("add", array.data, ir.Constant(ir.IntType(64), 1), "monotonic")

    return types.int64(counter), emit
