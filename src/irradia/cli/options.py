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


class Finite(click.ParamType):
    """A number in a range, neither infinite nor NaN.

    click's own ranges let both through, and write the range into the help.
    """

    name = "number"

    def __init__(self, low: float = -math.inf, *, low_open: bool = False) -> None:
        self._low, self._low_open = low, low_open

    def convert(self, value: str | float, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number, or a usage error."""
        try:
            number = float(value)
        except ValueError:
            self.fail(f"{value!r} is not a number.", param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        if number < self._low or (self._low_open and number == self._low):
            self.fail(f"expected {'over' if self._low_open else 'at least'} {self._low:g}, found {value}.")
        return number


class Whole(click.ParamType):
    """A whole number in a range that the help needn't show."""

    name = "number"

    def __init__(self, low: int, high: int) -> None:
        self._low, self._high = low, high

    def convert(self, value: str | int, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """The number, or a usage error."""
        try:
            number = int(value)
        except ValueError:
            self.fail(f"{value!r} is not a whole number.", param, ctx)
        if not self._low <= number <= self._high:
            self.fail(f"expected {self._low} to {self._high}, found {number}.", param, ctx)
        return number


class Spelled(click.Choice):
    """Choices that are said as files spell them, with underscores, and taken with hyphens too.

    click would say them as it normalises the names of options.
    """

    def normalize_choice(self, choice: object, ctx: click.Context | None) -> str:
        """The choice with underscores."""
        return str(choice).replace("-", "_")


class Reach(Finite):
    """A positive distance; infinity is one."""

    def convert(self, value: str | float, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The distance, or a usage error."""
        return math.inf if value in ("inf", math.inf) else super().convert(value, param, ctx)


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
NOT_NEGATIVE = Finite(0.0)
POSITIVE = Finite(0.0, low_open=True)
REACH = Reach(0.0, low_open=True)

# The parameters of lighting_options, as click names them.
LIGHT_NAMES = ("env", "env_rotation", "env_strength", "env_color", "sky", "no_default_light")

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object on stdout and nothing else there."
)
seed_option = click.option(
    "--seed",
    type=Whole(0, MAX_SEED),
    default=0,
    show_default=True,
    metavar="N",
    help="Root of all randomness.",
)
device_option = click.option(
    "--device",
    type=click.Choice(["auto", "cpu", "cuda"]),
    default="auto",
    show_default=True,
    help="What traces the rays.",
)
threads_option = click.option(
    "--threads", type=Whole(1, 1024), metavar="N", help="Threads of the CPU device.  [default: all]"
)


reference_spp_option = click.option(
    "--reference-spp",
    type=Whole(2, MAX_SAMPLES),
    metavar="N",
    default=128,
    show_default=True,
    help="Samples per pixel of the report's reference.",
)


def checkpoint_option(*names: str) -> Callable[[F], F]:
    """``--checkpoint``, under further names if wished."""
    return click.option(
        "--checkpoint",
        *names,
        "checkpoint_s",
        type=POSITIVE,
        default=60.0,
        show_default=True,
        metavar="S",
        help="How often to save what --resume needs.",
    )


def budget_options(function: F) -> F:
    """``--samples``, ``--time``, ``--noise``: when a bake is done, and where its rays go."""
    return together(
        function,
        click.option(
            "--samples",
            type=Whole(1, MAX_SAMPLES),
            metavar="N",
            help=f"Rays per texel.  [default: {DEFAULT_SAMPLES}, unless --time or --noise is given]",
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
            help="Cut what a ray may bring to X, against fireflies; the light lost is reported.",
        ),
    )


def map_options(function: F) -> F:
    """Which maps, in which formats, and what goes into them beside the scene's file."""
    return together(
        function,
        click.option(
            "--directional",
            type=click.Choice(["dominant", "rnm", "sh", "mono-sh"]),
            metavar="MODE",
            help="Maps of the light's direction as well, for normal maps: dominant, rnm, sh or mono-sh.",
        ),
        click.option(
            "--direct-map",
            is_flag=True,
            help="A map of the first bounce of punctual lights as well, for fields of indirect light.",
        ),
        click.option("--normal-maps", is_flag=True, help="Receive light on normal-mapped normals."),
        click.option("--no-seams", is_flag=True, help="Leave seams between charts as they are."),
        click.option(
            "--probes", metavar="HOW", help="Light probes as well: grid:METRES, random:COUNT or auto."
        ),
        click.option(
            "--probe-samples",
            type=Whole(1, MAX_SAMPLES),
            metavar="N",
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
            help="Of the maps: exr, exr-half, hdr, rgbm, rgbm-linear, ktx2-half, ktx2-rgb9e5, ktx2-bc6h; "
            "several with commas, or all.",
        ),
    )


def override_options(function: F) -> F:
    """What is known of the scene better than its file says: materials, and lamps as measured."""
    return together(
        function,
        click.option(
            "--material-override",
            multiple=True,
            metavar="SPEC",
            help="FILE.json or NAME:CHANNEL=VALUE: albedo, emission or opacity of materials whose shader "
            "isn't glTF's.",
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
    return together(
        function,
        click.option(
            "--env",
            type=click.Path(exists=True, dir_okay=False, path_type=Path),
            help="Environment image (.hdr, .exr), equirectangular.",
        ),
        click.option("--env-rotation", type=ANY, default=0.0, metavar="DEG", help="Turns it about +Y."),
        click.option("--env-strength", type=NOT_NEGATIVE, default=1.0, metavar="X", help="Multiplies it."),
        click.option("--env-color", metavar="R,G,B", help="Uniform environment: linear radiance."),
        click.option("--sky", is_flag=True, help="Sun and sky."),
        click.option(
            "--no-default-light", is_flag=True, help="Leave a scene without any light black, without --sky."
        ),
    )


def scene_options(function: F) -> F:
    """``--variant`` and ``--pose-time``: which state of the file is meant."""
    return together(
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


def together(function: F, *options: Callable[[F], F]) -> F:
    """Gives a command several options, in the order of its help."""
    for option in reversed(options):
        function = option(function)
    return function
