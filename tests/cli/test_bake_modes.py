"""Which light is baked, until when, and what can't be asked for together."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from PIL import Image

from irradia.cli import app
from irradia.cli.bake_checks import CONFLICTS
from irradia.formats.lightmap import read_lightmap
from irradia.scene.gltf.read import read_document

from .workshop import bake, write_workshop

_RAW = ["--no-denoise", "--no-seams"]
_GIVEN = {
    "--mode ao": ["--mode", "ao"],
    "--mode direct": ["--mode", "direct"],
    "--mode indirect": ["--mode", "indirect"],
    "--integrator path": ["--integrator", "path"],
    "--time": ["--time", "1"],
    "--noise": ["--noise", "0.1"],
    "--indirect-clamp": ["--indirect-clamp", "1"],
    "--view-first": ["--view-first", "auto"],
    "--directional": ["--directional", "sh"],
    "--probes": ["--probes", "auto"],
    "--only": ["--only", "box"],
    "--shard": ["--shard", "1/2"],
}
_PAIRS = [(c.option, other) for c in CONFLICTS for other in c.others if other != "--resume"]


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return write_workshop(tmp_path_factory.mktemp("scene") / "workshop.gltf")


@pytest.fixture(scope="module")
def openness(scene, tmp_path_factory):
    out = tmp_path_factory.mktemp("ao") / "out"
    return out, bake(scene, out, "--mode", "ao", "--ao-distance", "inf", "--samples", "64")


def _mean(folder):
    lightmap = read_lightmap(folder / "lightmap.exr")
    return lightmap.pages[lightmap.covered].mean()


def test_full_light_is_direct_and_indirect_light(scene, tmp_path):
    means = {}
    for mode in ("full", "direct", "indirect"):
        record = bake(scene, tmp_path / mode, "--mode", mode, "--samples", "128", *_RAW)
        assert record["stats"]["mode"] == mode
        means[mode] = _mean(tmp_path / mode)
    assert 0.02 < means["indirect"] / means["full"] < 0.5
    assert means["direct"] + means["indirect"] == pytest.approx(means["full"], rel=0.01)


def test_occlusion_stands_in_its_own_files_with_its_own_quantity(openness):
    out, record = openness
    assert {path.name for path in out.iterdir()} == {
        "bake.json",
        "occlusion.exr",
        "occlusion.png",
        "scene.baked.glb",
    }
    occlusion = read_lightmap(out / "occlusion.exr")
    assert occlusion.quantity == record["lightmap"]["quantity"] == "ambient_occlusion"
    inside = occlusion.pages[occlusion.covered]
    assert inside.min() >= 0.0
    assert inside.max() <= 1.0
    assert inside.mean() == pytest.approx(record["occlusion"]["mean"], abs=0.02)
    assert record["occlusion"]["distance_m"] is None
    assert record["provenance"]["config"]["occlusion"]["distance_m"] == "inf"


def test_occlusion_as_a_picture_is_linear_grey(openness):
    out, _ = openness
    with Image.open(out / "occlusion.png") as image:
        assert image.mode == "L"
        codes = np.asarray(image)
    expected = np.round(read_lightmap(out / "occlusion.exr").pages[0, ..., 0] * 255)
    np.testing.assert_array_equal(codes, expected)


def test_occlusion_is_bound_to_the_materials_of_objects_that_have_it(openness):
    out, _ = openness
    json_ = read_document(out / "scene.baked.glb").json
    primitives = [p for mesh in json_["meshes"] for p in mesh["primitives"]]
    for primitive in primitives:
        bound = json_["materials"][primitive["material"]]["occlusionTexture"]
        assert f"TEXCOORD_{bound['texCoord']}" in primitive["attributes"]
        assert json_["images"][json_["textures"][bound["index"]]["source"]]["mimeType"] == "image/png"
    assert sum("KHR_lights_punctual" in n.get("extensions", {}) for n in json_["nodes"]) == 2
    assert "IRRADIA_lighting" not in json_.get("extensionsUsed", [])


@pytest.mark.parametrize(("option", "other"), _PAIRS)
def test_what_excludes_each_other_is_bad_input_and_leaves_nothing(option, other, scene, tmp_path, capfd):
    arguments = [*_GIVEN.get(option, [option]), *_GIVEN.get(other, [other])]
    if option == "--probes":
        arguments += ["--probes", "auto"]
    assert app.run(["bake", str(scene), "-o", str(tmp_path / "out"), "--json", *arguments]) == 2
    error = json.loads(capfd.readouterr().out)["error"]
    assert error["where"] == option
    assert other in error["message"]
    assert list(tmp_path.iterdir()) == []


def test_a_distance_goes_with_occlusion_alone(scene, tmp_path):
    assert app.run(["bake", str(scene), "-o", str(tmp_path / "out"), "--ao-distance", "1"]) == 2


@pytest.mark.parametrize(("option", "name"), [("--view-first", "nowhere"), ("--only", "nothing")])
def test_a_name_that_nothing_bears_is_said_before_the_unwrap(option, name, scene, tmp_path, capfd):
    assert app.run(["bake", str(scene), "-o", str(tmp_path / "out"), option, name, "--json"]) == 2
    shown = capfd.readouterr()
    assert json.loads(shown.out)["error"]["where"] == option
    assert "unwrap" not in shown.err


def test_nothing_to_resume_is_said_before_anything_is_done(scene, tmp_path, capfd):
    assert app.run(["bake", str(scene), "-o", str(tmp_path / "out"), "--resume"]) == 2
    said = capfd.readouterr().err
    assert "no interrupted bake" in said
    assert "unwrap" not in said


def test_a_bake_says_that_its_time_was_up(scene, tmp_path, capfd):
    record = bake(scene, tmp_path, "--time", "0.01")
    assert record["ended_by"] == "time"
    assert "its time was up" in capfd.readouterr().out


def test_a_bake_says_that_the_noise_is_as_low_as_asked(scene, tmp_path, capfd):
    record = bake(scene, tmp_path, "--noise", "0.5")
    assert record["ended_by"] == "noise"
    assert record["stats"]["noise_p95"] <= 0.5
    assert "the noise is as low as asked" in capfd.readouterr().out


def test_a_bake_that_runs_out_of_samples_before_its_noise_is_low_does_not_say_so(scene, tmp_path):
    record = bake(scene, tmp_path, "--noise", "1e-6", "--samples", "64")
    assert record["ended_by"] == "samples"
    assert record["stats"]["noise_p95"] > 1e-6


def test_what_a_clamp_has_cut_off_is_said(scene, tmp_path, capfd):
    record = bake(scene, tmp_path, "--samples", "8", "--indirect-clamp", "0.01")
    lost = record["stats"]["clamped_off_share"]
    assert 0.01 < lost < 0.9
    assert f"the clamp has cut off {lost:.2%} of the light" in capfd.readouterr().out


def test_help_lists_every_option_once():
    from irradia.cli.bake import SECTIONS, command

    listed = [name for names in SECTIONS.values() for name in names]
    assert len(listed) == len(set(listed))
    options = {option for param in command.params for option in param.opts if option.startswith("--")}
    assert options == set(listed)


def test_many_files_are_counted():
    from pathlib import Path

    from irradia.cli.bake import files_line

    few = files_line(Path("out"), ("bake.json", "lightmap.exr"))
    many = files_line(Path("out"), ("bake.json", *(f"lightmap.{i}.exr" for i in range(20))))
    assert few == "In out: bake.json, lightmap.exr"
    assert many == "In out: 20 maps (lightmap…), bake.json"


def test_infinity_is_a_distance_and_nothing_else():
    from irradia.cli import options

    assert options.REACH.convert("inf", None, None) == math.inf
    for text in ("nan", "-1", "0", "far"):
        assert (
            app.run(["bake", "builtin:cornell", "-o", "unused", "--mode", "ao", "--ao-distance", text]) == 2
        )
