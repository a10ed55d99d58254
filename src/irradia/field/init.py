"""Where training starts."""

from __future__ import annotations

import math

import numpy as np

from irradia.core.rng import Seed
from irradia.field.backend import F32, Parameters, StepOptions, TrainState
from irradia.field.spec import FieldSpec

# ω₀ of Sitzmann et al. 2020, who feed raw coordinates. It suits features that learn, as they start small.
# With 30, frequencies, which are large from the start, had ten times the error after 200 steps.
SINE_FREQUENCY = 30.0
SINE_FREQUENCY_OF_FIXED = 10.0


def new_parameters(spec: FieldSpec, seed: Seed) -> Parameters:
    """Random encodings and matrices, biases of 0; each array has its own stream.

    Matrices are uniform with the variance that keeps activations of a layer as large as those before: He et
    al. 2015 for the ReLUs and their smooth kin, Glorot and Bengio 2010 for outputs, Sitzmann et al. 2020 for
    sines, whose ω₀ is multiplied into the weights.
    """
    found: Parameters = {}
    for name, encoding in (("position", spec.position), ("direction", spec.direction)):
        if encoding is not None and encoding.n_parameters:
            found[name] = encoding.init(seed.child(name).numpy())
    for i, shape in enumerate(spec.layer_shapes()):
        rng = seed.child(f"mlp.{i}").numpy()
        bound = _bound(spec, i, shape)
        found[f"mlp.{i}.weight"] = rng.uniform(-bound, bound, shape).astype(np.float32)
        found[f"mlp.{i}.bias"] = np.zeros(shape[0], np.float32)
    return found


def new_state(spec: FieldSpec, seed: Seed, options: StepOptions | None = None) -> TrainState:
    """A training that hasn't begun."""
    options = options or StepOptions()
    parameters = new_parameters(spec, seed)
    return TrainState(
        parameters,
        average=_zeros(parameters) if options.average else {},
        first=_zeros(parameters),
        second=_zeros(parameters),
        step=0,
    )


def _bound(spec: FieldSpec, layer: int, shape: tuple[int, int]) -> float:
    n_outputs, n_inputs = shape
    if layer == spec.n_hidden_layers:
        return math.sqrt(6.0 / (n_inputs + n_outputs))
    if spec.activation == "sine" and layer == 0:
        frequency = SINE_FREQUENCY if spec.position.n_parameters else SINE_FREQUENCY_OF_FIXED
        return frequency / n_inputs
    return math.sqrt(6.0 / n_inputs)  # of He and of Sitzmann, who arrive at the same


def _zeros(parameters: Parameters) -> dict[str, F32]:
    return {name: np.zeros_like(values) for name, values in parameters.items()}
