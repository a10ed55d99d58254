"""A whole field: encodings of position and normal, the perceptron, and the way back."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from irradia.field import mlp
from irradia.field.backend import Batch, LossName
from irradia.field.encoding import Array, Encoding
from irradia.field.losses import loss_and_gradient
from irradia.field.spec import FieldSpec


def encode(spec: FieldSpec, parameters: Mapping[str, Array], x: Array, normal: Array | None) -> Array:
    """Features (N, n_inputs): those of position, then those of direction."""
    kind = parameters["mlp.0.weight"].dtype
    features = [
        encoding.forward(points, parameters.get(name, np.zeros(0, kind)))
        for name, encoding, points in encoded(spec, x, normal)
    ]
    return np.concatenate(features, axis=1)


def evaluate(spec: FieldSpec, parameters: Mapping[str, Array], x: Array, normal: Array | None) -> Array:
    """Outputs (N, n_outputs) after the head, in units of the frame's scale."""
    return mlp.forward(spec, parameters, encode(spec, parameters, x, normal))[0]


def loss_and_gradients(
    spec: FieldSpec, parameters: Mapping[str, Array], batch: Batch, loss: LossName
) -> tuple[float, dict[str, Array]]:
    """The batch's mean loss and its gradient with respect to every array of parameters."""
    features = encode(spec, parameters, batch.x, batch.normal)
    outputs, tape = mlp.forward(spec, parameters, features)
    value, of_outputs = loss_and_gradient(loss, outputs, batch.target)
    of_features, gradients = mlp.backward(spec, parameters, tape, of_outputs)
    column = 0
    for name, encoding, points in encoded(spec, batch.x, batch.normal):
        own = of_features[:, column : column + encoding.n_outputs]
        column += encoding.n_outputs
        if encoding.n_parameters:
            gradients[name] = encoding.backward(points, parameters[name], own)
    return value, gradients


def encoded(spec: FieldSpec, x: Array, normal: Array | None) -> Iterator[tuple[str, Encoding, Array]]:
    """Each encoding with its name among the parameters and the points that it sees."""
    yield "position", spec.position, x
    if spec.direction is not None and normal is not None:
        in_cube = spec.direction.domain == "cube"
        yield "direction", spec.direction, normal * np.float32(0.5) + np.float32(0.5) if in_cube else normal
