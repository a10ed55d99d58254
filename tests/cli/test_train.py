"""``irradia train``."""

from __future__ import annotations

import json
import os
import signal
import threading
import time

import numpy as np
import pytest

from irradia.cli import app, train_run
from irradia.cli.train_run import overfitting
from irradia.cli.train_spec import parse_direction
from irradia.core.errors import InputError
from irradia.core.provenance import sha256_file
from irradia.field.encodings import Identity, OneBlob, SphericalHarmonics
from irradia.field.files import read_field
from irradia.field.presets import preset
from irradia.field.registry import print_spec, spec_to_dict
from irradia.field.training.log import LogRow
from irradia.formats.samples import SampleInfo, SampleWriter, open_samples
from irradia.formats.samples_bin import write_samples_bin

BOX = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
SMALL = ("--encoding", "frequency", "--n-frequencies", "2", "--hidden-dim", "8", "--hidden-layers", "1")
QUICK = (*SMALL, "--steps", "40", "--batch-size", "64", "--backend", "numpy")


def rows(n, seed, kind):
    rng = np.random.default_rng(seed)
    position = rng.random((n, 3))
    normal = rng.standard_normal((n, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    light = 2.0 + np.sin(3.0 * position)
    if kind == "sh":
        columns = [position, np.tile(light, 4) * np.repeat([1.0, 0.1, 0.2, 0.3], 3), np.zeros((n, 1))]
    else:
        columns = [position, normal, light, np.zeros((n, 1))]
    return np.concatenate(columns, axis=1).astype(np.float32)


def write_samples(path, n=600, seed=0, kind="surface", box=BOX, scene=None):
    provenance = {} if scene is None else {"config": {"scene": "room.glb"}, "inputs": {"room.glb": scene}}
    info = SampleInfo(kind, box, n_coefficients=4 if kind == "sh" else 0, provenance=provenance)
    with SampleWriter(path, info) as writer:
        writer.append(rows(n, seed, kind))
    return path


@pytest.fixture
def data(tmp_path):
    return write_samples(tmp_path / "room.samples")


@pytest.fixture
def train(capfd):
    """Runs the command with --json; gives its exit code and what it said."""

    def run(*arguments, quick=QUICK):
        code = app.run(["train", *map(str, arguments), *quick, "--json"])
        return code, json.loads(capfd.readouterr().out)

    return run


def test_a_field_its_log_and_its_curves_are_written(train, data, tmp_path):
    code, said = train(data, "-o", tmp_path / "room.safetensors")
    assert code == 0
    assert (said["complete"], said["ended_by"], said["steps"], said["samples"]) == (True, "steps", 40, 588)
    assert said["bytes"] == (tmp_path / "room.safetensors").stat().st_size
    assert said["parameters"] == 15 * 8 + 8 + 8 * 3 + 3
    stored = read_field(tmp_path / "room.safetensors")
    assert stored.field.spec.width == 8
    assert stored.provenance["training"]["validation"]["n_samples"] == 12
    assert stored.provenance["inputs"].keys() == {"room.samples"}
    assert (tmp_path / "room.training.csv").read_text().count("\n") > 30
    assert "<polyline" in (tmp_path / "room.training.svg").read_text()
    assert not (tmp_path / "room.checkpoint.npz").exists()


def test_the_same_command_gives_the_same_bytes(train, data, tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        train(data, "-o", tmp_path / name / "field.safetensors")
    first, second = ((tmp_path / name / "field.safetensors").read_bytes() for name in ("a", "b"))
    assert first == second


def test_the_unity_projects_flags_are_understood(train, tmp_path):
    write_samples(tmp_path / "room.samples", kind="sh")
    code, said = train(
        *("-i", tmp_path / "room.samples", "-o", tmp_path / "room.bin"),
        *("--encoding", "triplane", "--steps", "5", "--batch-size", "64", "--hidden-dim", "32"),
        *("--hidden-layers", "3", "--lr-encoding", "0.01", "--lr-network", "0.001", "--jitter-copies", "0"),
        *("--jitter-radius", "0.05", "--smooth-k", "2", "--smooth-normal-thresh", "0.5", "--n-levels", "16"),
        *("--log2-hashmap-size", "19", "--base-resolution", "16", "--max-resolution", "2048"),
        *("--plane-res", "16", "--features-per-plane", "4", "--n-frequencies", "10", "--include-identity"),
        *("--sh_mode", "--backend", "numpy"),
        quick=(),
    )
    assert code == 0
    assert said["spec"]["position"] == {
        "type": "triplane",
        "resolution": 16,
        "n_features": 4,
        "align_corners": False,
    }
    assert (said["spec"]["mode"], said["spec"]["head"]) == ("sh1", "linear")


def test_defaults_are_the_unity_projects():
    from irradia.cli.train import command

    parsed = command.make_context("train", ["a.samples", "-o", "b.safetensors"])
    expected = {
        "batch_size": 65536,
        "hidden_dim": 64,
        "hidden_layers": 2,
        "lr_encoding": 0.01,
        "lr_network": 0.001,
        "jitter_copies": 0,
        "jitter_radius": 0.05,
        "smooth_k": 0,
        "smooth_normal_thresh": 0.5,
        "n_levels": 16,
        "log2_hashmap_size": 19,
        "base_resolution": 16,
        "max_resolution": 2048,
        "plane_res": 128,
        "features_per_plane": 16,
        "n_frequencies": 10,
        "include_identity": False,
        "sh_mode": False,
        "encoding": "hash",
    }
    assert {name: parsed.params[name] for name in expected} == expected


@pytest.mark.parametrize(
    ("wish", "steps", "time_s"),
    [((), 5000, None), (("--time", "9"), None, 9.0), (("--time", "9", "--steps", "7"), 7, 9.0)],
)
def test_without_steps_or_time_there_are_five_thousand_steps(wish, steps, time_s):
    from irradia.cli.train import command, make_job

    choices = command.make_context("train", ["a.samples", "-o", "b.safetensors", *wish]).params
    del choices["as_json"]
    options = make_job(set(), **choices).options
    assert (options.steps, options.time_s) == (steps, time_s)


def test_training_ends_with_its_time(train, data, tmp_path):
    quick = (*SMALL, "--time", "0.3", "--batch-size", "64", "--backend", "numpy")
    code, said = train(data, "-o", tmp_path / "f.safetensors", quick=quick)
    assert code == 0
    assert said["ended_by"] == "time"
    assert said["train_s"] >= 0.3


def test_sh_samples_imply_sh_mode(train, tmp_path):
    write_samples(tmp_path / "sh.samples", kind="sh")
    code, said = train(tmp_path / "sh.samples", "-o", tmp_path / "f.safetensors")
    assert code == 0
    assert said["spec"]["mode"] == "sh1"
    assert said["spec"]["direction"] is None


def test_samples_of_the_unity_project_are_read(train, tmp_path, data):
    write_samples_bin(tmp_path / "unity.bin", open_samples(data))
    code, said = train(tmp_path / "unity.bin", "-o", tmp_path / "f.safetensors")
    assert code == 0
    assert said["samples"] == 588


def test_a_bin_of_samples_is_of_the_light_that_is_said(train, tmp_path):
    data = write_samples(tmp_path / "room.samples", kind="sh")
    write_samples_bin(tmp_path / "unity.bin", open_samples(data))
    out, said = tmp_path / "f.safetensors", ("--quantity", "indirect", "--coefficients", "irradiance")
    assert train(tmp_path / "unity.bin", "-o", out, *said)[0] == 0
    stored = read_field(out)
    assert stored.field.frame.quantity == "indirect"
    asked = stored.provenance["config"]["bin_samples"]
    assert asked == {"coefficients": "irradiance", "quantity": "indirect"}
    assert stored.provenance["samples"]["coefficients"] == "irradiance"


@pytest.mark.parametrize("option", [("--quantity", "full"), ("--coefficients", "radiance")])
def test_our_own_samples_say_what_they_are(train, data, tmp_path, option):
    code, said = train(data, "-o", tmp_path / "f.safetensors", *option)
    assert code == 2
    assert option[0] in said["error"]["where"]


def test_samples_for_validation_are_found_beside_the_data(train, data, tmp_path):
    write_samples(tmp_path / "room.validation.samples", n=70, seed=9)
    _, said = train(data, "-o", tmp_path / "f.safetensors")
    assert said["validation"]["n_samples"] == 70
    assert said["samples"] == 600
    write_samples(tmp_path / "other.samples", n=50, seed=8)
    _, said = train(data, "-o", tmp_path / "f.safetensors", "--validation", tmp_path / "other.samples")
    assert said["validation"]["n_samples"] == 50


@pytest.mark.parametrize("left", [{"box": (BOX[0], (1.0, 1.0, 2.0))}, {"scene": "5678"}])
@pytest.mark.parametrize("end", [(), ("--validation", "left.validation.samples")])
def test_samples_of_another_scene_are_not_judged_by(train, tmp_path, monkeypatch, left, end):
    monkeypatch.chdir(tmp_path)
    data = write_samples(tmp_path / "left.samples", scene="1234")
    write_samples(tmp_path / "left.validation.samples", n=70, **left)
    code, said = train(data, "-o", tmp_path / "f.safetensors", *end)
    if end and "box" in left:  # asked for by name, and the boxes meet
        assert code == 0
    else:
        assert code == 2
        assert "another scene" in said["error"]["message"]


def test_a_spec_file_says_all_of_the_field(train, data, tmp_path):
    _, said = train(data, "-o", tmp_path / "a.safetensors")
    spec = read_field(tmp_path / "a.safetensors").field.spec
    (tmp_path / "spec.json").write_text(print_spec(spec))
    quick = ("--steps", "40", "--batch-size", "64", "--backend", "numpy", "--spec", tmp_path / "spec.json")
    code, again = train(data, "-o", tmp_path / "b.safetensors", quick=tuple(map(str, quick)))
    assert code == 0
    assert again["spec"] == said["spec"] == spec_to_dict(spec)
    assert again["validation"] == said["validation"]


@pytest.mark.parametrize("name", ["f.safetensors", "f.safetensors.zst", "f.bin"])
def test_figures_are_those_of_the_file(train, data, tmp_path, name):
    grid = ("--n-levels", "2", "--log2-hashmap-size", "6", "--base-resolution", "2", "--max-resolution", "8")
    quick = (*grid, "--hidden-dim", "8", "--steps", "40", "--batch-size", "64", "--backend", "numpy")
    code, said = train(data, "-o", tmp_path / name, quick=quick)
    assert code == 0
    shipped, trained = said["validation"], said["validation_before_rounding"]
    assert shipped["relmse"] != trained["relmse"]
    assert shipped["relmse"] == pytest.approx(trained["relmse"], rel=0.05)


@pytest.mark.parametrize("bits", ["int8", "int4"])
def test_tables_are_quantised_on_request(train, data, tmp_path, bits):
    planes = ("--encoding", "triplane", "--plane-res", "64", "--features-per-plane", "4", "--steps", "20")
    quick = (*planes, "--batch-size", "64", "--hidden-dim", "8", "--backend", "numpy")
    _, plain = train(data, "-o", tmp_path / "a.safetensors", quick=quick)
    code, small = train(data, "-o", tmp_path / "b.safetensors", quick=(*quick, "--finish", bits))
    assert code == 0
    assert small["bytes"] < plain["bytes"] * (0.55 if bits == "int8" else 0.35)


def test_ctrl_c_leaves_a_usable_field_and_resume_gives_the_bytes_of_never_having_stopped(
    train, data, tmp_path
):
    steps = (*SMALL, "--steps", "3000", "--batch-size", "64", "--backend", "numpy")
    whole, stopped = tmp_path / "whole" / "f.safetensors", tmp_path / "stopped" / "f.safetensors"
    _, said = train(data, "-o", whole, quick=steps)

    def press_ctrl_c():
        while not stopped.with_name("f.training.csv").exists():  # after the first validation
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    pressing = threading.Thread(target=press_ctrl_c)
    pressing.start()
    code, interrupted = train(data, "-o", stopped, quick=steps)
    pressing.join()
    assert code == 130
    assert not interrupted["complete"]
    assert 0 < interrupted["steps"] < 3000
    assert read_field(stopped).field.spec.width == 8
    assert stopped.with_name("f.checkpoint.npz").exists()
    code, resumed = train(data, "-o", stopped, "--resume", quick=steps)
    assert code == 0
    assert resumed["validation"] == said["validation"]
    assert stopped.read_bytes() == whole.read_bytes()
    assert not stopped.with_name("f.checkpoint.npz").exists()
    logged = [line.split(",")[0] for line in stopped.with_name("f.training.csv").read_text().splitlines()]
    assert logged[-1] == "3000"
    assert len(set(logged)) == len(logged)


def test_following_waits_for_the_data(train, tmp_path):
    path = tmp_path / "late.samples"

    def write_late():
        time.sleep(0.7)
        write_samples(path)

    writing = threading.Thread(target=write_late)
    writing.start()
    code, said = train(path, "-o", tmp_path / "f.safetensors", "--follow")
    writing.join()
    assert code == 0
    assert said["steps"] == 40


def test_a_dataset_that_gets_its_name_while_the_field_is_finished_is_hashed_by_it(
    train, tmp_path, monkeypatch
):
    writer = SampleWriter(tmp_path / "room.samples", SampleInfo("surface", BOX))
    writer.append(rows(600, 0, "surface"))
    made = train_run._made

    def made_slowly(*arguments):
        writer.close()
        return made(*arguments)

    monkeypatch.setattr(train_run, "_made", made_slowly)
    code, _ = train(tmp_path / "room.samples", "-o", tmp_path / "f.safetensors")
    assert code == 0
    inputs = read_field(tmp_path / "f.safetensors").provenance["inputs"]
    assert inputs == {"room.samples": sha256_file(tmp_path / "room.samples")}


@pytest.mark.parametrize("when", ["_train", "_made"])
def test_a_dataset_that_goes_meanwhile_does_not_cost_the_field(train, tmp_path, monkeypatch, when):
    writer = SampleWriter(tmp_path / "room.samples", SampleInfo("surface", BOX))
    writer.append(rows(600, 0, "surface"))
    inner = getattr(train_run, when)

    def replaced_meanwhile(*arguments):
        done = inner(*arguments)
        writer.abandon()
        other = SampleWriter(tmp_path / "room.samples", SampleInfo("surface", BOX))
        other.append(rows(9, 1, "surface"))
        other.abandon()
        return done

    monkeypatch.setattr(train_run, when, replaced_meanwhile)
    code, _ = train(tmp_path / "room.samples", "-o", tmp_path / "f.safetensors")
    assert code == 0
    assert read_field(tmp_path / "f.safetensors").provenance["inputs"] == {}


def test_finishing_says_that_it_learns_from_samples_as_they_are(data, tmp_path, capfd):
    planes = ("--encoding", "triplane", "--plane-res", "8", "--features-per-plane", "4", "--steps", "5")
    quick = (*planes, "--batch-size", "64", "--hidden-dim", "8", "--backend", "numpy", "--finish", "int8")
    for wish, told in (((), False), (("--smooth-k", "2"), True)):
        assert app.run(["train", str(data), "-o", str(tmp_path / "f.safetensors"), *quick, *wish]) == 0
        assert ("neither smoothed nor copied" in capfd.readouterr().err) == told


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        (("--steps", "0"), "expected 1 to"),
        (("--hidden-dim", "200"), "expected 1 to 128"),
        (("--encoding", "nerf"), "nerf"),
        (("--lr-final", "2"), "up to 1"),
        (("--average", "1"), "below 1"),
        (("--direction", "sh:9"), "1–5 bands"),
        (("--direction", "cube"), "Did you mean"),
        (("--hold-out-blocks", "0.9"), "0 to 0.5"),
        (("--n-frequency", "3"), "--n-frequencies"),
        (("--sh-mode",), "SH coefficients"),
        (("--head", "linear", "--loss", "log"), "above zero"),
        (("--resume",), "no stopped training"),
        (("--time", "nan"), "finite"),
        (("--validation", "none.samples"), "none.samples"),
        (("-i", "again.samples"), "once"),
    ],
)
def test_bad_options_are_bad_input(train, data, tmp_path, wrong, complaint):
    code, said = train(data, "-o", tmp_path / "f.safetensors", quick=(*QUICK, *wrong))
    assert code == 2
    assert complaint in said["error"]["message"]
    assert not (tmp_path / "f.safetensors").exists()


@pytest.mark.parametrize(
    ("name", "wrong", "complaint"),
    [
        ("f.bin", ("--activation", "silu"), "activation silu"),
        ("f.bin", ("--precision", "fp32"), "halves"),
        ("f.bin", ("--finish", "int8"), "halves"),
        ("f.onnx", (), "ends in"),
    ],
)
def test_what_a_format_cannot_hold_is_refused_before_training(train, data, tmp_path, name, wrong, complaint):
    code, said = train(data, "-o", tmp_path / name, *wrong)
    assert code == 2
    assert complaint in said["error"]["message"]
    assert not (tmp_path / "f.training.csv").exists()


def test_a_spec_and_flags_of_the_field_exclude_each_other(train, data, tmp_path):
    (tmp_path / "spec.json").write_text("{}")
    code, said = train(data, "-o", tmp_path / "f.safetensors", "--spec", tmp_path / "spec.json")
    assert code == 2
    assert "--spec says all" in said["error"]["message"]


def test_an_unknown_key_of_a_spec_names_the_nearest(train, data, tmp_path):
    (tmp_path / "spec.json").write_text('{"position": {"type": "frequency"}, "widht": 8}')
    code, said = train(data, "-o", tmp_path / "f.safetensors", quick=("--spec", str(tmp_path / "spec.json")))
    assert code == 2
    assert "width" in said["error"]["message"]


@pytest.mark.parametrize("content", [b"", b"no samples at all", b"\x93SAMPLES cut"])
def test_damaged_data_is_bad_input(train, tmp_path, content):
    (tmp_path / "room.samples").write_bytes(content)
    assert train(tmp_path / "room.samples", "-o", tmp_path / "f.safetensors")[0] == 2


def test_missing_data_is_bad_input(train, tmp_path):
    assert train("-o", tmp_path / "f.safetensors")[0] == 2
    assert train(tmp_path / "none.samples", "-o", tmp_path / "f.safetensors")[0] == 2


def test_jitter_asks_the_scene_that_is_named(train, tmp_path):
    """Cornell's box fills −1 … 1; samples of its floor stay inside."""
    path = tmp_path / "room.samples"
    with SampleWriter(path, SampleInfo("volume", ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)))) as writer:
        writer.append(rows(400, 0, "volume"))
    code, said = train(path, "-o", tmp_path / "f.safetensors", "--jitter-copies", "1")
    assert code == 2
    assert "--jitter-scene" in said["error"]["message"]
    wishes = ("--jitter-copies", "1", "--jitter-scene", "builtin:cornell")
    code, said = train(path, "-o", tmp_path / "f.safetensors", *wishes)
    assert code == 0
    assert 500 < said["samples"] <= 2 * 392


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        ("identity", Identity()),
        ("sh", SphericalHarmonics()),
        ("sh:3", SphericalHarmonics(3)),
        ("one-blob:8", OneBlob(8)),
        ("one_blob", OneBlob()),
    ],
)
def test_directions_are_named_with_a_size(text, encoding):
    assert parse_direction(text) == encoding


