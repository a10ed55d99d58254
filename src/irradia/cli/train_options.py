"""The options of ``irradia train``, in the words of the Unity project's trainer where it has them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from irradia.cli import options
from irradia.cli.bin_samples import bin_sample_options

F = TypeVar("F", bound=Callable[..., Any])

_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)
_COUNT = options.Whole(1, 1 << 30)


def results_options(function: F) -> F:
    """Where the field goes, and as what."""
    return options.together(
        function,
        click.option(
            "-o",
            "--out",
            type=click.Path(dir_okay=False, path_type=Path),
            help="The field: .safetensors, .safetensors.zst or .bin.",
        ),
        click.option(
            "--finish",
            "finishing",
            type=click.Choice(["int8", "int4"]),
            help="Quantise the tables, and train the decoder on for them.",
        ),
        click.option(
            "--precision",
            type=click.Choice(["fp16", "fp32"]),
            default="fp16",
            show_default=True,
            help="Of what isn't quantised.",
        ),
        click.option(
            "--print-spec",
            is_flag=True,
            help="Print the field as the JSON that --spec reads, and train nothing.",
        ),
    )


def field_options(function: F) -> F:
    """Which field; names and defaults are those of the Unity project's trainer where it has any."""
    return options.together(
        function,
        click.option(
            "--preset",
            metavar="NAME",
            help="A field of about a size with rates and finishing to match, such as hash-200kB.",
        ),
        click.option(
            "--encoding",
            type=click.Choice(["hash", "triplane", "frequency"]),
            default="hash",
            show_default=True,
            help="Of positions.",
        ),
        click.option(
            "--sh-mode", is_flag=True, help="The field gives SH coefficients; samples of SH imply it."
        ),
        click.option("--hidden-dim", type=options.Whole(1, 128), default=64, show_default=True, metavar="N"),
        click.option("--hidden-layers", type=options.Whole(1, 6), default=2, show_default=True, metavar="N"),
        click.option(
            "--activation",
            type=options.Spelled(["relu", "leaky_relu", "silu", "gelu", "sine"]),
            default="relu",
            show_default=True,
            metavar="NAME",
            help="Of hidden layers: relu, leaky_relu, silu, gelu or sine.",
        ),
        click.option(
            "--head",
            type=click.Choice(["exp", "softplus", "linear"]),
            metavar="NAME",
            help="Of outputs: exp, softplus or linear.  [default: exp; linear for SH]",
        ),
        click.option(
            "--direction",
            default="identity",
            show_default=True,
            metavar="NAME[:SIZE]",
            help="Encoding of normals: identity, sh, one_blob or frequency, such as sh:4.",
        ),
        click.option("--n-levels", type=options.Whole(1, 32), default=16, show_default=True, metavar="N"),
        click.option(
            "--n-features",
            type=options.Whole(1, 16),
            default=2,
            show_default=True,
            metavar="N",
            help="Of each entry of a hash level.",
        ),
        click.option(
            "--log2-hashmap-size",
            type=options.Whole(3, 28),
            default=19,
            show_default=True,
            metavar="N",
            help="Entries of a hash level at most, as a power of two.",
        ),
        click.option("--base-resolution", type=_COUNT, default=16, show_default=True, metavar="N"),
        click.option("--max-resolution", type=_COUNT, default=2048, show_default=True, metavar="N"),
        click.option(
            "--plane-res",
            type=options.Whole(2, 8192),
            default=128,
            show_default=True,
            metavar="N",
            help="Of each side of a triplane.",
        ),
        click.option(
            "--features-per-plane", type=options.Whole(1, 128), default=16, show_default=True, metavar="N"
        ),
        click.option(
            "--n-frequencies", type=options.Whole(1, 24), default=10, show_default=True, metavar="N"
        ),
        click.option("--include-identity", is_flag=True, help="frequency: the coordinates are features too."),
        click.option(
            "--spec",
            "spec_file",
            type=_FILE,
            metavar="FILE",
            help="All of the field, as JSON, instead of the above.",
        ),
    )


