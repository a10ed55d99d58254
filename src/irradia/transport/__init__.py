"""Light transport on Dr.Jit: the only package that imports it or Mitsuba.

Importing one of its modules starts the backend (see :mod:`irradia.transport.backend`) on the
device that :func:`use_device` named, so the rest of Irradia does that late, inside functions.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass

from irradia.core import InternalError
from irradia.core.device import DeviceChoice


@dataclass(frozen=True)
class DeviceRequest:
    """The device and the number of threads that the backend will start with."""

    choice: DeviceChoice = "auto"
    threads: int | None = None


_requests = [DeviceRequest()]  # the last one counts


def use_device(choice: DeviceChoice = "auto", threads: int | None = None) -> None:
    """Chooses the device for this process; only before the backend has started."""
    wanted = DeviceRequest(choice, threads)
    if "irradia.transport.backend" in sys.modules and wanted != _requests[-1]:
        raise InternalError("the device can't change once transport has started")
    _requests.append(wanted)


def requested_device() -> DeviceRequest:
    """What :func:`use_device` asked for."""
    return _requests[-1]
