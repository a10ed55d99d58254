"""What help, errors and files call a thing is one spelling."""

from __future__ import annotations

import re
from pathlib import Path

import click
import pytest

import irradia
from irradia.cli import app
from irradia.field.registry import print_spec, read_spec

_NAMED = r'(?:where=|, )"(--[a-z0-9_-]+)[^"]*"\)'  # at the end of a call
SOURCES = Path(irradia.__file__).parent


def commands() -> dict[str, click.Command]:
    context = click.Context(app.group)
    found = {name: app.group.get_command(context, name) for name in app.COMMANDS}
    return {name: command for name, command in found.items() if command is not None}


def options() -> set[str]:
    return {flag for command in commands().values() for param in command.params for flag in param.opts}


def test_errors_name_options_that_exist():
    named = {
        (option, path.name)
        for path in SOURCES.rglob("*.py")
        for option in re.findall(_NAMED, path.read_text(encoding="utf-8"))
    }
    assert len(named) > 30
    assert {(option, path) for option, path in named if option not in options()} == set()


def test_no_option_is_spelt_with_an_underscore():
    assert [option for option in options() if "_" in option] == []


@pytest.mark.parametrize("name", ["--loss", "--activation", "--head", "--encoding", "--backend"])
def test_a_choice_is_refused_in_the_words_of_the_help(name, capfd):
    train = commands()["train"]
    option = next(param for param in train.params if name in param.opts)
    assert isinstance(option.type, click.Choice)
    assert app.run(["train", "x.samples", "-o", "a.safetensors", name, "no-such"]) == 2
    said = capfd.readouterr().err
    assert all(f"'{choice}'" in said for choice in option.type.choices)
    if option.metavar:
        assert all(choice in (option.help or "") for choice in option.type.choices)


@pytest.mark.parametrize("spelt", ["leaky_relu", "leaky-relu"])
def test_hyphens_are_taken_for_underscores_in_choices_as_in_options(spelt, capfd):
    for flag in ("--hidden-dim", "--hidden_dim"):
        assert app.run(["train", "--print-spec", "--activation", spelt, flag, "32"]) == 0
        spec = read_spec(capfd.readouterr().out)
        assert (spec.activation, spec.width) == ("leaky_relu", 32)


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--smooth-normal-thresh", "5"),
        ("--hold-out-blocks", "0.9"),
        ("--lr-final", "1.5"),
        ("--average", "1"),
    ],
)
def test_a_number_out_of_range_is_refused_by_its_options_name(option, value, capfd):
    assert app.run(["train", "x.samples", "-o", "a.safetensors", option, value]) == 2
    assert option in capfd.readouterr().err


def test_the_printed_spec_is_the_file_that_makes_the_same_field(tmp_path, capfd):
    asked = ["--encoding", "triplane", "--plane-res", "64", "--hidden-layers", "3", "--direction", "sh:3"]
    assert app.run(["train", "--print-spec", *asked]) == 0
    printed = capfd.readouterr().out
    (tmp_path / "spec.json").write_text(printed, encoding="utf-8")
    assert app.run(["train", "--print-spec", "--spec", str(tmp_path / "spec.json")]) == 0
    assert capfd.readouterr().out == printed == print_spec(read_spec(printed))
    assert list(tmp_path.iterdir()) == [tmp_path / "spec.json"]


def test_a_printed_spec_of_sh_gives_coefficients(capfd):
    assert app.run(["train", "--print-spec", "--sh-mode"]) == 0
    spec = read_spec(capfd.readouterr().out)
    assert (spec.mode, spec.head, spec.direction) == ("sh1", "linear", None)


def test_a_training_says_that_it_wants_a_place_for_its_field(capfd):
    assert app.run(["train", "x.samples"]) == 2
    assert "'--out'" in capfd.readouterr().err
