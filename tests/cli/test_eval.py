"""``irradia eval``: a field of known light in a furnace, where every answer is known."""

from __future__ import annotations

import io
import json
import math
from dataclasses import replace

import numpy as np
import pytest

from irradia.cli import app
from irradia.cli.eval_baselines import make_baseline
from irradia.cli.lighting import LightOptions, light_scene
from irradia.core.progress import Progress
from irradia.core.rng import Seed
from irradia.field.encodings import Identity
from irradia.field.field import Field
from irradia.field.files import save_field
from irradia.field.init import new_parameters
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.formats.samples import SampleFile, SampleInfo
from irradia.formats.samples_bin import write_samples_bin
from irradia.scene.load import load_scene

REFLECTANCE = 0.5
FURNACE = "builtin:furnace"
E = math.pi / (1.0 - REFLECTANCE)
SMALL = ["--pixels", "1024", "--reference-spp", "64", "--spp", "4", "--points", "256", "--rays", "64"]
BOX = np.float32([[-2, -1.5, -2.5], [2, 1.5, 2.5]])


def _write_field(path, light: float = E, box: np.ndarray = BOX, width: int = 4):
    """A field that says the same everywhere."""
    spec = FieldSpec(Identity(), Identity(), width=width, n_hidden_layers=1)
    parameters = {name: np.zeros_like(value) for name, value in new_parameters(spec, Seed(0)).items()}
    parameters["mlp.1.bias"][:] = math.log(light / 4.0)
    save_field(path, Field(spec, FieldFrame(box, 4.0), parameters), precision="fp32")
    return path


def _evaluate(weights, out, *more: str) -> int:
    baselines = () if "--baselines" in more else ("--baselines", "none")
    return app.run(["eval", str(weights), "--scene", FURNACE, "-o", str(out), *SMALL, *baselines, *more])


@pytest.fixture(scope="module")
def exact(tmp_path_factory):
    """The folder of an evaluation of the exact field."""
    folder = tmp_path_factory.mktemp("eval")
    assert _evaluate(_write_field(folder / "field.safetensors"), folder / "out") == 0
    return folder / "out"


def _record(out) -> dict:
    return json.loads((out / "eval.json").read_text())


def test_rays_come_in_fours(tmp_path, capfd):
    weights = _write_field(tmp_path / "field.safetensors")
    assert _evaluate(weights, tmp_path / "out", "--rays", "6") == 2
    assert "--rays" in capfd.readouterr().err


@pytest.mark.parametrize(("quantity", "code"), [("full", 0), ("indirect", 2)])
def test_a_bin_of_samples_is_of_the_light_that_is_said(tmp_path, quantity, code):
    n = 64
    rows = np.tile(np.float32([0, 0, 0, 0, 1, 0, E, E, E, 0]), (n, 1))
    rows[:, :3] = np.random.default_rng(1).uniform(0.5 * BOX[0], 0.5 * BOX[1], (n, 3))
    info = SampleInfo("volume", tuple(map(tuple, BOX.tolist())))
    write_samples_bin(tmp_path / "d.bin", SampleFile(tmp_path / "d", info, rows))
    weights = _write_field(tmp_path / "field.safetensors")
    given = ("--samples", str(tmp_path / "d.bin"), "--quantity", quantity)
    assert _evaluate(weights, tmp_path / "out", *given) == code


def test_damaged_probes_are_baked_again_and_a_cache_may_be_unwritable(tmp_path, monkeypatch):
    from irradia.cli import eval_baselines
    from irradia.core.progress import silent_progress
    from irradia.scene.load import load_scene

    scene, kept = load_scene(FURNACE), tmp_path / "probes.npz"
    monkeypatch.setattr(eval_baselines, "_RAYS_PER_PROBE", 16)
    monkeypatch.setattr(eval_baselines, "cached_path", lambda *_: kept)
    kept.write_bytes(b"no probes")
    made = eval_baselines.sh_grid(scene, 1, 400, silent_progress())
    again = eval_baselines.read_probes(kept)
    monkeypatch.setattr(eval_baselines, "cached_path", lambda *_: weird / "probes.npz")
    weird = tmp_path / "file"
    weird.write_text("a file where the folder should be")
    same = eval_baselines.sh_grid(scene, 1, 400, silent_progress())
    assert made.n_bytes == same.n_bytes == 24 * len(again)


