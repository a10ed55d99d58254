"""A whole export: the field is read, perhaps made smaller, and written."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from irradia.core import provenance
from irradia.core.errors import InputError
from irradia.core.progress import Progress
from irradia.formats.samples_bin import BinOptions

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from irradia.field.bin_conventions import BinConventions
    from irradia.field.calibrate import Calibration
    from irradia.field.field import Field
    from irradia.field.native_fields import StoredField
    from irradia.field.quantised import QuantisedField
    from irradia.formats.samples import SampleFile

_N_CALIBRATION = 512


@dataclass(frozen=True)
class ExportJob:
    """Everything that decides the file.

    Attributes:
        weights: The field that is read; of a ``.glb`` the one inside.
        out: Its end chooses the format; a ``.glb`` is ``scene`` with the field inside.
        scene: A baked scene.
        precision: Of everything that isn't quantised.
        finish: Quantise the tables.
        samples: To learn on from, while they are.
        preset: Of a ``.bin``'s conventions; None is the one that we write.
        changes: Conventions as NAME=CHOICE.
        known: Samples to find conventions from.
        bin_samples: What ``samples`` and ``known`` don't say of themselves where they are a ``.bin``.
        seed: Root of all random numbers.

    Raises:
        InputError: Some choices don't go together.
    """

    weights: Path
    out: Path
    scene: Path | None = None
    precision: Literal["fp16", "fp32"] = "fp16"
    finish: Literal["int8", "int4"] | None = None
    samples: Path | None = None
    preset: str | None = None
    changes: tuple[str, ...] = ()
    known: Path | None = None
    bin_samples: BinOptions = field(default_factory=BinOptions)
    seed: int = 0

    def __post_init__(self) -> None:
        if (self.out.suffix.lower() == ".glb") != (self.scene is not None):
            raise InputError("a .glb and --scene go together", where="--out", fix="Give both, or neither.")
        if self.samples is not None and self.finish is None:
            raise InputError("goes with --finish", where="--samples")
        if self.weights.suffix.lower() == ".bin":
            return
        asked = {"--preset": self.preset, "--convention": self.changes, "--calibrate": self.known}
        for name, value in asked.items():
            if value:
                raise InputError("only a .bin leaves conventions open", where=name)

    def config(self) -> dict[str, Any]:
        """Every choice as plain values; files by their names, since folders differ between machines."""
        plain = asdict(self)
        for name in ("weights", "scene", "samples", "known"):
            path = getattr(self, name)
            plain[name] = path.name if path is not None else None
        del plain["out"]
        return plain


def run_export(job: ExportJob, progress: Progress) -> dict[str, Any]:
    """Reads, finishes and writes a field.

    Returns:
        What came of it, plain values.

    Raises:
        InputError: A file is wrong, or ``job.out`` can't hold the field; said before any long work.
    """
    from irradia.export.field_extension import read_baked_document
    from irradia.field.files import check_format

    if job.scene is not None:
        read_baked_document(job.scene)
    samples = _samples(job)
    stored, found = _read(job, progress)
    if job.scene is None:
        check_format(job.out, stored.field.spec, precision=job.precision, finish=job.finish)
    n_bytes = _write(job, _made(job, stored, samples, progress), _about(job, stored, found))
    return {
        "out": str(job.out),
        "read_bytes": stored.n_bytes,
        "calibration": _calibration(found),
        "bytes": n_bytes,
    }


def _samples(job: ExportJob) -> SampleFile | None:
    from irradia.formats.samples import open_samples

    return None if job.samples is None else open_samples(job.samples, job.bin_samples)


def _read(job: ExportJob, progress: Progress) -> tuple[StoredField, Calibration | None]:
    """The field, and how its conventions were found."""
    from irradia.field.bin_conventions import conventions_from_options
    from irradia.field.calibrate import calibrate
    from irradia.field.files import read_field
    from irradia.field.native_fields import StoredField
    from irradia.formats.samples import open_samples

    changes = _changes(job.changes)
    conventions: BinConventions = conventions_from_options(job.preset or "irradia", changes)
    if job.weights.suffix.lower() == ".glb":
        return _read_out(job.weights), None
    if job.known is None:
        return read_field(job.weights, conventions), None
    known, data = open_samples(job.known, job.bin_samples), job.weights.read_bytes()
    if "quantity" not in changes:
        conventions = replace(conventions, quantity=known.info.quantity)
    found = calibrate(data, *_irradiance(known), usual=conventions, where=str(job.weights), progress=progress)
    if not found.is_convincing:
        raise InputError(
            f"no conventions explain these samples: the best err by {found.best.error:.0%}",
            where=str(job.weights),
            fix="Give samples of the scene and the light that the field was trained from.",
        )
    return StoredField(found.field, n_bytes=len(data)), found


def _read_out(path: Path) -> StoredField:
    """The field inside a baked scene."""
    from irradia.export.field_extension import read_baked_document, read_baked_field

    stored = read_baked_field(read_baked_document(path))
    if stored is None:
        raise InputError(
            "there is no field inside", where=str(path), fix="`irradia export FIELD --scene` puts one there."
        )
    return stored


def _changes(texts: tuple[str, ...]) -> dict[str, Any]:
    flags = {"true": True, "false": False}
    pairs = (text.partition("=") for text in texts)
    return {name: flags.get(choice, choice) for name, _, choice in pairs}


def _irradiance(samples: SampleFile) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Positions, normals and E of some samples."""
    import numpy as np

    from irradia.core.sh import fibonacci_sphere, light_on

    some = np.linspace(0, len(samples) - 1, min(len(samples), _N_CALIBRATION)).astype(int)
    positions, values = samples.positions[some], samples.values[some]
    if samples.normals is not None:
        return positions, samples.normals[some], values
    normals = fibonacci_sphere(len(some)).astype(np.float32)
    light = light_on(values.reshape(len(some), -1, 3), normals)
    return positions, normals, light.astype(np.float32)


