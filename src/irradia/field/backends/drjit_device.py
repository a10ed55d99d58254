"""Dr.Jit's arrays on the processor that fields are to be computed on."""

from __future__ import annotations

from types import ModuleType

from irradia.core.device import DeviceChoice, cuda_status, prepare


def on_cuda(device: DeviceChoice) -> bool:
    """Whether a choice ends at a GPU. Unlike tracing, fields don't need OptiX."""
    return device != "cpu" and cuda_status().gpu is not None


def array_types(device: DeviceChoice = "auto", threads: int | None = None) -> ModuleType:
    """``drjit.cuda`` or ``drjit.llvm``, the module with ``Float``, ``UInt`` and so on.

    Dr.Jit's threads belong to the process: Mitsuba, where it is loaded too, gets the number that was asked
    for last, and None leaves it as it is.

    Args:
        device: ``auto`` takes CUDA where there is a GPU.
        threads: On the CPU.

    Raises:
        InputError: On fewer threads than 1.
        MissingDependencyError: If ``cuda`` was asked for in vain, or no libLLVM works.
    """
    if on_cuda(device):
        import drjit.cuda

        return drjit.cuda
    # Before Dr.Jit is first imported, since it aborts the process on a libLLVM that it can't use.
    prepare(device if device == "cuda" else "cpu", threads)
    import drjit as dr
    import drjit.llvm

    if threads is not None and threads != dr.thread_count():
        dr.set_thread_count(threads)
    return drjit.llvm
