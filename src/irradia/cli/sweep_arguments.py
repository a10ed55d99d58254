"""Whether `irradia train` will take what a grid says, asked before anything is trained."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from irradia.cli.sweep_grid import SweepRun
from irradia.cli.train import command, job_of
from irradia.core.errors import InputError


def check_arguments(runs: Sequence[SweepRun], data: Path, where: str) -> None:
    """Reads every run's arguments as `irradia train` would.

    Args:
        runs: Of the grid.
        data: Samples.
        where: The grid's name, for errors.

    Raises:
        InputError: It says which run has a bad value.
    """
    for run in runs:
        words = [str(data), "-o", "field.safetensors", *run.arguments]
        try:
            with command.make_context("train", words) as context:
                job_of(context)
        except click.ClickException as error:
            raise InputError(error.format_message(), where=f"{where}, run {run.name}") from error
        except InputError as error:
            raise InputError(error.message, where=f"{where}, run {run.name}", fix=error.fix) from error
