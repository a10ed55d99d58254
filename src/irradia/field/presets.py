"""Fields of given sizes: where bytes do most good, found by `bench/field_quality.py`.

Sizes are of the file as shipped: tables in 8 bits, the perceptron in halves, packed by zstd.
"""

from __future__ import annotations

from dataclasses import dataclass

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean
from irradia.field.encodings import Frequency, HashGrid, SphericalHarmonics, TriPlane
from irradia.field.quantised import Bits
from irradia.field.spec import FieldSpec
from irradia.field.training.options import TrainOptions

_NORMAL = SphericalHarmonics(degree=3)  # E is nearly quadratic in the normal (Ramamoorthi and Hanrahan 2001)


@dataclass(frozen=True)
class Preset:
    """A field of about a size, and how it learns best in a minute.

    Attributes:
        spec: Of irradiance.
        bits: Of its tables; None leaves them in halves.
        batch_size: Samples a step: small tables gain more from many steps than from large ones.
        lr_encoding, lr_network: Learning rates at the start.
    """

    spec: FieldSpec
    bits: Bits | None = 8
    batch_size: int = 16_384
    lr_encoding: float = 0.01
    lr_network: float = 0.005

    def training(self, time_s: float, seed: int = 0) -> TrainOptions:
        """A training of so many seconds."""
        return TrainOptions(
            steps=None,
            time_s=time_s,
            batch_size=self.batch_size,
            lr_encoding=self.lr_encoding,
            lr_network=self.lr_network,
            seed=seed,
        )


PRESETS: dict[str, Preset] = {
    "hash-50kB": Preset(FieldSpec(HashGrid(2, 13, 8, 5, 16), _NORMAL, 64, 2)),
    "hash-200kB": Preset(FieldSpec(HashGrid(2, 15, 8, 8, 28), _NORMAL, 64, 3)),
    "hash-1MB": Preset(FieldSpec(HashGrid(3, 17, 8, 8, 50), _NORMAL, 64, 3)),
    "triplane-50kB": Preset(FieldSpec(TriPlane(58, 4), _NORMAL, 64, 2)),
    "triplane-200kB": Preset(FieldSpec(TriPlane(88, 8), _NORMAL, 64, 3)),
    "triplane-1MB": Preset(FieldSpec(TriPlane(144, 16), _NORMAL, 64, 3)),
    "frequency-50kB": Preset(FieldSpec(Frequency(6), _NORMAL, 100, 3), None),
    "frequency-200kB": Preset(FieldSpec(Frequency(8), _NORMAL, 128, 6), None),
}


def preset(name: str) -> Preset:
    """A preset by its name.

    Raises:
        InputError: There is none.
    """
    if name not in PRESETS:
        raise InputError(f"no preset {name!r}", fix=did_you_mean(name, PRESETS))
    return PRESETS[name]
