"""Options that commands share, each spelled and explained once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import click

F = TypeVar("F", bound=Callable[..., None])

MAX_SAMPLES = 1 << 20
MAX_RESOLUTION_PX = 16384
MAX_SEED = (1 << 32) - 1

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object on stdout and nothing else there."
)
seed_option = click.option(
    "--seed", type=click.IntRange(0, MAX_SEED), default=0, show_default=True, help="Root of all randomness."
)
device_option = click.option(
    "--device",
    type=click.Choice(["auto", "cpu", "cuda"]),
    default="auto",
    show_default=True,
    help="What traces the rays.",
)
threads_option = click.option(
    "--threads", type=click.IntRange(1, 1024), help="Threads of the CPU device.  [default: all]"
)


def lighting_options(function: F) -> F:
    """``--env`` and its companions: light from outside the file."""
    return _apply(
        function,
        click.option(
            "--env",
            type=click.Path(exists=True, dir_okay=False, path_type=Path),
            help="Environment image (.hdr, .exr), equirectangular.",
        ),
        click.option("--env-rotation", type=float, default=0.0, metavar="DEG", help="Turns it about +Y."),
        click.option("--env-strength", type=click.FloatRange(min=0.0), default=1.0, help="Multiplies it."),
        click.option("--env-color", metavar="R,G,B", help="Uniform environment: linear radiance."),
        click.option("--sky", is_flag=True, help="Sun and sky."),
        click.option(
            "--no-default-light", is_flag=True, help="Leave a scene without any light black, without --sky."
        ),
    )


def scene_options(function: F) -> F:
    """``--variant`` and ``--pose-time``: which state of the file is meant."""
    return _apply(
        function,
        click.option("--variant", metavar="NAME", help="KHR_materials_variants: which one."),
        click.option(
            "--pose-time",
            type=click.FloatRange(min=0.0),
            metavar="S",
            help="Bake skins and morphs in the pose at this time.",
        ),
    )


def parse_color(text: str) -> tuple[float, float, float]:
    """``R,G,B`` or one grey value, linear and not negative.

    Raises:
        click.BadParameter: On anything else.
    """
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) == 1:
        values *= 3
    if len(values) != 3 or not all(0.0 <= v < 1e9 for v in values):
        raise click.BadParameter(f"expected R,G,B, each at least 0, found {text!r}", param_hint="--env-color")
    return (values[0], values[1], values[2])


def _apply(function: F, *options: Callable[[F], F]) -> F:
    for option in reversed(options):
        function = option(function)
    return function
