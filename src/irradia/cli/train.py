"""``irradia train``: a neural field from a dataset."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from irradia.cli import options
from irradia.cli.bin_samples import bin_options, bin_sample_options
from irradia.cli.output import code_of, finish
from irradia.cli.sections import SectionedCommand

if TYPE_CHECKING:
    from irradia.cli.train_job import TrainJob
    from irradia.field.training.options import TrainOptions

SECTIONS = {
    "Results": ("--out", "--finish", "--precision", "--json"),
    "Field": (
        *("--preset", "--encoding", "--sh-mode", "--hidden-dim", "--hidden-layers", "--activation", "--head"),
        *("--direction", "--n-levels", "--n-features", "--log2-hashmap-size", "--base-resolution"),
        *("--max-resolution", "--plane-res", "--features-per-plane", "--n-frequencies"),
        *("--include-identity", "--spec"),
    ),
    "Training": (
        *("--steps", "--time", "--batch-size", "--loss", "--lr-encoding", "--lr-network", "--lr-final"),
        *("--average", "--early-stop", "--seed"),
    ),
    "Samples": (
        *("--jitter-copies", "--jitter-radius", "--jitter-scene", "--smooth-k", "--smooth-normal-thresh"),
        *("--coefficients", "--quantity", "--memory", "--follow"),
    ),
    "Validation": ("--validation", "--validate-every", "--hold-out-blocks"),
    "Interruptions and machines": ("--resume", "--checkpoint", "--backend", "--threads"),
}

# Parameters of flags that say which field, as click names them.
SPEC_NAMES = (
    *("encoding", "n_levels", "n_features", "log2_hashmap_size", "base_resolution", "max_resolution"),
    *("plane_res", "features_per_plane", "n_frequencies", "include_identity", "direction", "hidden_dim"),
    *("hidden_layers", "activation", "head"),
)
DATA_NAMES = {
    "jitter_copies": "jitter_copies",
    "jitter_radius": "jitter_radius_m",
    "smooth_k": "smooth_k",
    "smooth_normal_thresh": "smooth_normal_threshold",
    "hold_out_blocks": "hold_out_blocks",
}
_MEBIBYTE = 1 << 20
_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)
_COUNT = options.Whole(1, 1 << 30)


@click.command(
    "train",
    cls=SectionedCommand,
    sections=SECTIONS,
    # The Unity project's trainer writes some of its names with underscores.
    context_settings={"token_normalize_func": lambda name: name.replace("_", "-")},
)
@click.argument("data", required=False, type=click.Path(dir_okay=False, path_type=Path))
@click.option("-i", "--input", "data_flag", type=click.Path(dir_okay=False, path_type=Path), help="DATA.")
@click.option(
    "-o",
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    required=True,
    help="The field: .safetensors, .safetensors.zst or .bin.",
)
@click.option(
    "--finish",
    "finishing",
    type=click.Choice(["int8", "int4"]),
    help="Quantise the tables, and train the decoder on for them.",
)
@click.option(
    "--precision",
    type=click.Choice(["fp16", "fp32"]),
    default="fp16",
    show_default=True,
    help="Of what isn't quantised.",
)
@click.option(
    "--preset",
    metavar="NAME",
    help="A field of about a size with rates and finishing to match, such as hash-200kB.",
)
@click.option(
    "--encoding",
    type=click.Choice(["hash", "triplane", "frequency"]),
    default="hash",
    show_default=True,
    help="Of positions.",
)
@click.option("--sh-mode", is_flag=True, help="The field gives SH coefficients; samples of SH imply it.")
@click.option("--hidden-dim", type=options.Whole(1, 128), default=64, show_default=True, metavar="N")
@click.option("--hidden-layers", type=options.Whole(1, 6), default=2, show_default=True, metavar="N")
@click.option(
    "--activation",
    type=click.Choice(["relu", "leaky_relu", "silu", "gelu", "sine"]),
    default="relu",
    show_default=True,
    metavar="NAME",
    help="Of hidden layers: relu, leaky_relu, silu, gelu or sine.",
)
@click.option(
    "--head",
    type=click.Choice(["exp", "softplus", "linear"]),
    metavar="NAME",
    help="Of outputs: exp, softplus or linear.  [default: exp; linear for SH]",
)
@click.option(
    "--direction",
    default="identity",
    show_default=True,
    metavar="NAME[:SIZE]",
    help="Encoding of normals: identity, sh, one_blob or frequency, such as sh:4.",
)
@click.option("--n-levels", type=options.Whole(1, 32), default=16, show_default=True, metavar="N")
@click.option(
    "--n-features",
    type=options.Whole(1, 16),
    default=2,
    show_default=True,
    metavar="N",
    help="Of each entry of a hash level.",
)
@click.option(
    "--log2-hashmap-size",
    type=options.Whole(3, 28),
    default=19,
    show_default=True,
    metavar="N",
    help="Entries of a hash level at most, as a power of two.",
)
@click.option("--base-resolution", type=_COUNT, default=16, show_default=True, metavar="N")
@click.option("--max-resolution", type=_COUNT, default=2048, show_default=True, metavar="N")
@click.option(
    "--plane-res",
    type=options.Whole(2, 8192),
    default=128,
    show_default=True,
    metavar="N",
    help="Of each side of a triplane.",
)
@click.option("--features-per-plane", type=options.Whole(1, 128), default=16, show_default=True, metavar="N")
@click.option("--n-frequencies", type=options.Whole(1, 24), default=10, show_default=True, metavar="N")
@click.option("--include-identity", is_flag=True, help="frequency: the coordinates are features too.")
@click.option(
    "--spec", "spec_file", type=_FILE, metavar="FILE", help="All of the field, as JSON, instead of the above."
)
@click.option("--steps", type=_COUNT, metavar="N", help="[default: 5000, unless --time is given]")
@click.option(
    "--time", "time_s", type=options.POSITIVE, metavar="S", help="Train this long, with rates to match."
)
@click.option("--batch-size", type=options.Whole(1, 1 << 24), default=65_536, show_default=True, metavar="N")
@click.option(
    "--loss",
    type=click.Choice(["relative_l2", "relative_l2_luminance", "l2", "log"]),
    default="relative_l2",
    show_default=True,
    metavar="NAME",
    help="relative_l2, relative_l2_luminance, l2 or log.",
)
@click.option(
    "--lr-encoding", type=options.NOT_NEGATIVE, default=0.01, show_default=True, metavar="X", help="At first."
)
@click.option(
    "--lr-network", type=options.NOT_NEGATIVE, default=0.001, show_default=True, metavar="X", help="At first."
)
@click.option(
    "--lr-final",
    type=options.POSITIVE,
    default=0.1,
    show_default=True,
    metavar="X",
    help="Share of both that is left at the end.",
)
@click.option(
    "--average",
    type=options.NOT_NEGATIVE,
    default=0.99,
    show_default=True,
    metavar="X",
    help="Decay of the running mean of weights that the field is made of; 0 takes the last ones.",
)
@click.option(
    "--early-stop",
    type=_COUNT,
    metavar="N",
    help="End after N validations without a better relMSE, and keep the best.",
)
@click.option("--jitter-copies", type=options.Whole(0, 64), default=0, show_default=True, metavar="N")
@click.option("--jitter-radius", type=options.POSITIVE, default=0.05, show_default=True, metavar="M")
@click.option("--jitter-scene", metavar="SCENE", help="Ask its surfaces whether copies see their samples.")
@click.option(
    "--smooth-k",
    type=options.Whole(0, 256),
    default=0,
    show_default=True,
    metavar="N",
    help="Replace values by means over the N nearest samples.",
)
@click.option(
    "--smooth-normal-thresh",
    type=options.Finite(-1.0),
    default=0.5,
    show_default=True,
    metavar="X",
    help="Of those whose normals have at least this cosine.",
)
@click.option(
    "--memory",
    "memory_mib",
    type=_COUNT,
    default=1024,
    show_default=True,
    metavar="MIB",
    help="For samples; larger files are read in shuffled windows.",
)
@bin_sample_options
@click.option("--follow", is_flag=True, help="Wait for DATA to appear.")
@click.option(
    "--validation", type=_FILE, metavar="FILE", help="Samples to judge by.  [default: DATA's own, else 2 %]"
)
@click.option(
    "--validate-every", type=_COUNT, metavar="N", help="Steps between validations.  [default: a twentieth]"
)
@click.option(
    "--hold-out-blocks",
    type=options.NOT_NEGATIVE,
    default=0.0,
    show_default=True,
    metavar="X",
    help="Share of space kept from training, to see how well the field fills gaps.",
)
@click.option("--resume", is_flag=True, help="Go on with the training that was stopped here.")
@click.option(
    "--checkpoint",
    "--checkpoint-s",
    "checkpoint_s",
    type=options.POSITIVE,
    default=60.0,
    show_default=True,
    metavar="S",
    help="How often to save what --resume needs.",
)
@click.option(
    "--backend",
    type=click.Choice(["auto", "numpy", "numba", "drjit"]),
    default="auto",
    show_default=True,
    metavar="NAME",
    help="auto, numpy, numba or drjit.",
)
@options.seed_option
@options.threads_option
@options.json_option
@click.pass_context
def command(ctx: click.Context, as_json: bool, **_: Any) -> int:
    """Train a neural field from a dataset.

    DATA is a file of samples, .samples or the Unity project's .bin; it may still be growing. Beside the
    field a log is written as .training.csv, and its curves as .training.svg. Ctrl-C leaves a usable field.
    """
    from irradia.core.progress import stderr_progress

    job = job_of(ctx)
    from irradia.cli.train_run import run_training

    result = run_training(job, stderr_progress())
    return finish(as_json, result, describe(result), code_of(result["complete"]))


def job_of(ctx: click.Context) -> TrainJob:
    """The job that a command line, as parsed, asks for; see :func:`make_job`."""
    choices = {name: value for name, value in ctx.params.items() if name != "as_json"}
    given = {name for name in choices if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE}
    return make_job(given, **choices)


def make_job(
    given: set[str],
    *,
    data: Path | None,
    data_flag: Path | None,
    out: Path,
    finishing: str | None,
    precision: str,
    preset: str | None,
    sh_mode: bool,
    spec_file: Path | None,
    steps: int | None,
    time_s: float | None,
    memory_mib: int,
    jitter_scene: str | None,
    follow: bool,
    validation: Path | None,
    coefficients: str | None,
    quantity: str | None,
    resume: bool,
    backend: str,
    threads: int | None,
    **choices: Any,
) -> TrainJob:
    """The command line as a job; ``given`` names what was not left to its default.

    ``choices`` hold those of the field, of the samples and of :class:`TrainOptions`.

    Raises:
        click.UsageError: Options are missing or exclude each other.
    """
    from irradia.cli.train_job import TrainJob
    from irradia.cli.train_spec import SpecChoices

    if (data is None) == (data_flag is None):
        raise click.UsageError("Give the samples once: as DATA, or by -i.")
    _one_word_on_the_field(given)
    if preset is not None:
        finishing = _as_preset(preset, given, choices, finishing)
    spec = {name: choices.pop(name) for name in SPEC_NAMES}
    return TrainJob(
        data=data or data_flag,  # type: ignore[arg-type]  # one of them is there
        out=out,
        choices=SpecChoices(spec_file=spec_file, preset=preset, sh_mode=sh_mode, **spec),
        options=_train_options(steps, time_s, memory_mib, choices),
        backend=backend,
        threads=threads,
        validation=validation,
        follow=follow,
        jitter_scene=jitter_scene,
        resume=resume,
        finish=finishing,  # type: ignore[arg-type]
        precision=precision,  # type: ignore[arg-type]
        bin_samples=bin_options(coefficients, quantity, data or data_flag, validation),
    )


def _train_options(
    steps: int | None, time_s: float | None, memory_mib: int, choices: dict[str, Any]
) -> TrainOptions:
    from irradia.field.training.options import DEFAULT_STEPS, DataOptions, TrainOptions

    samples = {field: choices.pop(name) for name, field in DATA_NAMES.items()}
    data = DataOptions(**samples, memory_bytes=memory_mib * _MEBIBYTE)
    if steps is None and time_s is None:
        steps = DEFAULT_STEPS
    return TrainOptions(steps=steps, time_s=time_s, data=data, **choices)


def _one_word_on_the_field(given: set[str]) -> None:
    """Refuses a second word on what a preset or a spec file says."""
    whole = [name for name in ("preset", "spec_file") if name in given]
    clash = sorted(given & {*SPEC_NAMES, *whole[1:]})
    if whole and clash:
        flags = [name.removesuffix("_file").replace("_", "-") for name in (whole[0], clash[0])]
        raise click.UsageError(f"--{flags[0]} says all of the field, so --{flags[1]} can't.")


def _as_preset(name: str, given: set[str], choices: dict[str, Any], finishing: str | None) -> str | None:
    """Gives ``choices`` a preset's batches and rates where none were asked for; returns its finishing."""
    from irradia.field.presets import preset

    found = preset(name)
    learning = {
        "batch_size": found.batch_size,
        "lr_encoding": found.lr_encoding,
        "lr_network": found.lr_network,
    }
    choices.update({key: value for key, value in learning.items() if key not in given})
    return finishing or (f"int{found.bits}" if found.bits else None)


def describe(result: dict[str, Any]) -> str:
    """What came of a training."""
    shipped = result["validation"]
    flag = "  (below the samples' own noise)" if shipped["under_noise"] else ""
    lines = [
        f"{result['out']}: {result['bytes']:,} bytes, {result['parameters']:,} parameters",
        f"  {result['steps']:,} steps in {result['train_s']:.1f} s by {result['backend']}, "
        f"{result['samples_per_s'] / 1e6:.2f} M samples/s, ended by {result['ended_by']}",
        f"  loss {result['loss']:.4g}",
        f"  PSNR {shipped['psnr_db']:.2f} dB, relMSE {shipped['relmse']:.3e}, MAE {shipped['mae']:.4g}, "
        f"mean ratio {shipped['mean_ratio']:.4f}{flag}",
    ]
    if result["remark"]:
        lines.append(f"  note: {result['remark']}")
    blocks = result["held_out_blocks"]
    if blocks is not None:
        lines.append(f"  in held-out space: PSNR {blocks['psnr_db']:.2f} dB, relMSE {blocks['relmse']:.3e}")
    return "\n".join([*lines, f"  log {result['log']}, curves {result['curves']}"])
