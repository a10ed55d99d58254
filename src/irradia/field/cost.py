"""What one query of a field costs, by formula: arithmetic and memory, the same on every machine.

A multiplication with its addition counts as two operations. Sines count as one each, and address arithmetic
not at all: what is counted is what a faster processor could not leave out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from irradia.field.encoding import Encoding
from irradia.field.spec import FieldSpec


@dataclass(frozen=True)
class QueryCost:
    """One query.

    Attributes:
        encoding_flops, network_flops: Operations.
        encoding_values: Parameters of the encodings that are read: at random places, so from slow memory.
        network_values: Parameters of the network, which stay in cache.
    """

    encoding_flops: int
    network_flops: int
    encoding_values: int
    network_values: int

    @property
    def flops(self) -> int:
        """All operations."""
        return self.encoding_flops + self.network_flops

    def encoding_bytes(self, bits: int) -> float:
        """Bytes that are read of the encodings, at so many bits a value."""
        return self.encoding_values * bits / 8.0


def counted_cost(spec: FieldSpec) -> QueryCost | None:
    """:func:`query_cost`, or None where nobody has counted what an encoding costs."""
    try:
        return query_cost(spec)
    except LookupError:
        return None


def query_cost(spec: FieldSpec) -> QueryCost:
    """Costs of one query of a field.

    Raises:
        LookupError: An encoding has no formula here, and none of its own.
    """
    parts = [_of(encoding) for encoding in (spec.position, spec.direction) if encoding is not None]
    shapes = spec.layer_shapes()
    return QueryCost(
        encoding_flops=sum(flops for flops, _ in parts),
        network_flops=sum(2 * out * into + out for out, into in shapes) + spec.width * spec.n_hidden_layers,
        encoding_values=sum(values for _, values in parts),
        network_values=sum(out * into + out for out, into in shapes),
    )


def _of(encoding: Encoding) -> tuple[int, int]:
    """(operations, parameters read)."""
    if encoding.name in FORMULAS:
        return FORMULAS[encoding.name](encoding)
    found = encoding.cost()
    if found is None:
        raise LookupError(f"nobody has counted what the encoding {encoding.name} costs")
    return found


def _hash_grid(e: Any) -> tuple[int, int]:
    """Eight corners a level, each with a weight of two products."""
    values = 8 * e.n_levels * e.n_features
    return 2 * values + 16 * e.n_levels, values


def _tri_plane(e: Any) -> tuple[int, int]:
    """Four texels on each of three planes."""
    values = 12 * e.n_features
    return 2 * values + 3 * 4, values


def _sines(e: Any) -> tuple[int, int]:
    """An angle, then its sine and cosine."""
    return 3 * e.n_frequencies * 3, 0


def _one_blob(e: Any) -> tuple[int, int]:
    """A cubic kernel's integral at every edge of a bin."""
    return 6 * e.n_outputs, 0


def _spherical_harmonics(e: Any) -> tuple[int, int]:
    """A product and a sum for each function."""
    return 2 * e.n_outputs, 0


def _nothing(_: Any) -> tuple[int, int]:
    return 0, 0


def _composite(e: Any) -> tuple[int, int]:
    parts = [_of(part) for part in e.parts]
    return sum(flops for flops, _ in parts), sum(values for _, values in parts)


FORMULAS: dict[str, Callable[[Any], tuple[int, int]]] = {
    "hash": _hash_grid,
    "triplane": _tri_plane,
    "frequency": _sines,
    "one_blob": _one_blob,
    "sh": _spherical_harmonics,
    "identity": _nothing,
    "composite": _composite,
}
"""By the encodings' names; a test holds that none is missing."""
