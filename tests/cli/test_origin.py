"""Files that belong to different scenes or light aren't put together unsaid."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from irradia.cli import app
from irradia.cli.eval_options import EvalJob
from irradia.cli.lighting import LightOptions
from irradia.cli.origin import scene_config, scene_inputs, scene_origin
from irradia.field.files import load_field, read_field, save_field
from irradia.formats.ies import IesTable, encode_ies
from irradia.formats.sample_origin import difference
from irradia.formats.samples import SampleInfo, SampleWriter
from irradia.scene.load import load_scene

from .workshop import write_workshop

FIELD = Path(__file__).resolve().parents[2] / "vectors" / "hash-fp32.safetensors"
BOX = ((-1.0, 0.0, 0.5), (1.0, 2.25, 4.5))
SMALL = ["--pixels", "256", "--reference-spp", "2", "--spp", "1", "--points", "0", "--baselines", "none"]


@pytest.fixture
def job(tmp_path) -> EvalJob:
    scene = write_workshop(tmp_path / "workshop.gltf")
    return EvalJob(Path("field.safetensors"), str(scene), tmp_path / "out")


@pytest.fixture
def origin(job) -> dict:
    return scene_origin(job, load_scene(job.scene))


def lamp_file(path: Path, candela: float) -> Path:
    values = np.full((1, 2), candela)
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(encode_ies(IesTable("C", np.array([0.0, 180.0]), np.array([0.0]), values, 2002, {})))
    return path


def trained(path: Path, origin: dict) -> Path:
    """A field whose file says that it was trained from samples of that origin."""
    save_field(path, load_field(FIELD), {"samples": origin})
    return path


def samples(path: Path, origin: dict, box=BOX) -> Path:
    rng = np.random.default_rng(4)
    rows = np.zeros((64, 10), np.float32)
    rows[:, :3] = rng.uniform(*np.array(box), (64, 3))
    rows[:, 4], rows[:, 6:9] = 1.0, 1.0
    quantity = load_field(FIELD).frame.quantity
    with SampleWriter(path, SampleInfo("volume", box, quantity, provenance=origin)) as writer:
        writer.append(rows)
    return path


def test_files_are_kept_by_name_and_hash_and_folders_not_at_all(job, tmp_path):
    lamp = lamp_file(tmp_path / "lamps" / "lamp.ies", 8.0)
    (tmp_path / "paint").mkdir()
    (tmp_path / "paint" / "red.png").write_bytes(b"a picture")
    paint = tmp_path / "paint" / "paint.json"
    paint.write_text(json.dumps({"grey": {"albedo": {"image": "red.png"}, "opacity": 1}}))
    job = replace(job, ies=(f"left lamp={lamp}", str(lamp)), overrides=(str(paint), "red:albedo=0,0,0"))
    config, inputs = scene_config(job), scene_inputs(job, load_scene(job.scene))
    assert config["ies"] == ["left lamp=lamp.ies", "lamp.ies"]
    assert config["overrides"] == ["paint.json", "red:albedo=0,0,0"]
    assert set(inputs) == {"workshop.gltf", "paint.json", "red.png", "lamp.ies", "lamp.ies'"}
    assert str(tmp_path) not in json.dumps([config, job.config()]).replace(str(job.out), "")
    lamp_file(lamp, 9.0)
    assert scene_inputs(job, load_scene(job.scene))["lamp.ies"] != inputs["lamp.ies"]


def test_scenes_and_light_differ_where_they_do(job, origin, tmp_path):
    scene = load_scene(job.scene)
    assert difference(origin, json.loads(json.dumps(origin))) == ""
    assert difference(origin, {}) == difference(None, origin) == ""
    edited = load_scene(str(write_workshop(tmp_path / "b.gltf", lambda d: d["nodes"][0].update(name="x"))))
    assert "scene" in difference(origin, scene_origin(job, edited))
    assert "--env" in difference(origin, scene_origin(replace(job, light=LightOptions(sky=True)), scene))
    assert "--material-override" in difference(
        origin, scene_origin(replace(job, overrides=("red:albedo=0,0,0",)), scene)
    )


def test_a_file_of_the_same_name_with_another_content_is_another(job, tmp_path):
    scene = load_scene(job.scene)
    lamps = [lamp_file(tmp_path / folder / "lamp.ies", candela) for folder, candela in (("a", 1), ("b", 2))]
    origins = [scene_origin(replace(job, ies=(str(lamp),)), scene) for lamp in lamps]
    assert "lamp.ies" in difference(*origins)
    same = lamp_file(tmp_path / "c" / "lamp.ies", 1)
    assert difference(origins[0], scene_origin(replace(job, ies=(str(same),)), scene)) == ""


def test_what_earlier_versions_have_kept_with_its_folder_is_the_same(origin):
    earlier = json.loads(json.dumps(origin))
    earlier["config"]["ies"], origin["config"]["ies"] = ["lamp=/home/me/lamp.ies"], ["lamp=lamp.ies"]
    assert difference(origin, earlier) == ""


def test_a_field_of_another_light_is_not_judged_unless_asked_for(job, origin, tmp_path, capfd):
    weights = trained(tmp_path / "field.safetensors", origin)
    command = ["eval", str(weights), "--scene", job.scene, "-o", str(tmp_path / "out"), *SMALL]
    assert app.run([*command, "--env-color", "1"]) == 2
    said = capfd.readouterr().err
    assert "another scene or light" in said
    assert "--force" in said
    assert not (tmp_path / "out").exists()
    assert app.run([*command, "--env-color", "1", "--force"]) == 0
    assert "another scene or light" in capfd.readouterr().err
    record = json.loads((tmp_path / "out" / "eval.json").read_text())
    assert "another scene or light" in record["notes"][0]
    assert "workshop.gltf" in record["provenance"]["inputs"]
    assert "another scene or light" in (tmp_path / "out" / "eval.html").read_text(encoding="utf-8")
    assert app.run(command) == 0
    assert json.loads((tmp_path / "out" / "eval.json").read_text())["notes"][:1] != record["notes"][:1]


def test_samples_of_another_scene_judge_no_field(job, origin, tmp_path, capfd):
    weights = trained(tmp_path / "field.safetensors", origin)
    other = {**origin, "inputs": {"workshop.gltf": "0" * 64}}
    data = samples(tmp_path / "d.samples", other)
    command = ["eval", str(weights), "--scene", job.scene, "-o", str(tmp_path / "out"), *SMALL]
    assert app.run([*command, "--samples", str(data)]) == 2
    assert "the scene's file differs" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda origin: origin["inputs"].update({"workshop.gltf": "0" * 64}), "the scene's file differs"),
        (lambda origin: origin["config"]["light"].update(sky=True), "light from outside differs"),
    ],
)
def test_a_field_is_not_finished_by_samples_of_another_scene(origin, tmp_path, capfd, change, complaint):
    weights, out = trained(tmp_path / "field.safetensors", origin), tmp_path / "small.safetensors"
    other = json.loads(json.dumps(origin))
    change(other)
    command = ["export", str(weights), "-o", str(out), "--finish", "int8", "--samples"]
    assert app.run([*command, str(samples(tmp_path / "other.samples", other))]) == 2
    assert complaint in capfd.readouterr().err
    assert not out.exists()
    assert app.run([*command, str(samples(tmp_path / "same.samples", origin))]) == 0
    assert read_field(out).provenance["samples"] == origin


def test_a_field_is_not_finished_by_samples_of_elsewhere(origin, tmp_path, capfd):
    weights, out = trained(tmp_path / "field.safetensors", origin), tmp_path / "small.safetensors"
    far = tuple(tuple(x + 100.0 for x in corner) for corner in BOX)
    data = samples(tmp_path / "far.samples", {}, far)
    command = ["export", str(weights), "-o", str(out), "--finish", "int8", "--samples", str(data)]
    assert app.run(command) == 2
    assert "boxes don't meet" in capfd.readouterr().err
