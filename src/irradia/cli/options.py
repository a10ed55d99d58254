"""Options that commands share, each spelled and explained once."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from irradia.cli.lighting import LightOptions

F = TypeVar("F", bound=Callable[..., Any])

MAX_SAMPLES = 1 << 20
DEFAULT_SAMPLES = 64
MIN_RESOLUTION_PX = 16
MAX_RESOLUTION_PX = 16384
MAX_SEED = (1 << 32) - 1


class Finite(click.FloatRange):
    """A number in a range; click's own range lets NaN and infinity through."""

    name = "number"

    def convert(self, value: str | float, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number, or a usage error."""
        number = float(super().convert(value, param, ctx))  # type: ignore[arg-type]
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return number


class ShardPart(click.ParamType):
    """``I/N``: the I-th of N parts."""

    name = "I/N"

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """(I, N), or a usage error."""
        number, slash, count = value.partition("/")
        if not (slash and number.isdecimal() and count.isdecimal() and 1 <= int(number) <= int(count)):
            self.fail(f"expected I/N with I from 1 to N, found {value!r}", param, ctx)
        return int(number), int(count)


SHARD = ShardPart()
ANY = Finite()
NOT_NEGATIVE = Finite(min=0.0)
POSITIVE = Finite(min=0.0, min_open=True)

# The parameters of lighting_options, as click names them.
LIGHT_NAMES = ("env", "env_rotation", "env_strength", "env_color", "sky", "no_default_light")

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


reference_spp_option = click.option(
    "--reference-spp",
    type=click.IntRange(2, MAX_SAMPLES),
    default=128,
    show_default=True,
    help="Samples per pixel of the report's reference.",
)


def budget_options(function: F) -> F:
    """``--samples``, ``--time``, ``--noise``: when a bake is done, and where its rays go."""
    return _apply(
        function,
        click.option(
            "--samples",
            type=click.IntRange(1, MAX_SAMPLES),
            help=f"Gather rays per texel.  [default: {DEFAULT_SAMPLES}, without --time and --noise]",
        ),
        click.option("--time", "time_s", type=POSITIVE, metavar="S", help="Stop tracing after this long."),
        click.option(
            "--noise",
            type=POSITIVE,
            metavar="X",
            help="Stop when 95 % of the texels have a relative standard error below X.",
        ),
        click.option("--adaptive", is_flag=True, help="Send rays where the noise is; --noise always does."),
        click.option(
            "--indirect-clamp",
            type=POSITIVE,
            metavar="X",
            help="Cut what a ray may bring, against fireflies; the loss is reported.",
        ),
    )


def map_options(function: F) -> F:
    """Which maps, in which formats, and what goes into them beside the scene's file."""
    return _apply(
        function,
        click.option(
            "--directional",
            type=click.Choice(["dominant", "rnm", "sh", "mono-sh"]),
            help="Maps of the light's direction as well, for normal maps.",
        ),
        click.option("--normal-maps", is_flag=True, help="Receive light on normal-mapped normals."),
        click.option("--no-seams", is_flag=True, help="Leave seams between charts as they are."),
        click.option(
            "--probes", metavar="HOW", help="Light probes as well: grid:METRES, random:COUNT or auto."
        ),
        click.option(
            "--probe-samples",
            type=click.IntRange(1, MAX_SAMPLES),
            default=1024,
            show_default=True,
            help="Rays per probe.",
        ),
        click.option(
            "--format",
            "formats",
            default="exr",
            show_default=True,
            metavar="LIST",
            help="Of the maps, separated by commas: exr, hdr, rgbm, ktx2-half … (docs/formats.md).",
        ),
        click.option(
            "--material-override",
            multiple=True,
            metavar="FILE|NAME:CHANNEL=VALUE",
            help="Albedo, emission or opacity of materials whose shader isn't glTF's.",
        ),
        click.option(
            "--ies",
            multiple=True,
            metavar="[LIGHT=]FILE",
            help="Measured light of one lamp, or of all.",
        ),
    )


def sample_limit(samples: int | None, time_s: float | None, noise: float | None) -> int | None:
    """The number of samples that was asked for, or that is meant where no limit was given at all."""
    return DEFAULT_SAMPLES if samples is None and time_s is None and noise is None else samples


def lighting_options(function: F) -> F:
    """``--env`` and its companions: light from outside the file."""
    return _apply(
        function,
        click.option(
            "--env",
            type=click.Path(exists=True, dir_okay=False, path_type=Path),
            help="Environment image (.hdr, .exr), equirectangular.",
        ),
        click.option("--env-rotation", type=ANY, default=0.0, metavar="DEG", help="Turns it about +Y."),
        click.option("--env-strength", type=NOT_NEGATIVE, default=1.0, help="Multiplies it."),
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
            type=NOT_NEGATIVE,
            metavar="S",
            help="Bake skins and morphs in the pose at this time.",
        ),
    )


def light_options(
    *,
    env: Path | None,
    env_rotation: float,
    env_strength: float,
    env_color: str | None,
    sky: bool,
    no_default_light: bool,
) -> LightOptions:
    """What :func:`lighting_options` gave, checked."""
    from irradia.cli.lighting import LightOptions

    return LightOptions(
        env=env,
        env_rotation_deg=env_rotation,
        env_strength=env_strength,
        env_color=None if env_color is None else parse_color(env_color),
        sky=sky,
        default_light=not no_default_light,
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
