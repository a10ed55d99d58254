"""The perceptron: matrices with biases, an activation between them, a head after the last."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from irradia.field.activations import ACTIVATIONS, Activation
from irradia.field.encoding import Array
from irradia.field.heads import HEADS
from irradia.field.spec import FieldSpec


@dataclass(frozen=True)
class Tape:
    """What backward needs of forward, layer by layer.

    Attributes:
        inputs: (N, in) of each matrix.
        raw: (N, out) of each matrix, before activation or head.
    """

    inputs: list[Array]
    raw: list[Array]


def forward(spec: FieldSpec, parameters: Mapping[str, Array], features: Array) -> tuple[Array, Tape]:
    """Outputs (N, n_outputs) after the head, from features (N, n_inputs)."""
    tape = Tape([], [])
    values = features
    for i, function in enumerate(_functions(spec)):
        tape.inputs.append(values)
        tape.raw.append(values @ parameters[f"mlp.{i}.weight"].T + parameters[f"mlp.{i}.bias"])
        values = function.value(tape.raw[-1])
    return values, tape


def backward(
    spec: FieldSpec, parameters: Mapping[str, Array], tape: Tape, gradient: Array
) -> tuple[Array, dict[str, Array]]:
    """Gradients of a loss.

    Args:
        spec: As in forward.
        parameters: As in forward.
        tape: From forward.
        gradient: (N, n_outputs) of the loss with respect to the outputs.

    Returns:
        With respect to the features (N, n_inputs), and to each array of the perceptron.
    """
    found: dict[str, Array] = {}
    for i, function in reversed(list(enumerate(_functions(spec)))):
        of_raw = gradient * function.slope(tape.raw[i])
        found[f"mlp.{i}.weight"] = of_raw.T @ tape.inputs[i]
        found[f"mlp.{i}.bias"] = of_raw.sum(axis=0)
        gradient = of_raw @ parameters[f"mlp.{i}.weight"]
    return gradient, found


def _functions(spec: FieldSpec) -> list[Activation]:
    return [ACTIVATIONS[spec.activation]] * spec.n_hidden_layers + [HEADS[spec.head]]
