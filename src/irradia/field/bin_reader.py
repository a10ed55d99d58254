"""Fields from the Unity project's ``.bin``; docs/field-files.md says what such a file leaves open.

Reading brings a file to what :class:`~irradia.field.field.Field` computes: where a convention differs by no
more than an order or an affine map of the perceptron's inputs or outputs, its matrices are rearranged.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.sh import BAND, COSINE_LOBE
from irradia.field.backend import Parameters
from irradia.field.bin_conventions import BinConventions
from irradia.field.encoding import Encoding
from irradia.field.encodings import Frequency, HashGrid, Identity, TriPlane
from irradia.field.encodings.hash_grid import PRIMES
from irradia.field.field import Field
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.formats.field_bin import FREQUENCY, HASH, TRI_PLANE, BinField, decode_field_bin

F32 = NDArray[np.float32]
Layer = tuple[F32, F32]  # weight (out, in) and bias (out,)

_BEFORE_FEATURES = {"features_normal": 0, "normal_features": 3, "normal4_features": 4}
_OUR_PLANES = ("xy", "xz", "yz")
CHANNEL_FROM_OURS = [
    0,
    9,
    3,
    6,
    1,
    10,
    4,
    7,
    2,
    11,
    5,
    8,
]  # (channel; L0, x, y, z) of (L0, y, z, x; channel)


def decode_bin(data: bytes, conventions: BinConventions | None = None, where: str = "field") -> Field:
    """Reads a field.

    Args:
        data: The file's bytes.
        conventions: What it doesn't say of itself; None takes those that we write.
        where: The file, for errors.

    Raises:
        InputError: It is damaged, no such field, or has too few inputs for the conventions.
    """
    content, conventions = decode_field_bin(data, where), conventions or BinConventions()
    if not fits(content, conventions):
        raise InputError(
            f"its {content.n_inputs} inputs can't be inputs={conventions.inputs}",
            where=where,
            fix="Choose another order of inputs.",
        )
    return to_field(content, conventions)


def to_field(content: BinField, conventions: BinConventions) -> Field:
    """See :func:`decode_bin`."""
    _, table = encoding_of(content, conventions)
    parameters: Parameters = {"position": table} if table.size else {}
    return Field(
        spec_of(content, conventions),
        frame_of(content, conventions),
        parameters | network_of(content, conventions),
    )


def spec_of(content: BinField, conventions: BinConventions) -> FieldSpec:
    """The architecture."""
    encoding, _ = encoding_of(content, conventions)
    is_sh = content.n_outputs > 4
    return FieldSpec(
        position=encoding,
        direction=None if is_sh else Identity(),
        width=content.header.width,
        n_hidden_layers=content.header.n_hidden_layers,
        activation=conventions.activation,
        head="linear" if is_sh else conventions.head,
        mode="sh1" if is_sh else "irradiance",
    )


def frame_of(content: BinField, conventions: BinConventions) -> FieldFrame:
    """The box; waves without π see it π times as large, so that theirs are ours."""
    low, high = content.header.aabb
    if content.header.encoding == FREQUENCY and conventions.turns == "one":
        high = low + (high - low) * np.float32(math.pi)
    return FieldFrame(np.stack([low, high]), quantity=conventions.quantity)


def encoding_of(content: BinField, conventions: BinConventions) -> tuple[Encoding, F32]:
    """The encoding and its parameters (P,) in our order."""
    header = content.header
    values = content.encoding.astype(np.float32)
    if header.encoding == HASH:
        low, high = header.resolutions
        grid = HashGrid(
            n_levels=header.a,
            log2_table_size=header.b.bit_length() - 1,
            n_features=header.c,
            base_resolution=round(low),
            max_resolution=round(high),
            full_levels=True,
            hash_all=conventions.hash_all,
            convention=conventions.levels,
            primes=PRIMES if conventions.primes == "xyz" else (PRIMES[2], PRIMES[1], PRIMES[0]),
        )
        if conventions.table == "feature_entry":
            values = values.reshape(header.a, header.c, header.b).transpose(0, 2, 1).reshape(-1)
        return grid, values
    if header.encoding == TRI_PLANE:
        planes = TriPlane(header.a, header.c, align_corners=conventions.centres == "corners")
        return planes, _our_planes(values, planes, conventions)
    n_frequencies = header.a + (conventions.turns == "two_pi")
    return Frequency(n_frequencies, include_identity=bool(header.c)), values


def fits(content: BinField, conventions: BinConventions) -> bool:
    """Whether the perceptron has as many inputs as these conventions need."""
    if content.n_outputs > 4:
        return True
    n_before = _BEFORE_FEATURES[conventions.inputs]
    return content.n_inputs >= content.header.n_features + max(n_before, 3)


def network_of(content: BinField, conventions: BinConventions) -> Parameters:
    """The perceptron for our order of inputs and outputs, without padding."""
    layers = _split(content, conventions)
    weight, bias = layers[0]
    layers[0] = _our_inputs(weight, bias, content, conventions)
    weight, bias = layers[-1]
    if content.n_outputs <= 4:
        layers[-1] = weight[:3], bias[:3]
    else:
        layers[-1] = _our_coefficients(weight[:12], bias[:12], conventions)
    found: Parameters = {}
    for i, (weight, bias) in enumerate(layers):
        found |= {
            f"mlp.{i}.weight": np.ascontiguousarray(weight),
            f"mlp.{i}.bias": np.ascontiguousarray(bias),
        }
    return found


def _our_planes(values: F32, planes: TriPlane, conventions: BinConventions) -> F32:
    n, c = planes.resolution, planes.n_features
    if conventions.texels == "feature_row_column":
        texels = values.reshape(3, c, n, n).transpose(0, 2, 3, 1)
    else:
        texels = values.reshape(3, n, n, c)
    stored = conventions.planes.split()
    ours: list[F32] = []
    for axes, place in zip(_OUR_PLANES, _places_of_planes(conventions), strict=True):
        ours.append(texels[place] if stored[place] == axes else texels[place].transpose(1, 0, 2))
    return np.stack(ours).reshape(-1)


def _places_of_planes(conventions: BinConventions) -> list[int]:
    """Where in the file our planes are; one by the same axes, the other way round, is the same turned."""
    stored = ["".join(sorted(axes)) for axes in conventions.planes.split()]
    return [stored.index(axes) for axes in _OUR_PLANES]


def _split(content: BinField, conventions: BinConventions) -> list[Layer]:
    """The layers as stored, padding included."""
    header = content.header
    widths = [content.n_inputs, *[header.width] * header.n_hidden_layers, content.n_outputs]
    shapes = list(zip(widths[1:], widths[:-1], strict=True))
    order = {
        "after": [(i, part) for i in range(len(shapes)) for part in ("weight", "bias")],
        "before": [(i, part) for i in range(len(shapes)) for part in ("bias", "weight")],
        "last": [(i, part) for part in ("weight", "bias") for i in range(len(shapes))],
    }[conventions.bias]
    found: dict[tuple[int, str], F32] = {}
    first = 0
    for i, part in order:
        size = shapes[i][0] * (shapes[i][1] if part == "weight" else 1)
        found[i, part] = content.network[first : first + size].astype(np.float32)
        first += size
    layers: list[Layer] = []
    for i, (out, into) in enumerate(shapes):
        flat = found[i, "weight"]
        weight = flat.reshape(out, into) if conventions.matrix == "out_in" else flat.reshape(into, out).T
        layers.append((weight, found[i, "bias"]))
    return layers


def _our_inputs(weight: F32, bias: F32, content: BinField, conventions: BinConventions) -> Layer:
    """The first layer with columns for our features, then for the signed normal."""
    n = content.header.n_features
    if content.n_outputs > 4:
        return _our_features(weight[:, :n], content, conventions), bias
    first = _BEFORE_FEATURES[conventions.inputs]
    features = weight[:, first : first + n]
    normal = weight[:, :3] if first else weight[:, n : n + 3]
    if conventions.normal == "unit":  # W (n + 1) / 2 + b
        normal = normal * np.float32(0.5)
        bias = bias + normal.sum(axis=1)
    return np.hstack([_our_features(features, content, conventions), normal]), bias


def _our_features(columns: F32, content: BinField, conventions: BinConventions) -> F32:
    """The first matrix' columns for features, in our order."""
    if content.header.encoding == TRI_PLANE:
        by_plane = columns.reshape(len(columns), 3, -1)
        return by_plane[:, _places_of_planes(conventions)].reshape(columns.shape)
    return _our_waves(columns, content, conventions) if content.header.encoding == FREQUENCY else columns


