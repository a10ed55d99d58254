"""``irradia export``: a field in another format, smaller, or inside a baked scene; a scene for the web."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from irradia.cli import options
from irradia.cli.bin_samples import bin_options, bin_sample_options
from irradia.cli.output import finish as end
from irradia.cli.sections import SectionedCommand

if TYPE_CHECKING:
    from irradia.cli.export_job import ExportJob

SECTIONS = {
    "Results": ("--out", "--scene", "--precision", "--json"),
    "For the web": ("--web", "--single-file", "--field"),
    "Size": ("--finish", "--samples", "--seed"),
    "Reading a .bin": ("--preset", "--convention", "--calibrate", "--coefficients", "--quantity"),
}
_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@click.command("export", cls=SectionedCommand, sections=SECTIONS)
@click.argument("source", type=click.Path(exists=True, path_type=Path), metavar="WEIGHTS|SCENE|DIR")
@click.option(
    "-o",
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
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
@click.option("--finish", type=click.Choice(["int8", "int4"]), help="Quantise the tables.")
@click.option("--samples", type=_FILE, help="What the field was trained from, so that it can learn on.")
@click.option("--preset", help="Conventions of a .bin that is read.  [default: irradia]")
@click.option(
    "--convention", "changes", multiple=True, metavar="NAME=CHOICE", help="One of them; may be given again."
)
@click.option("--calibrate", "known", type=_FILE, help="Samples to find the conventions from.")
@bin_sample_options
@options.seed_option
@click.option(
    "--web",
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="A static site of the scene with the viewer.",
)
@click.option(
    "--single-file",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="HTML",
    help="The same as one file, which needs no server.",
)
@click.option("--field", "fields", multiple=True, type=_FILE, help="Further weights; may be given again.")
@options.json_option
@click.pass_context
def command(
    context: click.Context,
    as_json: bool,
    web: Path | None,
    single_file: Path | None,
    fields: tuple[Path, ...],
    **choices: Any,
) -> None:
    """Write a field in another format, smaller, or into a baked scene; or a scene for the web.

    WEIGHTS is a .safetensors, a .safetensors.zst, a .bin, or a scene.baked.glb with a field inside. A
    .bin doesn't say how it is to be read: name its conventions, or let them be found from samples of
    the same light.

    With --web or --single-file, SCENE is a .glb, or DIR a folder of `irradia bake`, which goes with its
    weights and reference pictures.
    """
    from irradia.core.progress import stderr_progress

    if web is not None or single_file is not None:
        from irradia.cli import export_web

        export_web.refuse_others(context)
        made = export_web.run_web_export(choices["source"], fields, web, single_file, stderr_progress())
        end(as_json, made, export_web.describe(made))
        return
    from irradia.cli.export_job import run_export

    _check_weights(choices["source"], choices["out"], fields)
    choices["weights"] = choices.pop("source")
    result = run_export(make_job(**choices), stderr_progress())
    end(as_json, result, describe(result))


def _check_weights(source: Path, out: Path | None, fields: tuple[Path, ...]) -> None:
    """Refuses what only goes with --web or --single-file."""
    if out is None:
        raise click.UsageError("Missing option '-o' / '--out', '--web' or '--single-file'.")
    if source.is_dir():
        raise click.UsageError(f"'{source}' is a folder: that goes with --web or --single-file.")
    if fields:
        raise click.UsageError("--field goes with --web or --single-file; the weights come first.")


def make_job(*, coefficients: str | None, quantity: str | None, **choices: Any) -> ExportJob:
    """The command line as a job; ``choices`` are those of :class:`ExportJob`."""
    from irradia.cli.export_job import ExportJob

    bin_samples = bin_options(coefficients, quantity, choices["known"], choices["samples"])
    return ExportJob(**choices, bin_samples=bin_samples)


def describe(result: dict[str, Any]) -> str:
    """What was written, and the conventions that were found."""
    lines = [f"{result['out']}: {result['bytes']:,} bytes, from {result['read_bytes']:,}"]
    if result["calibration"] is not None:
        lines.append(f"conventions found with an error of {result['calibration']['error']:.2%}:")
        lines += [f"  {name}={choice}" for name, choice in result["calibration"]["conventions"].items()]
    return "\n".join(lines)