def learning_options(function: F) -> F:
    """How it learns, and for how long."""
    return options.together(
        function,
        click.option("--steps", type=_COUNT, metavar="N", help="[default: 5000, unless --time is given]"),
        click.option(
            "--time",
            "time_s",
            type=options.POSITIVE,
            metavar="S",
            help="Train this long, with rates to match.",
        ),
        click.option(
            "--batch-size", type=options.Whole(1, 1 << 24), default=65_536, show_default=True, metavar="N"
        ),
        click.option(
            "--loss",
            type=options.Spelled(["relative_l2", "relative_l2_luminance", "l2", "log"]),
            default="relative_l2",
            show_default=True,
            metavar="NAME",
            help="relative_l2, relative_l2_luminance, l2 or log.",
        ),
        click.option(
            "--lr-encoding",
            type=options.NOT_NEGATIVE,
            default=0.01,
            show_default=True,
            metavar="X",
            help="At first.",
        ),
        click.option(
            "--lr-network",
            type=options.NOT_NEGATIVE,
            default=0.001,
            show_default=True,
            metavar="X",
            help="At first.",
        ),
        click.option(
            "--lr-final",
            type=options.POSITIVE,
            default=0.1,
            show_default=True,
            metavar="X",
            help="Share of both that is left at the end.",
        ),
        click.option(
            "--average",
            type=options.NOT_NEGATIVE,
            default=0.99,
            show_default=True,
            metavar="X",
            help="Decay of the running mean of weights that the field is made of; 0 takes the last ones.",
        ),
        click.option(
            "--early-stop",
            type=_COUNT,
            metavar="N",
            help="End after N validations without a better relMSE, and keep the best.",
        ),
    )


def sample_options(function: F) -> F:
    """What is made of the samples on the way."""
    return options.together(
        function,
        click.option("--jitter-copies", type=options.Whole(0, 64), default=0, show_default=True, metavar="N"),
        click.option("--jitter-radius", type=options.POSITIVE, default=0.05, show_default=True, metavar="M"),
        click.option(
            "--jitter-scene", metavar="SCENE", help="Ask its surfaces whether copies see their samples."
        ),
        click.option(
            "--smooth-k",
            type=options.Whole(0, 256),
            default=0,
            show_default=True,
            metavar="N",
            help="Replace values by means over the N nearest samples.",
        ),
        click.option(
            "--smooth-normal-thresh",
            type=options.Finite(-1.0),
            default=0.5,
            show_default=True,
            metavar="X",
            help="Of those whose normals have at least this cosine.",
        ),
        click.option(
            "--memory",
            "memory_mib",
            type=_COUNT,
            default=1024,
            show_default=True,
            metavar="MIB",
            help="For samples; larger files are read in shuffled windows.",
        ),
        bin_sample_options,
        click.option("--follow", is_flag=True, help="Wait for DATA to appear."),
    )


def validation_options(function: F) -> F:
    """What it is judged by."""
    return options.together(
        function,
        click.option(
            "--validation",
            type=_FILE,
            metavar="FILE",
            help="Samples to judge by.  [default: DATA's own, else 2 %]",
        ),
        click.option(
            "--validate-every",
            type=_COUNT,
            metavar="N",
            help="Steps between validations.  [default: a twentieth]",
        ),
        click.option(
            "--hold-out-blocks",
            type=options.NOT_NEGATIVE,
            default=0.0,
            show_default=True,
            metavar="X",
            help="Share of space kept from training, to see how well the field fills gaps.",
        ),
    )


def machine_options(function: F) -> F:
    """How it goes on, and what computes it."""
    return options.together(
        function,
        click.option("--resume", is_flag=True, help="Go on with the training that was stopped here."),
        options.checkpoint_option("--checkpoint-s"),
        click.option(
            "--backend",
            type=click.Choice(["auto", "numpy", "numba", "drjit"]),
            default="auto",
            show_default=True,
            metavar="NAME",
            help="auto, numpy, numba or drjit.",
        ),
    )