def _our_waves(columns: F32, content: BinField, conventions: BinConventions) -> F32:
    """Those of frequency features."""
    header = content.header
    n_identity = 3 * header.c
    first = len(columns[0]) - n_identity if conventions.identity_last else 0
    identity = columns[:, first : first + n_identity]
    waves = np.delete(columns, np.s_[first : first + n_identity], axis=1)
    names = conventions.waves.split()
    sizes = {"axis": 3, "frequency": header.a, "wave": 2}
    cube = waves.reshape(-1, *(sizes[name] for name in names))
    cube = cube.transpose(0, *(1 + names.index(name) for name in ("axis", "frequency", "wave")))
    if conventions.turns == "two_pi":  # the lowest of ours is one that they don't have
        cube = np.pad(cube, ((0, 0), (0, 0), (1, 0), (0, 0)))
    if conventions.turns == "one":
        identity = identity * np.float32(math.pi)
    return np.hstack([identity, cube.reshape(len(columns), -1)])


def _our_coefficients(weight: F32, bias: F32, conventions: BinConventions) -> Layer:
    """The last layer with rows for coefficients of radiance in our order."""
    if conventions.coefficients == "channel_xyz":
        ours = np.argsort(CHANNEL_FROM_OURS)
        weight, bias = weight[ours], bias[ours]
    if conventions.sh_quantity == "irradiance":
        lobe = np.repeat(COSINE_LOBE[BAND[:4]], 3).astype(np.float32)
        weight, bias = weight / lobe[:, None], bias / lobe
    return weight, bias
