"""Fields to the Unity project's ``.bin``, by the conventions of docs/field-files.md and no others."""

from __future__ import annotations

import math
from typing import Never

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.field.bin_reader import CHANNEL_FROM_OURS
from irradia.field.encoding import Encoding
from irradia.field.encodings import Frequency, HashGrid, Identity, TriPlane
from irradia.field.field import Field
from irradia.field.spec import FieldSpec
from irradia.field.tensors import to_halves
from irradia.formats.field_bin import FREQUENCY, HASH, TRI_PLANE, BinHeader, encode_field_bin, padded

F32 = NDArray[np.float32]


def encode_bin(field: Field) -> bytes:
    """The bytes of a ``.bin``.

    The file knows neither scale nor activation. So the scale goes into the last layer, exactly where the head
    is linear, and to the precision of a half float where it is ``exp``.

    Raises:
        InputError: The field has an encoding, activation, head or mode that the file can't express.
    """
    check_bin(field.spec)
    network = np.concatenate([part for layer in _layers(field) for part in layer])
    return encode_field_bin(
        _header(field), to_halves(_encoding(field), "position"), to_halves(network, "mlp")
    )


def check_bin(spec: FieldSpec) -> None:
    """Refuses fields that a ``.bin`` can't express.

    Raises:
        InputError: It says what, and what to do instead.
    """
    if spec.activation != "relu":
        _refuse(f"the activation {spec.activation}", "relu")
    if spec.mode == "sh2":
        _refuse("coefficients of L2", "mode sh1 or irradiance")
    if spec.mode == "irradiance" and spec.head != "exp":
        _refuse(f"the head {spec.head}", "exp")
    if not isinstance(spec.direction, Identity | None):
        _refuse(f"the {spec.direction.name} encoding of normals", "identity")
    _sizes(spec.position)


def _refuse(what: str, instead: str) -> Never:
    raise InputError(
        f"a .bin can't hold {what}", fix=f"Train with {instead}, or save the field as .safetensors."
    )


def _header(field: Field) -> BinHeader:
    spec = field.spec
    kind, a, b, c, resolutions = _sizes(spec.position)
    return BinHeader(kind, a, b, c, resolutions, padded(spec.width), spec.n_hidden_layers, field.frame.aabb)


def _sizes(position: Encoding) -> tuple[int, int, int, int, tuple[float, float]]:
    """An encoding's number, a, b and c, and its resolutions."""
    match position:
        case HashGrid():
            if position != _plain(position):
                _refuse("a hash grid of rarer conventions", "a hash grid by tiny-cuda-nn's conventions")
            resolutions = (float(position.base_resolution), float(position.max_resolution))
            n_entries = 1 << position.log2_table_size
            return HASH, position.n_levels, n_entries, position.n_features, resolutions
        case TriPlane():
            if position.align_corners:
                _refuse("planes whose corners are aligned", "align_corners off")
            return TRI_PLANE, position.resolution, 0, position.n_features, (0.0, 0.0)
        case Frequency():
            return FREQUENCY, position.n_frequencies, 0, int(position.include_identity), (0.0, 0.0)
        case _:
            _refuse(f"the encoding {position.name}", "hash, triplane or frequency")


def _plain(grid: HashGrid) -> HashGrid:
    """A grid of the same sizes by the conventions of tiny-cuda-nn."""
    return HashGrid(
        grid.n_levels,
        grid.log2_table_size,
        grid.n_features,
        grid.base_resolution,
        grid.max_resolution,
        grid.full_levels,
    )


def _encoding(field: Field) -> F32:
    """Tables or planes."""
    values = field.parameters.get("position", np.zeros(0, np.float32))
    position = field.spec.position
    return _full_levels(position, values) if isinstance(position, HashGrid) else values


def _full_levels(grid: HashGrid, values: F32) -> F32:
    """Tables of 2^N entries each; what a level has fewer of is repeated, so that indices that wrap agree."""
    table = values.reshape(-1, grid.n_features)
    entries = np.arange(1 << grid.log2_table_size)
    return np.concatenate(
        [table[level.first + entries % level.n_entries] for level in grid.levels()]
    ).reshape(-1)


def _layers(field: Field) -> list[tuple[F32, F32]]:
    """Each matrix, flat by rows of outputs, and its bias; padded with zeros."""
    n_layers = field.spec.n_hidden_layers + 1
    layers = [
        (field.parameters[f"mlp.{i}.weight"], field.parameters[f"mlp.{i}.bias"]) for i in range(n_layers)
    ]
    weight, bias = layers[-1]
    scale = np.float32(field.frame.scale)
    if field.spec.mode == "irradiance":
        layers[-1] = weight, bias + np.float32(math.log(field.frame.scale))
    else:
        layers[-1] = scale * weight[CHANNEL_FROM_OURS], scale * bias[CHANNEL_FROM_OURS]
    n_outputs = 4 if field.spec.mode == "irradiance" else 16
    found: list[tuple[F32, F32]] = []
    for i, (weight, bias) in enumerate(layers):
        rows = n_outputs if i == n_layers - 1 else padded(len(bias))
        missing = rows - len(bias)
        whole = np.pad(weight, ((0, missing), (0, padded(weight.shape[1]) - weight.shape[1])))
        found.append((whole.reshape(-1), np.pad(bias, (0, missing))))
    return found
