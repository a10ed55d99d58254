"""Asks whether Dr.Jit works with the libLLVM of this process; run as a process of its own.

    DRJIT_LIBLLVM_PATH=… python -m irradia.core.llvm_probe

Some versions of LLVM abort the process that compiles with them, so a question is all this module
may be: it is never imported by the program. Exit code 0 and the word ``works`` mean yes.

Every kernel contains a number of its own time, which keeps Dr.Jit from answering out of its cache
of kernels that another libLLVM compiled.
"""

from __future__ import annotations

import sys
import time

ANSWER = "works"


def main() -> int:
    """Runs the kernels; returns the exit code."""
    try:
        import mitsuba as mi

        mi.set_variant("llvm_ad_rgb")
    except Exception as error:  # noqa: BLE001 - the answer is no, whatever the reason
        print(root_cause(error), file=sys.stderr)
        return 1
    salt = 1.0 + (time.time_ns() % 1_000_003) * 1e-6
    wrong = [check.__name__ for check in (gathers, selects, loops, traces) if not check(mi, salt)]
    if wrong:
        print(f"wrong results from: {', '.join(wrong)}", file=sys.stderr)
        return 1
    print(ANSWER)
    return 0


def root_cause(error: BaseException) -> str:
    """The first of a chain of errors: Dr.Jit hides a missing system library behind another error."""
    while error.__context__ is not None:
        error = error.__context__
    return f"{type(error).__name__}: {error}"


def gathers(mi, salt: float) -> bool:
    """Gather through a permutation, then scatter back."""
    import drjit as dr

    index = dr.arange(mi.UInt32, 64)
    values = mi.Float(index) * salt
    reversed_values = dr.gather(mi.Float, values, 63 - index)
    target = dr.zeros(mi.Float, 64)
    dr.scatter(target, reversed_values, 63 - index)
    return _close(target[5], 5 * salt)


def selects(mi, salt: float) -> bool:
    """Minimum and maximum: the instruction that LLVM 15 and 16 abort on."""
    import drjit as dr

    x = mi.Float(dr.arange(mi.UInt32, 64)) * salt
    clamped = dr.minimum(dr.maximum(x, 3 * salt), 7 * salt)
    return _close(clamped[0], 3 * salt) and _close(clamped[63], 7 * salt)


def loops(mi, salt: float) -> bool:
    """A symbolic loop with a different trip count per lane."""
    import drjit as dr

    count = dr.arange(mi.UInt32, 64)
    total = dr.zeros(mi.Float, 64)
    step = mi.UInt32(0)
    _, total = dr.while_loop(
        state=(step, total),
        cond=lambda step, total: step < count,
        body=lambda step, total: (step + 1, total + salt),
    )
    return _close(total[17], 17 * salt)


def traces(mi, salt: float) -> bool:
    """One Embree ray against a sphere of radius ``salt``."""
    scene = mi.load_dict({"type": "scene", "ball": {"type": "sphere", "radius": salt}})
    ray = mi.Ray3f(mi.Point3f(0, 0, 10), mi.Vector3f(0, 0, -1))
    return _close(scene.ray_intersect_preliminary(ray).t[0], 10 - salt)


def _close(found: float, expected: float) -> bool:
    return abs(found - expected) <= 1e-4 * abs(expected)


if __name__ == "__main__":
    sys.exit(main())
