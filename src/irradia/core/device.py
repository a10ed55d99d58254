"""Which processor does the tracing, made ready before Dr.Jit is first imported."""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from irradia.core.errors import InputError, MissingDependencyError
from irradia.core.libllvm import VARIABLE, find_libllvm

DeviceChoice = Literal["auto", "cpu", "cuda"]


@dataclass(frozen=True)
class Device:
    """What tracing runs on.

    Attributes:
        kind: ``cpu`` (LLVM and Embree) or ``cuda`` (OptiX).
        name: The processor's name, for reports.
        threads: Threads that the CPU backend uses.
        libllvm: The library that compiles for the CPU; None on CUDA.
        llvm_major: Its version, where its name says so.
    """

    kind: Literal["cpu", "cuda"]
    name: str
    threads: int
    libllvm: Path | None = None
    llvm_major: int | None = None


@dataclass(frozen=True)
class CudaStatus:
    """What stands between this machine and tracing on CUDA.

    Attributes:
        gpu: The first GPU's name, or None.
        optix: Whether the driver's OptiX library loads.
        problem: What is missing, or "".
    """

    gpu: str | None
    optix: bool
    problem: str


def prepare(choice: DeviceChoice = "auto", threads: int | None = None) -> Device:
    """Chooses the device and sets up the environment for it; call before importing Dr.Jit.

    Args:
        choice: ``auto`` takes CUDA where GPU and OptiX are there, else the CPU.
        threads: Threads of the CPU backend; None takes all that this process may use.

    Raises:
        InputError: On an unknown choice or a thread count below 1.
        MissingDependencyError: If the device or its library is absent; ``fix`` says what to install.
    """
    if choice not in ("auto", "cpu", "cuda"):
        raise InputError(f"expected auto, cpu or cuda, found {choice!r}", where="--device")
    if threads is not None and threads < 1:
        raise InputError(f"expected at least 1 thread, found {threads}", where="--threads")
    n_threads = threads or available_threads()
    if choice != "cpu":
        status = cuda_status()
        if status.gpu and status.optix:
            return Device("cuda", status.gpu, n_threads)
        if choice == "cuda":
            raise MissingDependencyError(status.problem, where="--device cuda", fix=CUDA_FIX)
    found = find_libllvm().candidate
    os.environ[VARIABLE] = str(found.path)
    return Device("cpu", cpu_name(), n_threads, found.path, found.major)


CUDA_FIX = "Install NVIDIA's driver with its OptiX library (libnvoptix), or use --device cpu."


def cuda_status() -> CudaStatus:
    """Asks NVIDIA's driver for a GPU and for OptiX, without any other library."""
    driver = _load("nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1")
    if driver is None:
        return CudaStatus(None, False, "no NVIDIA driver was found")
    gpu = _first_gpu(driver)
    if gpu is None:
        return CudaStatus(None, False, "NVIDIA's driver sees no GPU")
    if _load("nvoptix.dll" if sys.platform == "win32" else "libnvoptix.so.1") is None:
        return CudaStatus(gpu, False, f"{gpu} is there, but the driver's OptiX library is not")
    return CudaStatus(gpu, True, "")


def available_threads() -> int:
    """Processors that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def cpu_name() -> str:
    """The processor's trade name where the system tells, else its architecture."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    for line in lines:
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def _load(library: str) -> ctypes.CDLL | None:
    try:
        return ctypes.CDLL(library)
    except OSError:
        return None


def _first_gpu(driver: ctypes.CDLL) -> str | None:
    """The name of CUDA device 0, or None where there is none."""
    count = ctypes.c_int(0)
    if driver.cuInit(0) != 0 or driver.cuDeviceGetCount(ctypes.byref(count)) != 0 or count.value < 1:
        return None
    device = ctypes.c_int(0)
    name = ctypes.create_string_buffer(256)
    if driver.cuDeviceGet(ctypes.byref(device), 0) != 0:
        return None
    if driver.cuDeviceGetName(name, len(name), device) != 0:
        return None
    return name.value.decode("utf-8", errors="replace")