def test_where_lights_are_live_all_rivals_have_as_many_samples():
    from irradia.cli.eval_baselines import Baseline
    from irradia.cli.eval_job import _as_noisy
    from irradia.scene.load import load_scene
    from irradia.scene.types import Light

    rivals = [Baseline("field", "", 1), Baseline("visibility", "", 1, most_spp=4)]
    dark = replace(load_scene(FURNACE), lights=())
    live = replace(dark, lights=(Light("point", (1.0, 1.0, 1.0), mode="mixed"),))
    assert [rival.most_spp for rival in _as_noisy(live, rivals)] == [4, 4]
    assert _as_noisy(dark, rivals) == rivals


def test_an_exact_field_shows_no_more_than_noise(exact):
    judged = _record(exact)["rivals"][0]
    (view,) = judged["views"]
    assert view["mean_ratio"]["value"] == pytest.approx(1.0, abs=2e-3)
    assert abs(view["relmse_noise_free"]) < 1e-4
    assert view["flip"]["value"] < 0.02
    assert judged["space"]["mse_noise_free"] < 1e-3 * E**2


def test_a_field_that_is_too_bright_is_so_by_the_share_of_its_light(tmp_path):
    assert _evaluate(_write_field(tmp_path / "f.safetensors", 1.2 * E), tmp_path / "out") == 0
    judged = _record(tmp_path / "out")["rivals"][0]
    truth = 1.0 / (1.0 - REFLECTANCE)
    assert judged["views"][0]["mean_ratio"]["value"] == pytest.approx(
        (1.0 + 1.2 * REFLECTANCE * truth) / truth, rel=5e-3
    )
    assert not judged["views"][0]["mean_ratio"]["is_noise"]
    assert judged["space"]["mse_noise_free"] == pytest.approx((0.2 * E) ** 2, rel=0.05)
    assert judged["leaks"]["n_near"] == 0  # all walls shine


def test_everything_is_there_to_look_at(exact):
    names = {path.name for path in exact.iterdir()}
    pictures = {"view0.field.png", "view0.reference.png", "view0.reference.hdr", "error0.field.png"}
    assert {"eval.html", "eval.json"} | pictures == names
    assert "Neural field" in (exact / "eval.html").read_text(encoding="utf-8")


def test_the_record_says_what_the_field_is_and_costs(exact):
    record, weights = _record(exact), exact.parent / "field.safetensors"
    assert record["field"]["n_bytes"] == weights.stat().st_size
    assert record["field"]["spec"]["position"]["type"] == "identity"
    assert record["query"]["million_per_second"] > 0.01
    assert record["query"]["flops"] == 2 * (6 * 4 + 4 * 3) + 4 + 3 + 4
    assert record["provenance"]["command"] == "eval"


def test_references_are_rendered_once(exact, tmp_path, monkeypatch):
    from irradia.cli import eval_reference, eval_space

    def refuse(*_):
        raise AssertionError("this was in the cache")

    monkeypatch.setattr(eval_reference, "_half", refuse)
    monkeypatch.setattr(eval_space, "_draw", refuse)
    assert _evaluate(exact.parent / "field.safetensors", tmp_path / "out") == 0
    assert _record(tmp_path / "out")["rivals"] == _record(exact)["rivals"]