def _made(
    job: ExportJob, stored: StoredField, samples: SampleFile | None, progress: Progress
) -> Field | QuantisedField:
    """What goes into the file."""
    from irradia.field.quantise import FinishOptions, finish, round_tables
    from irradia.field.quantised import QuantisedField

    if job.finish is None:
        return QuantisedField(stored.field, stored.tensors) if stored.tensors else stored.field
    bits = 8 if job.finish == "int8" else 4
    if samples is None:
        return round_tables(stored.field, bits)
    ours, theirs = stored.field.frame.quantity, samples.info.quantity
    if ours != theirs:
        raise InputError(
            f"expected samples of {ours} light as the field holds, found {theirs}", where="--samples"
        )
    _check_scene(stored, samples)
    return finish(stored.field, bits, samples, FinishOptions(seed=job.seed), progress=progress)


def _check_scene(stored: StoredField, samples: SampleFile) -> None:
    """Refuses samples of another scene or light than the field's.

    Raises:
        InputError: It says what differs.
    """
    from irradia.formats.sample_origin import difference

    problem = difference(stored.provenance.get("samples"), samples.info.provenance)
    low, high = stored.field.frame.aabb
    if not problem and ((samples.aabb[0] > high) | (samples.aabb[1] < low)).any():
        problem = "their boxes don't meet"
    if problem:
        raise InputError(
            f"these samples are of another scene or light than the field's: {problem}",
            where="--samples",
            fix="Give those that it was trained from, or ones of the same scene and light.",
        )


def _about(job: ExportJob, stored: StoredField, found: Calibration | None) -> dict[str, Any]:
    """The field's provenance with that of this export; an earlier export's goes."""
    read = (path for path in (job.weights, job.samples, job.known) if path is not None)
    inputs = {path.name: provenance.sha256_file(path) for path in read}
    made = provenance.record("export", job.config(), seed=job.seed, inputs=inputs, device=None, wall_s=0.0)
    return {
        **stored.provenance,
        "export": {**made.reproducible(), "calibration": _calibration(found)},
    }


def _write(job: ExportJob, made: Field | QuantisedField, about: dict[str, Any]) -> int:
    """Bytes of the file."""
    from irradia.export.field_extension import put_field
    from irradia.field.files import save_field
    from irradia.field.native_fields import encode_field

    if job.scene is None:
        return save_field(job.out, made, about, precision=job.precision)
    return put_field(job.scene, encode_field(made, about, precision=job.precision, compress=True), job.out)


def _calibration(found: Calibration | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {"error": found.best.error, "conventions": asdict(found.best.conventions)}
