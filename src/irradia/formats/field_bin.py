"""The weight file of the Unity project Neural Irradiance Cache: a 56-byte header and half floats.

Little-endian, no magic, no version::

    0   u32      encoding      0 hash | 1 tri-plane | 2 frequency
    4   u32      a             levels | texels a side | frequencies
    8   u32      b             entries of a level's table | 0 | 0
    12  u32      c             features of an entry | of a plane | 1 if x, y, z are features too
    16  f32 × 2                resolution of the coarsest and of the finest level
    24  u32      width         of each hidden layer
    28  u32      layers        hidden layers; one matrix more
    32  f32 × 6                AABB minimum and maximum
    56  f16 …                  tables or planes, then the perceptron

Neither the size of inputs nor that of outputs is in it, but both follow from the file's: with H halves after
the encoding, h hidden units and L hidden layers, there are o = H mod h outputs (of which some may be padding)
and i = (H − o) / h − 1 − (L − 1)(h + 1) − o inputs. Rows are padded to four halves. What else a reader has to
know, the file doesn't say; docs/field-files.md has it.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError

HASH, TRI_PLANE, FREQUENCY = 0, 1, 2
HEADER_BYTES = 56
MAX_LEVELS, MAX_SIDE, MAX_FREQUENCIES, MAX_FEATURES = 32, 8192, 24, 128
MAX_WIDTH, MAX_LAYERS, MAX_TABLE = 128, 6, 1 << 28
OUTPUTS = (3, 4, 12, 16)  # of irradiance, padded or not, and of SH

_HEADER = struct.Struct("<4I2f2I6f")


@dataclass(frozen=True)
class BinHeader:
    """The header, and what follows from it.

    Attributes:
        encoding: HASH, TRI_PLANE or FREQUENCY.
        a, b, c: Its sizes, as above.
        resolutions: Of the coarsest and finest level; zeros for others than hash grids.
        width: Of hidden layers.
        n_hidden_layers: One fewer than matrices.
        aabb: (2, 3) minimum and maximum, metres.
    """

    encoding: int
    a: int
    b: int
    c: int
    resolutions: tuple[float, float]
    width: int
    n_hidden_layers: int
    aabb: NDArray[np.float32]

    @property
    def n_features(self) -> int:
        """Outputs of the encoding."""
        match self.encoding:
            case 0:
                return self.a * self.c
            case 1:
                return 3 * self.c
            case _:
                return 6 * self.a + 3 * self.c

    @property
    def n_encoding(self) -> int:
        """Halves of tables or planes."""
        match self.encoding:
            case 0:
                return self.a * self.b * self.c
            case 1:
                return 3 * self.a * self.a * self.c
            case _:
                return 0


@dataclass(frozen=True)
class BinField:
    """A file in its parts.

    Attributes:
        header: See there.
        encoding: (n_encoding,) float16.
        network: Float16, matrices and biases as the file has them.
        n_inputs, n_outputs: Of the perceptron, padding included.
    """

    header: BinHeader
    encoding: NDArray[np.float16]
    network: NDArray[np.float16]
    n_inputs: int
    n_outputs: int


def encode_field_bin(header: BinHeader, encoding: NDArray[np.float16], network: NDArray[np.float16]) -> bytes:
    """The bytes of a file."""
    start = _HEADER.pack(
        header.encoding,
        header.a,
        header.b,
        header.c,
        *header.resolutions,
        header.width,
        header.n_hidden_layers,
        *map(float, header.aabb.reshape(-1)),
    )
    return start + encoding.astype("<f2").tobytes() + network.astype("<f2").tobytes()


def decode_field_bin(data: bytes, where: str = "field") -> BinField:
    """Takes a file apart.

    Raises:
        InputError: It is too short, its header is absurd, its size fits no network, or a number isn't finite.
    """
    header = _decode_header(data, where)
    if len(data) % 2:
        raise InputError(f"expected half floats, found an odd number of bytes: {len(data)}", where=where)
    halves = np.frombuffer(data, "<f2", offset=HEADER_BYTES)
    if len(halves) <= header.n_encoding:
        raise InputError(
            f"expected over {HEADER_BYTES + 2 * header.n_encoding} bytes, found {len(data)}",
            where=where,
            fix="The file is cut short, or no field.",
        )
    if not np.isfinite(halves).all():
        raise InputError("some weights are infinite or not numbers", where=where)
    network = halves[header.n_encoding :]
    n_inputs, n_outputs = layer_sizes(len(network), header, where)
    return BinField(header, halves[: header.n_encoding], network, n_inputs, n_outputs)


def layer_sizes(n_halves: int, header: BinHeader, where: str) -> tuple[int, int]:
    """Inputs and outputs of a perceptron of so many halves, by the formula above.

    Where several sizes agree, as they do when outputs may be as many as hidden units, inputs decide: they are
    the encoding's features, alone for SH and with a normal for irradiance, padded or not.
    """
    h, n_between = header.width, header.n_hidden_layers - 1
    for n_outputs in OUTPUTS:
        rest = n_halves - n_outputs
        n_inputs = rest // h - 1 - n_between * (h + 1) - n_outputs
        if rest % h == 0 and n_inputs in input_sizes(header.n_features, n_outputs):
            return n_inputs, n_outputs
    raise InputError(
        f"{n_halves} numbers are no network of {header.n_hidden_layers} hidden layers of {h} "
        f"behind {header.n_features} features",
        where=where,
        fix="The file is cut short, too long, or no field.",
    )


def input_sizes(n_features: int, n_outputs: int) -> set[int]:
    """Inputs that a network may have: features alone or with a normal of three or four, padded or not."""
    normals = (3, 4) if n_outputs <= 4 else (0,)
    used = {n_features + normal for normal in normals}
    return used | {padded(n) for n in used}


def padded(n: int) -> int:
    """The next multiple of four, as a float4 wants it."""
    return -(-n // 4) * 4


def _decode_header(data: bytes, where: str) -> BinHeader:
    if len(data) < HEADER_BYTES:
        raise InputError(f"expected a header of {HEADER_BYTES} bytes, found {len(data)}", where=where)
    encoding, a, b, c, low, high, width, layers, *corners = _HEADER.unpack_from(data)
    header = BinHeader(
        encoding, a, b, c, (low, high), width, layers, np.array(corners, np.float32).reshape(2, 3)
    )
    for problem in _problems(header):
        raise InputError(
            f"{problem}: this is no field", where=where, fix="Give the .bin of a field, not of samples."
        )
    return header


def _problems(header: BinHeader) -> list[str]:
    """What can't be in a header; sizes are bounded before anything is multiplied by them."""
    a, b, c = header.a, header.b, header.c
    low, high = header.resolutions
    by_encoding = {
        HASH: [
            (1 <= a <= MAX_LEVELS, f"expected 1 to {MAX_LEVELS} levels, found {a}"),
            (b.bit_count() == 1 and 8 <= b <= MAX_TABLE, f"expected tables of a power of two, found {b}"),
            (1 <= c <= 16, f"expected 1 to 16 features, found {c}"),
            (math.isfinite(high) and 2 <= low <= high <= 1 << 20, f"found resolutions {low} to {high}"),
        ],
        TRI_PLANE: [
            (2 <= a <= MAX_SIDE, f"expected planes of 2 to {MAX_SIDE}, found {a}"),
            (1 <= c <= MAX_FEATURES, f"expected 1 to {MAX_FEATURES} features a plane, found {c}"),
        ],
        FREQUENCY: [
            (1 <= a <= MAX_FREQUENCIES, f"expected 1 to {MAX_FREQUENCIES} frequencies, found {a}"),
            (c in (0, 1), f"expected 0 or 1 for the identity, found {c}"),
        ],
    }
    box = header.aabb
    checks = [
        (header.encoding in by_encoding, f"expected an encoding of 0, 1 or 2, found {header.encoding}"),
        *by_encoding.get(header.encoding, []),
        (1 <= header.width <= MAX_WIDTH, f"expected 1 to {MAX_WIDTH} hidden units, found {header.width}"),
        (
            1 <= header.n_hidden_layers <= MAX_LAYERS,
            f"expected 1 to {MAX_LAYERS} hidden layers, found {header.n_hidden_layers}",
        ),
        (
            bool(np.isfinite(box).all() and np.all(box[0] <= box[1])),
            f"expected an AABB, found {box.tolist()}",
        ),
    ]
    return [problem for fine, problem in checks if not fine]
