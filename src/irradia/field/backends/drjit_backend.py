"""Fields by Dr.Jit: on NVIDIA GPUs, and on the CPU for tests.

Kernels are few and don't grow with the field: one for each part of an encoding, one between two layers, one
for the loss, one for Adam; the matrix products between them are Dr.Jit's. A training step is traced once for
each size of batch and then replayed. Everything is float32, and sums have an order (drjit_fixed_point.py),
so a training gives the same bits on any number of threads, though not the bits of another backend.

CUDA hasn't been tried yet: no GPU was at hand. The tests marked ``cuda`` are the same as those on the CPU.
"""

from __future__ import annotations

from typing import ClassVar

from irradia.core.device import DeviceChoice
from irradia.field.backend import Backend, Evaluator, Parameters, StepOptions, Stepper, TrainState
from irradia.field.backends.drjit_catalogue import lacks_acceleration
from irradia.field.checks import check_options, check_parameters
from irradia.field.spec import FieldSpec


class DrJitBackend(Backend):
    """See the module. Dr.Jit itself is loaded when something is to be computed.

    Args:
        threads: Of Dr.Jit's pool on the CPU, which Mitsuba shares; None leaves it as it is.
        device: ``auto`` takes CUDA where there is a GPU.
    """

    name: ClassVar[str] = "drjit"

    def __init__(self, threads: int | None = None, device: DeviceChoice = "auto") -> None:
        self._threads = threads
        self._device: DeviceChoice = device

    def lacks(self, spec: FieldSpec) -> str | None:
        """What of a spec has no kernel, or is too large for 32-bit indices."""
        return lacks_acceleration(spec)

    def evaluator(self, spec: FieldSpec, parameters: Parameters) -> Evaluator:
        """Makes ready to evaluate; the parameters are copied."""
        check_parameters(spec, parameters)
        from irradia.field.backends.drjit_device import array_types

        jit = array_types(self._device, self._threads)
        from irradia.field.backends.drjit_field import DrJitEvaluator

        return DrJitEvaluator(spec, parameters, jit)

    def stepper(self, spec: FieldSpec, state: TrainState, options: StepOptions) -> Stepper:
        """Makes ready to train; the state is copied."""
        check_options(spec, options)
        check_parameters(spec, state.parameters)
        from irradia.field.backends.drjit_device import array_types

        jit = array_types(self._device, self._threads)
        from irradia.field.backends.drjit_training import DrJitStepper

        return DrJitStepper(spec, state, options, jit)
