"""Which field to train: from flags in the words of the Unity project's trainer, or from a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean

if TYPE_CHECKING:
    from irradia.field.encoding import Encoding
    from irradia.field.spec import ActivationName, FieldSpec, Head, Mode
    from irradia.formats.samples import SampleInfo

EncodingName = Literal["hash", "triplane", "frequency"]
_SH_MODES: dict[int, Mode] = {4: "sh1", 9: "sh2"}


@dataclass(frozen=True)
class SpecChoices:
    """A field as its flags say; defaults are the Unity project's.

    Attributes:
        spec_file: JSON that says all of it; then no other may differ from its default.
        preset: Name that does; see :mod:`irradia.field.presets`.
        encoding: Of positions.
        n_levels, n_features, log2_hashmap_size, base_resolution, max_resolution: Of ``hash``.
        plane_res, features_per_plane: Of ``triplane``.
        n_frequencies, include_identity: Of ``frequency``.
        direction: Encoding of normals, as ``NAME[:SIZE]``.
        hidden_dim, hidden_layers: Of the perceptron.
        activation: Of hidden layers.
        head: Of outputs; None is ``exp``, or ``linear`` for coefficients.
        sh_mode: Samples must be SH coefficients; those that are imply it.
    """

    spec_file: Path | None = None
    encoding: EncodingName = "hash"
    n_levels: int = 16
    n_features: int = 2
    log2_hashmap_size: int = 19
    base_resolution: int = 16
    max_resolution: int = 2048
    plane_res: int = 128
    features_per_plane: int = 16
    n_frequencies: int = 10
    include_identity: bool = False
    direction: str = "identity"
    hidden_dim: int = 64
    hidden_layers: int = 2
    activation: ActivationName = "relu"
    head: Head | None = None
    sh_mode: bool = False
    preset: str | None = None

    def spec(self, info: SampleInfo) -> FieldSpec:
        """The field for a dataset.

        Raises:
            InputError: The choices don't go together, or not with the dataset.
        """
        if self.sh_mode and info.kind != "sh":
            raise InputError(
                f"expected samples of SH coefficients, found {info.kind} samples",
                where="--sh-mode",
                fix="Sample with --kind sh-grid or sh-random, or leave out --sh-mode.",
            )
        from irradia.field.registry import read_spec
        from irradia.field.spec import FieldSpec

        if self.spec_file is not None:
            return read_spec(self.spec_file.read_text(encoding="utf-8"), where=str(self.spec_file))
        is_sh = info.kind == "sh"
        if self.preset is not None:
            return self._preset(is_sh)
        return FieldSpec(
            position=self._position(),
            direction=None if is_sh else parse_direction(self.direction),
            width=self.hidden_dim,
            n_hidden_layers=self.hidden_layers,
            activation=self.activation,
            head=self.head or ("linear" if is_sh else "exp"),
            mode=_SH_MODES[info.n_coefficients] if is_sh else "irradiance",
        )

    def _preset(self, is_sh: bool) -> FieldSpec:
        from irradia.field.presets import preset

        if is_sh:
            raise InputError("presets are of irradiance, found samples of SH coefficients", where="--preset")
        return preset(self.preset or "").spec

    def _position(self) -> Encoding:
        from irradia.field.encodings import Frequency, HashGrid, TriPlane

        if self.encoding == "triplane":
            return TriPlane(self.plane_res, self.features_per_plane)
        if self.encoding == "frequency":
            return Frequency(self.n_frequencies, self.include_identity)
        return HashGrid(
            self.n_levels,
            self.log2_hashmap_size,
            self.n_features,
            self.base_resolution,
            self.max_resolution,
        )


def parse_direction(text: str) -> Encoding:
    """An encoding of normals from ``identity``, ``sh[:BANDS]``, ``one_blob[:BINS]`` or ``frequency[:N]``.

    Raises:
        InputError: It is none of them.
    """
    from irradia.field.encodings import Frequency, Identity, OneBlob, SphericalHarmonics

    sized = {"sh": SphericalHarmonics, "one_blob": OneBlob, "frequency": Frequency}
    name, colon, size = text.replace("-", "_").partition(":")
    if name == "identity" and not colon:
        return Identity()
    if name not in sized or (colon and not size.isdecimal()):
        fix = did_you_mean(name, ["identity", *sized])
        raise InputError(f"expected NAME[:SIZE], found {text!r}", where="--direction", fix=fix)
    return sized[name](int(size)) if colon else sized[name]()
