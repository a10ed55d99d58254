"""Starts Dr.Jit and Mitsuba once, on the device that was asked for.

:func:`irradia.core.device.prepare` runs before the first import, because Dr.Jit aborts the process
on a libLLVM that it can't use. Modules of this package write
``from irradia.transport.backend import dr, mi``.
"""

from __future__ import annotations

import gc

from irradia.core.device import prepare
from irradia.transport import requested_device

device = prepare(requested_device().choice, requested_device().threads)

import drjit as dr  # noqa: E402
import mitsuba as mi  # noqa: E402

mi.set_variant("cuda_ad_rgb" if device.kind == "cuda" else "llvm_ad_rgb")
mi.set_log_level(mi.LogLevel.Warn)
dr.set_thread_count(device.threads)

__all__ = ["device", "dr", "give_back", "mi"]


def give_back() -> None:
    """Returns all memory of the device that nothing uses; otherwise it is kept for the next array.

    Bakes and their schedules refer to each other, so what is done with is collected first.
    """
    gc.collect()
    dr.flush_malloc_cache()
