"""What holds for every command: instant help, one JSON object, exit codes."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
import time

import click
import pytest

from irradia.cli import app
from irradia.core.errors import InputError, InternalError

HEAVY = ("mitsuba", "drjit", "numba", "scipy", "matplotlib", "xatlas", "pyoidn", "OpenEXR")


def _python(code: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=os.environ, check=False
    )


@pytest.fixture
def command_that(monkeypatch):
    """Replaces ``doctor`` by a command that does something else."""

    def install(body):
        @click.command("doctor")
        @click.option("--json", "as_json", is_flag=True)
        def replacement(as_json):
            return body()

        module = importlib.import_module("irradia.cli.doctor")
        monkeypatch.setattr(module, "command", replacement)

    return install


@pytest.mark.parametrize("name", ["", *app.COMMANDS])
def test_help_answers_within_half_a_second(name):
    def once() -> float:
        start = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-m", "irradia", *name.split(), "--help"], capture_output=True, check=False
        )
        assert done.returncode == 0, done.stderr
        assert b"Usage:" in done.stdout
        return time.perf_counter() - start

    assert min(once() for _ in range(3)) < 0.5


@pytest.mark.parametrize("name", list(app.COMMANDS))
def test_a_commands_module_loads_nothing_heavy(name):
    module = app.COMMANDS[name][0]
    done = _python(f"import sys, irradia.cli.{module}; print([m for m in {HEAVY} if m in sys.modules])")
    assert done.stdout.strip() == "[]", done.stderr


@pytest.mark.parametrize("name", list(app.COMMANDS))
def test_every_command_speaks_json(name):
    command = app.group.get_command(click.Context(app.group), name)
    assert "--json" in [flag for p in command.params for flag in p.opts]


@pytest.mark.parametrize("name", list(app.COMMANDS))
def test_the_list_says_what_the_commands_own_help_says(name):
    command = app.group.get_command(click.Context(app.group), name)
    assert command.get_short_help_str(limit=200).rstrip(".") == app.COMMANDS[name][1].rstrip(".")


def test_an_unknown_command_is_bad_input(capfd):
    assert app.run(["bkae"]) == 2
    assert "No such command 'bkae'" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("error", "code"), [(InputError("bad", where="/nodes/1", fix="mend it"), 2), (InternalError("broken"), 1)]
)
def test_our_errors_come_without_a_traceback(command_that, capfd, error, code):
    def body():
        raise error

    command_that(body)
    assert app.run(["doctor"]) == code
    shown = capfd.readouterr()
    assert shown.out == ""
    assert str(error) in shown.err
    assert "Traceback" not in shown.err


def test_a_defect_is_our_fault_and_shows_its_traceback(command_that, capfd):
    command_that(lambda: 1 // 0)
    assert app.run(["doctor"]) == 1
    shown = capfd.readouterr().err
    assert "ZeroDivisionError" in shown
    assert "please report" in shown


def test_ctrl_c_says_how_to_go_on(command_that, capfd):
    def body():
        raise KeyboardInterrupt

    command_that(body)
    assert app.run(["doctor"]) == app.INTERRUPTED
    assert "run again to go on" in capfd.readouterr().err


def test_an_interrupted_commands_json_says_so_however_it_ended(command_that, capfd):
    from irradia.cli.output import finish

    def at_once():
        raise KeyboardInterrupt

    for body in (at_once, lambda: finish(True, {"complete": False}, "", app.INTERRUPTED)):
        command_that(body)
        assert app.run(["doctor", "--json"]) == app.INTERRUPTED == 130
        said = json.loads(capfd.readouterr().out)
        assert (said["ok"], said["interrupted"]) == (False, True)


def test_json_is_one_object_whatever_libraries_print(command_that, capfd):
    def body():
        from irradia.cli.output import finish

        os.write(1, b"chatter of a C++ library\n")
        print("chatter of a Python library")
        finish(True, {"value": float("nan")}, "")

    command_that(body)
    assert app.run(["doctor", "--json"]) == 0
    shown = capfd.readouterr()
    assert json.loads(shown.out) == {"value": None, "ok": True, "interrupted": False}
    assert shown.err.count("chatter") == 2


def test_a_failure_is_one_json_object_too(command_that, capfd):
    def body():
        raise InputError("expected a mesh", where="/meshes/0", fix="add one")

    command_that(body)
    assert app.run(["doctor", "--json"]) == 2
    said = json.loads(capfd.readouterr().out)
    assert said["ok"] is False
    assert said["error"]["where"] == "/meshes/0"
    assert said["error"]["exit_code"] == 2


def test_a_usage_error_is_one_json_object_too(capfd):
    assert app.run(["doctor", "--json", "--no-such-option"]) == 2
    assert "--no-such-option" in json.loads(capfd.readouterr().out)["error"]["message"]


def test_json_takes_arrays_and_paths(capfd, tmp_path):
    import numpy as np

    from irradia.cli.output import write_json

    write_json({"a": np.float32(1.5), "b": np.array([1.0, np.inf]), "c": tmp_path})
    assert json.loads(capfd.readouterr().out) == {"a": 1.5, "b": [1.0, None], "c": str(tmp_path)}
