"""Options and their limits."""

from __future__ import annotations

import click
import pytest

from irradia.cli import app, options


@pytest.mark.parametrize(("text", "color"), [("0.5", (0.5, 0.5, 0.5)), ("1,0.5,0", (1.0, 0.5, 0.0))])
def test_a_colour_is_one_number_or_three(text, color):
    assert options.parse_color(text) == color


@pytest.mark.parametrize("text", ["", "red", "1,2", "1,2,3,4", "-1,0,0", "nan,0,0", "inf"])
def test_anything_else_is_no_colour(text):
    with pytest.raises(click.BadParameter, match="expected R,G,B"):
        options.parse_color(text)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--samples", "0"],
        ["--samples", "1e9"],
        ["--samples", "2000000"],
        ["--resolution", "0"],
        ["--resolution", "-1"],
        ["--resolution", "1000000"],
        ["--texels-per-metre", "0"],
        ["--texels-per-metre", "nan"],
        ["--texels-per-metre", "inf"],
        ["--env-strength", "-1"],
        ["--env-strength", "nan"],
        ["--env-rotation", "inf"],
        ["--pose-time", "nan"],
        ["--seed", "-1"],
        ["--seed", "4294967296"],
        ["--threads", "0"],
        ["--device", "toaster"],
        ["--integrator", "magic"],
        ["--env", "no-such-file.hdr"],
        ["--env-color", "red"],
        ["--sky", "--env-color", "1"],
        ["--resolution", "64", "--texels-per-metre", "5"],
    ],
)
def test_absurd_values_are_bad_input_and_leave_nothing(arguments, tmp_path, capfd):
    out = tmp_path / "out"
    assert app.run(["bake", "builtin:cornell", "-o", str(out), *arguments]) == 2
    assert capfd.readouterr().err.startswith("irradia: ")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("scene", ["builtin:atrum", "no-such-file.glb", "."])
def test_a_scene_that_is_not_there_is_bad_input_and_leaves_nothing(scene, tmp_path, capfd):
    assert app.run(["bake", scene, "-o", str(tmp_path / "out")]) == 2
    assert scene.removeprefix("builtin:") in capfd.readouterr().err
    assert list(tmp_path.iterdir()) == []
