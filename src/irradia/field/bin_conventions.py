"""What a ``.bin`` of the Unity project doesn't say of itself, as named choices."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_type_hints

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean
from irradia.field.spec import ActivationName, Head, Quantity
from irradia.formats.field_bin import FREQUENCY, HASH, TRI_PLANE

Matrix = Literal["out_in", "in_out"]
Bias = Literal["after", "before", "last"]
Inputs = Literal["features_normal", "normal_features", "normal4_features"]
Normal = Literal["signed", "unit"]
Levels = Literal["tiny-cuda-nn", "floor"]
Primes = Literal["xyz", "zyx"]
Table = Literal["entry_feature", "feature_entry"]
Planes = Literal[
    "xy xz yz", "xy yz xz", "xy yz zx", "xz xy yz", "xz yz xy", "yz xy xz", "yz xz xy",
    "yx zx zy", "yx zy zx", "zx yx zy", "zx zy yx", "zy yx zx", "zy zx yx",
]  # fmt: skip
Texels = Literal["row_column_feature", "feature_row_column"]
Centres = Literal["half", "corners"]
Waves = Literal[
    "axis frequency wave", "axis wave frequency", "frequency axis wave",
    "frequency wave axis", "wave axis frequency", "wave frequency axis",
]  # fmt: skip
Turns = Literal["pi", "one", "two_pi"]
Coefficients = Literal["channel_xyz", "yzx_channel"]
ShQuantity = Literal["radiance", "irradiance"]


@dataclass(frozen=True)
class BinConventions:
    """One way to read such a file; the defaults are the way that we write it.

    Attributes:
        matrix: ``out_in`` has a row for each output, ``in_out`` for each input.
        bias: Each after its matrix or before it, or all of them behind all matrices.
        inputs: Whether the normal follows the features or precedes them; ``normal4``: with a zero behind it.
        normal: As it is, or as (n + 1) / 2.
        levels: Resolutions of hash grids; see HashGrid.convention.
        hash_all: Whether levels that would fit their table are hashed nevertheless.
        primes: Which axis has the factor 1; the other end has 805459861.
        table: Whether an entry's features stand together, or each feature's entries.
        planes: Their order, each as the axis along rows, then that along columns, so ``xy`` has x across.
        texels: Likewise for planes.
        centres: ``half`` puts texel i at (i + ½) / n, ``corners`` at i / (n − 1).
        waves: Order of frequency features, slowest first; ``wave`` is sine before cosine.
        identity_last: Whether x, y and z follow the waves, where they are features at all.
        turns: Argument of the waves is 2^k · x times π, 1 or 2π.
        coefficients: ``channel_xyz`` has L0, x, y, z of red, then green, then blue; ``yzx_channel`` is ours.
        sh_quantity: What the coefficients are of.
        activation: Of hidden layers.
        head: What irradiance goes through last.
        quantity: What light it is.
    """

    matrix: Matrix = "out_in"
    bias: Bias = "after"
    inputs: Inputs = "features_normal"
    normal: Normal = "signed"
    levels: Levels = "tiny-cuda-nn"
    hash_all: bool = False
    primes: Primes = "xyz"
    table: Table = "entry_feature"
    planes: Planes = "xy xz yz"
    texels: Texels = "row_column_feature"
    centres: Centres = "half"
    waves: Waves = "axis frequency wave"
    identity_last: bool = False
    turns: Turns = "pi"
    coefficients: Coefficients = "channel_xyz"
    sh_quantity: ShQuantity = "radiance"
    activation: ActivationName = "relu"
    head: Head = "exp"
    quantity: Quantity = "full"

    def __post_init__(self) -> None:
        for name, kind in get_type_hints(type(self)).items():
            value, choices = getattr(self, name), get_args(kind) or (False, True)
            if value not in choices:
                known = ", ".join(map(str, choices))
                raise InputError(f"expected {name} to be one of {known}, found {value!r}")


PRESETS: dict[str, BinConventions] = {
    "irradia": BinConventions(),
    "tiny-cuda-nn": BinConventions(normal="unit"),
    "pytorch": BinConventions(
        levels="floor",
        hash_all=True,
        texels="feature_row_column",
        centres="corners",
        waves="frequency wave axis",
    ),
}

_OF_NETWORK = ("matrix", "bias")
_OF_IRRADIANCE = ("inputs", "normal")
_OF_SH = ("coefficients", "sh_quantity")
_OF_ENCODING = {
    HASH: ("levels", "hash_all", "primes", "table"),
    TRI_PLANE: ("planes", "texels", "centres"),
    FREQUENCY: ("waves", "identity_last", "turns"),
}


def conventions_from_options(preset: str, changes: dict[str, Any] | None = None) -> BinConventions:
    """A preset with some choices of one's own.

    Raises:
        InputError: On an unknown preset, an unknown name (naming the nearest) or an unknown choice.
    """
    if preset not in PRESETS:
        raise InputError(f"no preset {preset!r}", fix=did_you_mean(preset, PRESETS))
    known = [field.name for field in dataclasses.fields(BinConventions)]
    for name in changes or {}:
        if name not in known:
            raise InputError(f"no convention {name!r}", fix=did_you_mean(name, known))
    return dataclasses.replace(PRESETS[preset], **(changes or {}))


def all_conventions(
    encoding: int, is_sh: bool, usual: BinConventions
) -> Iterator[tuple[BinConventions, list[BinConventions]]]:
    """Every combination of choices that matter to a kind of file.

    Yields:
        A choice of the encoding, and all choices of the network with it.
    """
    for of_encoding in _variants(usual, _OF_ENCODING[encoding]):
        names = _OF_NETWORK + (_OF_SH if is_sh else _OF_IRRADIANCE)
        yield of_encoding, list(_variants(of_encoding, names))


def _variants(usual: BinConventions, names: tuple[str, ...]) -> Iterator[BinConventions]:
    hints = get_type_hints(BinConventions)
    choices = [get_args(hints[name]) or (False, True) for name in names]
    for values in itertools.product(*choices):
        yield dataclasses.replace(usual, **dict(zip(names, values, strict=True)))
