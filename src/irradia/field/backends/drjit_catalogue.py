"""Which encodings have a fast version in Dr.Jit. Nothing here loads Dr.Jit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from irradia.field.encoding import Encoding
from irradia.field.encodings.composite import Composite
from irradia.field.encodings.frequency import Frequency
from irradia.field.encodings.identity import Identity
from irradia.field.spec import FieldSpec

# Fast versions by the encoding's name: module beside this one, and class. Compositions are taken apart.
ACCELERATED: dict[str, str] = {
    "hash": "drjit_hash_grid:DrJitHashGrid",
    "triplane": "drjit_tri_plane:DrJitTriPlane",
    "frequency": "drjit_frequency:DrJitFrequency",
    "one_blob": "drjit_one_blob:DrJitOneBlob",
    "sh": "drjit_spherical_harmonics:DrJitSphericalHarmonics",
    "identity": "drjit_identity:DrJitIdentity",
}
MOST_PARAMETERS = 1 << 31  # indices are 32 bits


@dataclass(frozen=True)
class Part:
    """An encoding that is no composition.

    Attributes:
        encoding: Itself.
        first: Of its parameters, in the array of the whole.
        row: Of its features, among those of the whole.
    """

    encoding: Encoding
    first: int
    row: int


def parts(encoding: Encoding, first: int = 0, row: int = 0) -> Iterator[Part]:
    """What an encoding is composed of; one that isn't is its own only part."""
    if isinstance(encoding, Composite):
        for part, own, out in encoding.slices():
            yield from parts(part, first + own.start, row + out.start)
    elif isinstance(encoding, Frequency) and encoding.include_identity:
        yield Part(Identity(), first, row)
        yield Part(replace(encoding, include_identity=False), first, row + 3)
    else:
        yield Part(encoding, first, row)


def lacks_acceleration(spec: FieldSpec) -> str | None:
    """What of a spec has no fast version, in words; None where all has."""
    for encoding in (spec.position, spec.direction):
        if encoding is None:
            continue
        for part in parts(encoding):
            if part.encoding.name not in ACCELERATED:
                return f"the encoding {part.encoding.name}"
        if encoding.n_parameters > MOST_PARAMETERS:
            return f"{encoding.n_parameters} parameters of one encoding, of at most {MOST_PARAMETERS}"
    return None
