"""Starts Dr.Jit and Mitsuba once, on the device that was asked for.

:func:`irradia.core.device.prepare` runs before the first import, because Dr.Jit aborts the process
on a libLLVM that it can't use. Modules of this package write
``from irradia.transport.backend import dr, mi``.
"""

from __future__ import annotations

from irradia.core.device import prepare
from irradia.transport import requested_device

device = prepare(requested_device().choice, requested_device().threads)

import drjit as dr  # noqa: E402
import mitsuba as mi  # noqa: E402

mi.set_variant("cuda_ad_rgb" if device.kind == "cuda" else "llvm_ad_rgb")
mi.set_log_level(mi.LogLevel.Warn)
dr.set_thread_count(device.threads)

__all__ = ["device", "dr", "mi"]