def test_rivals_have_the_size_of_the_field_and_the_light_of_the_furnace(tmp_path):
    weights = _write_field(tmp_path / "f.safetensors", width=128)
    assert _evaluate(weights, tmp_path / "out", "--baselines", "sh1,sh2,visibility,lightmap") == 0
    field, *rivals = _record(tmp_path / "out")["rivals"]
    assert len(rivals) == 4
    for rival in rivals:
        assert rival["n_bytes"] < 1.2 * field["n_bytes"], rival["name"]
        assert rival["views"][0]["mean_ratio"]["value"] == pytest.approx(1.0, abs=0.03), rival["name"]
    for grid in rivals[:3]:
        assert grid["space"]["mse_noise_free"] < (0.05 * E) ** 2, grid["name"]
    assert rivals[3]["space"] is None


def test_a_dataset_can_take_the_place_of_drawn_points(exact, tmp_path):
    data = tmp_path / "furnace.samples"
    arguments = [
        "--kind",
        "volume",
        "--count",
        "512",
        "--samples",
        "32",
        "--integrator",
        "path",
        "--validation",
        "0",
    ]
    assert app.run(["sample", FURNACE, "-o", str(data), *arguments]) == 0
    assert _evaluate(exact.parent / "field.safetensors", tmp_path / "out", "--samples", str(data)) == 0
    space = _record(tmp_path / "out")["rivals"][0]["space"]
    assert space["n_points"] == 512
    assert space["mean_ratio"] == pytest.approx(1.0, abs=0.02)


def test_a_dataset_of_other_light_is_refused(tmp_path, capfd):
    data = tmp_path / "furnace.samples"
    arguments = [
        "--kind",
        "volume",
        "--count",
        "64",
        "--samples",
        "4",
        "--integrator",
        "path",
        "--validation",
        "0",
    ]
    assert app.run(["sample", FURNACE, "-o", str(data), *arguments, "--quantity", "indirect"]) == 0
    assert _evaluate(_write_field(tmp_path / "f.safetensors"), tmp_path / "out", "--samples", str(data)) == 2
    assert "expected samples of full light" in capfd.readouterr().err


def test_a_field_of_another_place_is_refused(tmp_path, capfd):
    weights = _write_field(tmp_path / "f.safetensors", box=BOX + 100.0)
    assert _evaluate(weights, tmp_path / "out") == 2
    assert "another scene" in capfd.readouterr().err
    assert not (tmp_path / "out").exists()


def test_baselines_that_so_few_bytes_cannot_hold_are_left_out_with_a_note(tmp_path, capfd):
    weights = _write_field(tmp_path / "f.safetensors")
    assert _evaluate(weights, tmp_path / "out", "--baselines", "visibility,lightmap") == 0
    assert [rival["key"] for rival in _record(tmp_path / "out")["rivals"]] == ["field"]
    assert "too few for the baseline visibility" in capfd.readouterr().err


@pytest.mark.parametrize("key", ["sh1", "sh2", "visibility", "lightmap"])
def test_baselines_of_very_many_bytes_are_left_out_with_a_note(key):
    told = io.StringIO()
    made = make_baseline(key, load_scene("builtin:cornell"), 24 << 20, Progress(told), 0)
    assert made is None
    assert f"no baseline {key}" in told.getvalue()


def test_a_lightmap_so_small_that_charts_do_not_fit_is_left_out_with_a_note():
    told = io.StringIO()
    scene = light_scene(load_scene("builtin:blocks"), LightOptions())
    assert make_baseline("lightmap", scene, 4096, Progress(told), 0) is None
    assert "no lightmap of 4,096 bytes" in told.getvalue()


@pytest.mark.parametrize("names", ["sh3", "sh1,", "every"])
def test_unknown_baselines_are_refused(tmp_path, names, capfd):
    weights = _write_field(tmp_path / "f.safetensors")
    assert _evaluate(weights, tmp_path / "out", "--baselines", names) == 2
    assert "expected all, none or some of" in capfd.readouterr().err
