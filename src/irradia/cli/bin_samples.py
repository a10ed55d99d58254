"""Options for what a ``.bin`` of samples doesn't say of itself."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from irradia.core.errors import InputError

if TYPE_CHECKING:
    from irradia.formats.samples_bin import BinOptions

F = TypeVar("F", bound=Callable[..., Any])

NAMES = ("--coefficients", "--quantity")


def bin_sample_options(command: F) -> F:
    """Adds ``--coefficients`` and ``--quantity``, both None where they aren't given."""
    for option in (
        click.option(
            "--quantity",
            type=click.Choice(["full", "indirect"]),
            help="What light samples in a .bin are.  [default: full]",
        ),
        click.option(
            "--coefficients",
            type=click.Choice(["radiance", "irradiance"]),
            help="What SH samples in a .bin are of.  [default: radiance]",
        ),
    ):
        command = option(command)
    return command


def bin_options(coefficients: str | None, quantity: str | None, *paths: Path | None) -> BinOptions:
    """How to read datasets that are a ``.bin``.

    Args:
        coefficients: As given on the command line.
        quantity: Likewise.
        paths: The datasets that will be read.

    Raises:
        InputError: Something was said of a .bin, but there is none.
    """
    from irradia.formats.samples_bin import BinOptions

    given = {"--coefficients": coefficients, "--quantity": quantity}
    if not any(path is not None and path.suffix.lower() == ".bin" for path in paths):
        for name, value in given.items():
            if value is not None:
                raise InputError("goes with samples in a .bin; a .samples says this itself", where=name)
    return BinOptions(coefficients or "radiance", quantity or "full")  # type: ignore[arg-type]
