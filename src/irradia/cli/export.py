"""``irradia export``: a field in another format, smaller, or inside a baked scene."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from irradia.cli import options
from irradia.cli.output import finish as end
from irradia.cli.sections import SectionedCommand
from irradia.core.errors import InputError

if TYPE_CHECKING:
    from irradia.core.progress import Progress
    from irradia.field.bin_conventions import BinConventions
    from irradia.field.calibrate import Calibration
    from irradia.field.native_fields import StoredField
    from irradia.formats.samples import SampleFile

SECTIONS = {
    "Results": ("--out", "--scene", "--precision", "--json"),
    "Size": ("--finish", "--samples", "--seed"),
    "Reading a .bin": ("--preset", "--convention", "--calibrate"),
}
_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)
_N_CALIBRATION = 512


@click.command("export", cls=SectionedCommand, sections=SECTIONS)
@click.argument("weights", type=_FILE)
@click.option(
    "-o",
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    required=True,
    help=".safetensors, .safetensors.zst, .bin, or .glb with --scene.",
)
@click.option("--scene", type=_FILE, help="The scene.baked.glb that the field goes into.")
@click.option(
    "--precision",
    type=click.Choice(["fp16", "fp32"]),
    default="fp16",
    show_default=True,
    help="Of everything that isn't quantised.",
)
@click.option("--finish", "bits", type=click.Choice(["int8", "int4"]), help="Quantise the tables.")
@click.option("--samples", type=_FILE, help="What the field was trained from, so that it can learn on.")
@click.option("--preset", default="irradia", show_default=True, help="Conventions of a .bin that is read.")
@click.option(
    "--convention", "changes", multiple=True, metavar="NAME=CHOICE", help="One of them; may be given again."
)
@click.option("--calibrate", "known", type=_FILE, help="Samples to find the conventions from.")
@options.seed_option
@options.json_option
def command(weights: Path, out: Path, as_json: bool, **flags: Any) -> None:
    """Write a field in another format, smaller, or into a baked scene.

    WEIGHTS is a .safetensors, a .safetensors.zst or a .bin. A .bin doesn't say how it is to be read:
    name its conventions, or let them be found from samples of the same light.
    """
    from irradia.core.progress import stderr_progress

    progress = stderr_progress()
    conventions = _conventions(flags["preset"], flags["changes"])
    stored, found = _read(weights, conventions, flags["known"], progress)
    result: dict[str, Any] = {"out": str(out), "read_bytes": stored.n_bytes, "calibration": _about(found)}
    result["bytes"] = _write(stored, out, flags, progress)
    end(as_json, result, _describe(result))


def _conventions(preset: str, changes: tuple[str, ...]) -> BinConventions:
    from irradia.field.bin_conventions import conventions_from_options

    flags = {"true": True, "false": False}
    chosen: dict[str, Any] = {}
    for change in changes:
        name, _, choice = change.partition("=")
        chosen[name] = flags.get(choice, choice)
    return conventions_from_options(preset, chosen)


def _read(
    weights: Path, conventions: BinConventions, known: Path | None, progress: Progress
) -> tuple[StoredField, Calibration | None]:
    """The field, and how its conventions were found."""
    from irradia.field.calibrate import calibrate
    from irradia.field.files import read_field
    from irradia.field.native_fields import StoredField
    from irradia.formats.samples import open_samples

    if known is None:
        return read_field(weights, conventions), None
    if weights.suffix.lower() != ".bin":
        raise InputError("only a .bin leaves conventions open", where="--calibrate")
    data = weights.read_bytes()
    light = _irradiance(open_samples(known))
    found = calibrate(data, *light, usual=conventions, where=str(weights), progress=progress)
    if not found.is_convincing:
        raise InputError(
            f"no conventions explain these samples: the best err by {found.best.error:.0%}",
            where=str(weights),
            fix="Give samples of the scene and the light that the field was trained from.",
        )
    return StoredField(found.field, n_bytes=len(data)), found


def _irradiance(samples: SampleFile) -> tuple[Any, Any, Any]:
    """Positions, normals and E of some samples."""
    import numpy as np

    from irradia.core.sh import fibonacci_sphere, irradiance_weights

    some = np.linspace(0, len(samples) - 1, min(len(samples), _N_CALIBRATION)).astype(int)
    positions, values = samples.positions[some], samples.values[some]
    if samples.normals is not None:
        return positions, samples.normals[some], values
    normals = fibonacci_sphere(len(some)).astype(np.float32)
    series = values.reshape(len(some), -1, 3)
    weights = irradiance_weights(normals)[:, : series.shape[1]]
    return positions, normals, np.maximum(np.einsum("ni,nic->nc", weights, series), 0.0)


def _write(stored: StoredField, out: Path, flags: dict[str, Any], progress: Progress) -> int:
    """Bytes of the file."""
    from irradia.export.field_extension import put_field
    from irradia.field.files import save_field
    from irradia.field.native_fields import encode_field
    from irradia.field.quantise import FinishOptions, finish, round_tables
    from irradia.field.quantised import QuantisedField
    from irradia.formats.samples import open_samples

    made = QuantisedField(stored.field, stored.tensors) if stored.tensors else stored.field
    if flags["bits"]:
        bits = 8 if flags["bits"] == "int8" else 4
        if flags["samples"] is None:
            made = round_tables(stored.field, bits)
        else:
            how = FinishOptions(seed=flags["seed"])
            made = finish(stored.field, bits, open_samples(flags["samples"]), how, progress=progress)
    if (out.suffix.lower() == ".glb") != (flags["scene"] is not None):
        raise InputError("a .glb and --scene go together", where="--out", fix="Give both, or neither.")
    if flags["scene"] is not None:
        data = encode_field(made, stored.provenance, precision=flags["precision"], compress=True)
        return put_field(flags["scene"], data, out)
    return save_field(out, made, stored.provenance, precision=flags["precision"])


def _about(found: Calibration | None) -> dict[str, Any] | None:
    from dataclasses import asdict

    if found is None:
        return None
    return {"error": found.best.error, "conventions": asdict(found.best.conventions)}


def _describe(result: dict[str, Any]) -> str:
    lines = [f"{result['out']}: {result['bytes']:,} bytes, from {result['read_bytes']:,}"]
    if result["calibration"] is not None:
        lines.append(f"conventions found with an error of {result['calibration']['error']:.2%}:")
        lines += [f"  {name}={choice}" for name, choice in result["calibration"]["conventions"].items()]
    return "\n".join(lines)
