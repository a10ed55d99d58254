"""``irradia train``: a neural field from a dataset."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from irradia.cli import options, train_options
from irradia.cli.bin_samples import bin_options
from irradia.cli.output import code_of, finish
from irradia.cli.sections import SectionedCommand

if TYPE_CHECKING:
    from irradia.cli.train_job import TrainJob
    from irradia.field.training.options import TrainOptions

SECTIONS = {
    "Results": ("--out", "--finish", "--precision", "--print-spec", "--json"),
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


@click.command(
    "train",
    cls=SectionedCommand,
    sections=SECTIONS,
    # The Unity project's trainer writes some of its names with underscores.
    context_settings={"token_normalize_func": lambda name: name.replace("_", "-")},
)
@click.argument("data", required=False, type=click.Path(dir_okay=False, path_type=Path))
@click.option("-i", "--input", "data_flag", type=click.Path(dir_okay=False, path_type=Path), help="DATA.")
@train_options.results_options
@train_options.field_options
@train_options.learning_options
@train_options.sample_options
@train_options.validation_options
@train_options.machine_options
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

    if ctx.params["print_spec"]:
        return _print_spec(ctx, as_json)
    job = job_of(ctx)
    from irradia.cli.train_run import run_training

    result = run_training(job, stderr_progress())
    return finish(as_json, result, describe(result), code_of(result["complete"]))


def job_of(ctx: click.Context) -> TrainJob:
    """The job that a command line, as parsed, asks for; see :func:`make_job`."""
    choices = {name: value for name, value in ctx.params.items() if name != "as_json"}
    return make_job(_given(ctx), **choices)


def _given(ctx: click.Context) -> set[str]:
    """Names of the parameters that were not left to their defaults."""
    return {name for name in ctx.params if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE}


def _print_spec(ctx: click.Context, as_json: bool) -> int:
    """Prints the field that would be trained; without samples one of irradiance, or of SH to L1."""
    from irradia.cli.train_spec import SpecChoices
    from irradia.field.registry import print_spec, spec_to_dict
    from irradia.formats.samples import SampleInfo, open_samples

    chosen = ctx.params
    _one_word_on_the_field(_given(ctx))
    names = (*SPEC_NAMES, "spec_file", "preset", "sh_mode")
    data, box = chosen["data"] or chosen["data_flag"], ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    if data is not None:
        info = open_samples(data, bin_options(chosen["coefficients"], chosen["quantity"], data)).info
    else:
        info = SampleInfo("sh", box, n_coefficients=4) if chosen["sh_mode"] else SampleInfo("volume", box)
    spec = SpecChoices(**{name: chosen[name] for name in names}).spec(info)
    return finish(as_json, {"spec": spec_to_dict(spec)}, print_spec(spec).rstrip())


def make_job(
    given: set[str],
    *,
    data: Path | None,
    data_flag: Path | None,
    out: Path | None,
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

    choices.pop("print_spec", None)
    if (data is None) == (data_flag is None):
        raise click.UsageError("Give the samples once: as DATA, or by -i.")
    if out is None:
        raise click.UsageError("Missing option '-o' / '--out'.")
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