@pytest.mark.parametrize("text", ["identity:3", "sh:x", "sh:", "cube", ""])
def test_other_directions_are_refused(text):
    with pytest.raises(InputError):
        parse_direction(text)


def test_a_preset_says_field_batches_rates_and_finishing(train, data, tmp_path):
    quick = ("--steps", "3", "--batch-size", "64")
    code, said = train(data, "-o", tmp_path / "a.safetensors.zst", "--preset", "triplane-50kB", quick=quick)
    assert code == 0
    assert said["spec"] == spec_to_dict(preset("triplane-50kB").spec)
    assert said["batch_size"] == 64, "what is asked for is stronger"
    assert read_field(tmp_path / "a.safetensors.zst").tensors, "its tables are codes"


@pytest.mark.parametrize("more", [("--hidden-dim", "8"), ("--spec", "spec.json")])
def test_a_preset_says_all_of_the_field(train, data, tmp_path, more, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "spec.json").write_text(print_spec(preset("triplane-50kB").spec))
    code, said = train(data, "-o", tmp_path / "a.bin", "--preset", "triplane-50kB", *more, quick=())
    assert code == 2
    assert "says all of the field" in said["error"]["message"]


def test_an_unknown_preset_names_the_nearest(train, data, tmp_path):
    code, said = train(data, "-o", tmp_path / "a.safetensors", "--preset", "hash-200kb", quick=())
    assert code == 2
    assert "hash-200kB" in said["error"]["message"]


def test_a_validation_that_has_become_worse_is_told():
    errors = {1: 0.5, 2: 0.1, 3: 0.2}
    rows = [LogRow(step, 0.0, 0, 1.0, psnr_db=20.0, relmse=error) for step, error in errors.items()]
    assert "best at step 2" in (overfitting(rows) or "")
    assert overfitting(rows[:2]) is None
    assert overfitting([LogRow(1, 0.0, 0, 1.0)]) is None
