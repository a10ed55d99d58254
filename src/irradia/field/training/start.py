"""Where training starts from: a field that is as bright as the samples, and of their colour.

Of random matrices alone, an ``exp`` head gives about 1, the top of the range, everywhere; the first hundred
steps would go into darkening it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irradia.core.rng import Seed
from irradia.field.backend import F32, Parameters, StepOptions, TrainState
from irradia.field.init import new_state
from irradia.field.spec import FieldSpec, Head

DARKEST = 1e-3  # of the frame's scale


def starting_state(spec: FieldSpec, seed: Seed, options: StepOptions, typical: F32) -> TrainState:
    """A state before the first step.

    Args:
        spec: Of the field.
        seed: Of the random matrices.
        options: Say whether running means are kept.
        typical: (n_outputs,) target, in units of the frame's scale.
    """
    state = new_state(spec, seed, options)
    last = f"mlp.{spec.n_hidden_layers}.bias"
    return replace(state, parameters={**state.parameters, last: before_head(spec.head, typical)})


def state_of(parameters: Parameters, options: StepOptions) -> TrainState:
    """A state that starts from parameters trained before."""

    def zeros() -> Parameters:
        return {name: np.zeros_like(values) for name, values in parameters.items()}

    return TrainState(dict(parameters), zeros() if options.average else {}, zeros(), zeros(), 0)


def inference_parameters(state: TrainState, options: StepOptions) -> Parameters:
    """What a trained field is used with: the running mean without its bias towards 0 at the start.

    Kingma and Ba 2015, section 3, do the same for moments. Frozen parameters have no mean.
    """
    if not options.average or not state.step:
        return dict(state.parameters)
    weight = np.float32(1.0 / (1.0 - options.average**state.step))
    return {
        name: values if name in options.frozen else state.average[name] * weight
        for name, values in state.parameters.items()
    }


def before_head(head: Head, outputs: F32) -> F32:
    """The raw values from which a head makes ``outputs``; those of positive heads at least ``DARKEST``."""
    if head == "linear":
        return outputs.astype(np.float32)
    bright = np.maximum(outputs.astype(np.float64), DARKEST)
    raw = np.log(bright) if head == "exp" else bright + np.log(-np.expm1(-bright))
    return raw.astype(np.float32)
