"""The readable backend: the numbers that every other is held to, computed by NumPy."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from irradia.field.adam import adam, running_mean
from irradia.field.backend import (
    F32,
    Backend,
    Batch,
    Evaluator,
    Parameters,
    Rates,
    StepOptions,
    Stepper,
    TrainState,
)
from irradia.field.checks import check_options, check_parameters
from irradia.field.network import evaluate, loss_and_gradients
from irradia.field.spec import FieldSpec

CHUNK = 1 << 16  # points evaluated at a time, to bound memory


class NumpyBackend(Backend):
    """Does everything, slowly.

    Args:
        threads: Nothing here has any; those of NumPy's own BLAS are the environment's.
    """

    name: ClassVar[str] = "numpy"

    def __init__(self, threads: int | None = None) -> None:
        del threads

    def lacks(self, spec: FieldSpec) -> str | None:
        """Nothing."""
        return None

    def evaluator(self, spec: FieldSpec, parameters: Parameters) -> Evaluator:
        """Keeps the parameters by reference."""
        check_parameters(spec, parameters)
        return _NumpyEvaluator(spec, parameters)

    def stepper(self, spec: FieldSpec, state: TrainState, options: StepOptions) -> Stepper:
        """Copies the state."""
        check_options(spec, options)
        check_parameters(spec, state.parameters)
        return _NumpyStepper(spec, state, options)


class _NumpyEvaluator(Evaluator):
    def __init__(self, spec: FieldSpec, parameters: Parameters) -> None:
        self._spec = spec
        self._parameters = parameters

    def __call__(self, x: F32, normal: F32 | None) -> F32:
        outputs = np.empty((len(x), self._spec.n_outputs), np.float32)
        for first in range(0, len(x), CHUNK):
            part = slice(first, first + CHUNK)
            normals = None if normal is None else normal[part]
            outputs[part] = evaluate(self._spec, self._parameters, x[part], normals)
        return outputs


class _NumpyStepper(Stepper):
    def __init__(self, spec: FieldSpec, state: TrainState, options: StepOptions) -> None:
        self._spec = spec
        self._options = options
        self._state = copy_state(state)

    def step(self, batch: Batch, rates: Rates) -> float:
        state, options = self._state, self._options
        loss, gradients = loss_and_gradients(self._spec, state.parameters, batch, options.loss)
        step = state.step + 1
        parameters, first, second = {}, {}, {}
        for name, value in state.parameters.items():
            moments = state.first[name], state.second[name]
            if name in options.frozen:
                parameters[name], (first[name], second[name]) = value, moments
                continue
            is_network = name.startswith("mlp.")
            parameters[name], first[name], second[name] = adam(
                value,
                gradients[name],
                *moments,
                step,
                rates.network if is_network else rates.encoding,
                options.network_adam if is_network else options.encoding_adam,
            )
        average = {
            name: mean if name in options.frozen else running_mean(mean, parameters[name], options.average)
            for name, mean in state.average.items()
        }
        self._state = TrainState(parameters, average, first, second, step)
        return loss

    def state(self) -> TrainState:
        return copy_state(self._state)


def copy_state(state: TrainState) -> TrainState:
    """A state that shares no array with this one."""
    arrays = (state.parameters, state.average, state.first, state.second)
    copies = ({name: value.copy() for name, value in group.items()} for group in arrays)
    return TrainState(*copies, step=state.step)
