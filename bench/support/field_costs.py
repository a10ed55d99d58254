"""What a batch's arithmetic and memory traffic are on paper."""

from __future__ import annotations

from dataclasses import dataclass

from irradia.field.cost import query_cost
from irradia.field.spec import FieldSpec

ADAM_BYTES = 8 * 4  # value, gradient and both moments are read and written


@dataclass(frozen=True)
class Cost:
    """Of a step or of a pass over a batch.

    Attributes:
        flops: A multiplication with its addition counts as two.
        bytes: That gathers, scatters and Adam touch; activations are taken to stay in a cache.
    """

    flops: float
    bytes: float


def inference_cost(spec: FieldSpec, batch: int) -> Cost:
    """Of evaluating a batch."""
    query = query_cost(spec)
    return Cost(batch * query.flops, batch * query.encoding_bytes(32))


def step_cost(spec: FieldSpec, batch: int) -> Cost:
    """Of a training step: forward, weight gradients, input gradients where something learns from them."""
    query = query_cost(spec)
    first_out, first_in = spec.layer_shapes()[0]
    learned_inputs = spec.position.n_outputs if spec.position.n_parameters else 0
    network = 3 * query.network_flops - 2 * first_out * (first_in - learned_inputs)
    encoding = query.encoding_flops * (2 if spec.position.n_parameters else 1)
    # A feature is read, and its gradient read and written.
    touched = 3 * batch * query.encoding_bytes(32) + ADAM_BYTES * spec.n_parameters
    return Cost(batch * (network + encoding), touched)
