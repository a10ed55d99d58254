"""The group ``irradia``: commands are imported when they run, so that ``--help`` stays instant."""

from __future__ import annotations

import contextlib
import importlib
import os
import sys
import traceback
from collections.abc import Sequence
from typing import NoReturn

import click

from irradia import __version__
from irradia.cli.output import INTERRUPTED, outcome, reserve_stdout, write_json
from irradia.core.errors import InputError, IrradiaError
from irradia.core.files import disk_problem, place_problem

_INTERRUPTED = "stopped; files already finished are whole, run again to go on"

# Name: module below irradia.cli, one line for the list. The module holds ``command``.
COMMANDS: dict[str, tuple[str, str]] = {
    "doctor": ("doctor", "What this machine can run, and how to mend what it can't."),
    "demo": ("demo", "Bake a scene of our own and train a field from it, with report."),
    "info": ("info", "What is in a scene and what the bake will do with it."),
    "bake": ("bake", "Bake a scene's lightmaps, with baked .glb and report."),
    "merge": ("merge", "Join the shards of one bake."),
    "sample": ("sample", "Sample a scene's light, for a field to learn from."),
    "train": ("train", "Train a neural field from a dataset."),
    "render": ("render", "Path-trace an image of a scene or of a baked result."),
    "sweep": ("sweep", "Train a grid of fields and compare them."),
    "eval": ("eval", "A field against the path-traced reference."),
    "export": (
        "export",
        "Write a field in another format, smaller, or into a baked scene; or a scene for the web.",
    ),
    "view": ("view", "Show baked light in the browser."),
    "gallery": ("gallery", "Show every field of a folder from the same camera, side by side."),
    "compare": ("compare", "Metrics between two images or lightmaps."),
}


class LazyGroup(click.Group):
    """A group whose commands are modules, imported on first use."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The commands in the order in which one meets them."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Imports the module of one command."""
        if cmd_name not in COMMANDS:
            return None
        return importlib.import_module(f"irradia.cli.{COMMANDS[cmd_name][0]}").command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Lists the commands without importing any."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, line) for name, (_, line) in COMMANDS.items()])


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="irradia")
def group() -> None:
    """Bakes the light of a glTF scene, and proves it right."""


def main() -> NoReturn:
    """The entry point of the program."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: Sequence[str]) -> int:
    """Runs one command line and returns its exit code: 0 done, 2 bad input, 1 our fault.

    With ``--json`` exactly one JSON object reaches stdout, on failure too; whatever libraries
    print goes to stderr.
    """
    if "--json" not in arguments:
        return _run(arguments, wants_json=False)
    with reserve_stdout():
        return _run(arguments, wants_json=True)


def _run(arguments: Sequence[str], *, wants_json: bool) -> int:
    try:
        code = group.main(list(arguments), prog_name="irradia", standalone_mode=False)
    except click.Abort:
        return _fail(wants_json, _INTERRUPTED, INTERRUPTED)
    except click.ClickException as error:
        return _fail(wants_json, _usage(error), error.exit_code)
    except IrradiaError as error:
        return _fail(wants_json, str(error), error.exit_code, getattr(error, "where", None))
    except MemoryError:
        return _fail(wants_json, "not enough memory; a smaller --resolution needs less", InputError.exit_code)
    except OSError as error:
        _let_go_of_text()
        problem = disk_problem(error) or place_problem(error)
        if problem is None:
            return _our_fault(wants_json, error)
        return _fail(wants_json, str(problem), problem.exit_code, problem.where)
    except Exception as error:  # noqa: BLE001 - the last line of defence: report it as our fault
        if _comes_from_ctrl_c(error):
            return _fail(wants_json, _INTERRUPTED, INTERRUPTED)
        return _our_fault(wants_json, error)
    return code if isinstance(code, int) else 0


def _let_go_of_text() -> None:
    """Drops what stdout doesn't take: Python would try once more at its end, and exit with 120."""
    try:
        sys.stdout.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def _comes_from_ctrl_c(error: BaseException) -> bool:
    """Dr.Jit wraps what is raised while it traces a loop."""
    cause: BaseException | None = error
    while cause is not None and not isinstance(cause, KeyboardInterrupt):
        cause = cause.__cause__ or cause.__context__
    return cause is not None


def _usage(error: click.ClickException) -> str:
    """A usage error's message with a way to the help."""
    context = getattr(error, "ctx", None)
    path = context.command_path if context else "irradia"
    return f"{error.format_message()}\n  See: {path} --help"


def _our_fault(wants_json: bool, error: Exception) -> int:
    traceback.print_exc(file=sys.stderr)
    return _fail(wants_json, f"a defect of Irradia, please report it: {error!r}", 1)


def _fail(wants_json: bool, message: str, code: int, where: str | None = None) -> int:
    click.echo(f"irradia: {message}", err=True)
    if wants_json:
        with contextlib.suppress(OSError):  # where stdout is what is full
            error = {"message": message, "where": where, "exit_code": code}
            write_json({**outcome(code), "error": error})
    return code
