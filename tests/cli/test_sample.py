"""``irradia sample``."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from irradia.cli import app
from irradia.formats.samples import open_samples, part_path

from .workshop import bake, lamp, write_workshop

DIM_IES = """IESNA:LM-63-2002
[TEST] a hundredth of a candela all around
TILT=NONE
1 -1 1 2 1 1 2 0 0 0
1 1 0
0 180
0
0.01 0.01
"""
SMALL = ["--count", "600", "--samples", "8", "--resolution", "32", "--validation", "100"]


@pytest.fixture(scope="module")
def workshop(tmp_path_factory) -> Path:
    return write_workshop(tmp_path_factory.mktemp("sample") / "workshop.gltf")


def sample(scene: Path | str, out: Path, *options: str) -> int:
    return app.run(["sample", str(scene), "-o", str(out), *SMALL, *options])


@pytest.mark.parametrize(
    ("options", "kind", "n_values"),
    [
        ([], "surface", 3),
        (["--kind", "volume", "--quantity", "indirect"], "volume", 3),
        (["--kind", "sh-random", "--order", "2"], "sh", 27),
        (["--kind", "sh-grid", "--spacing", "0.5"], "sh", 12),
    ],
)
def test_a_dataset_and_a_better_one_to_judge_by_are_written(
    options, kind, n_values, workshop, tmp_path, capfd
):
    assert sample(workshop, tmp_path / "data.samples", "--json", *options) == 0
    said = json.loads(capfd.readouterr().out)
    train, judge = open_samples(tmp_path / "data.samples"), open_samples(tmp_path / "data.validation.samples")
    assert (train.info.kind, train.info.n_values, train.info.samples_per_point) == (kind, n_values, 8)
    assert train.info.quantity == ("indirect" if "indirect" in options else "full")
    assert (len(judge), judge.info.samples_per_point) == (100, 128)
    assert said["points"] == len(train) == (600 if "--spacing" not in options else len(train))
    assert said["mean"] == pytest.approx(float(train.values[:, :3].mean()), rel=1e-4)
    assert train.info.provenance["config"]["options"]["samples"] == 8
    assert train.values.any()


@pytest.mark.parametrize(("kind", "version"), [("surface", 1), ("sh-random", 2)])
def test_a_bin_holds_the_same_numbers(kind, version, workshop, tmp_path):
    for name in ("data.samples", "data.bin"):
        assert sample(workshop, tmp_path / name, "--kind", kind) == 0
    ours, theirs = open_samples(tmp_path / "data.samples"), open_samples(tmp_path / "data.bin")
    assert theirs.info.provenance["version"] == version
    np.testing.assert_allclose(theirs.values, ours.values, rtol=1e-5, atol=1e-7)
    np.testing.assert_array_equal(theirs.positions, ours.positions)
    assert {path.name for path in tmp_path.glob("*.samples")} == {"data.samples", "data.validation.samples"}


def test_no_earlier_samples_for_validation_are_left_beside_new_ones(workshop, tmp_path):
    assert sample(workshop, tmp_path / "data.samples") == 0
    assert sample(workshop, tmp_path / "data.samples", "--validation", "0") == 0
    assert [path.name for path in tmp_path.glob("*.samples")] == ["data.samples"]


def test_a_bin_that_fails_leaves_nothing_beside_it(workshop, tmp_path, monkeypatch):
    def fail(*_: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr("irradia.formats.sample_writer.SampleWriter.append", fail)
    assert sample(workshop, tmp_path / "data.bin", "--validation", "0") != 0
    assert not list(tmp_path.glob("data*"))


def test_materials_are_replaced_before_light_is_gathered(workshop, tmp_path):
    assert sample(workshop, tmp_path / "as_is.samples") == 0
    black = ["grey:albedo=0,0,0", "red:albedo=0,0,0"]
    options = ("--material-override", black[0], "--material-override", black[1])
    assert sample(workshop, tmp_path / "black.samples", *options) == 0
    as_is, found = (open_samples(tmp_path / f"{name}.samples") for name in ("as_is", "black"))
    assert 0.0 < found.values.mean() < 0.95 * as_is.values.mean()
    assert found.info.provenance["config"]["overrides"] == black


def test_materials_are_replaced_in_a_finished_bake_too(workshop, tmp_path):
    override = ("--material-override", "grey:emission=3")
    bake(workshop, tmp_path / "bake", "--samples", "16", *override)
    for name, how in (("own", ()), ("given", ("--lightmap", str(tmp_path / "bake")))):
        assert sample(workshop, tmp_path / f"{name}.samples", "--samples", "64", *override, *how) == 0
    own, given = (open_samples(tmp_path / f"{name}.samples") for name in ("own", "given"))
    np.testing.assert_allclose(given.values.mean(), own.values.mean(), rtol=0.03)


def test_a_measured_lamp_shines_as_measured(workshop, tmp_path):
    (tmp_path / "dim.ies").write_text(DIM_IES, encoding="utf-8")
    assert sample(workshop, tmp_path / "as_is.samples") == 0
    assert sample(workshop, tmp_path / "dim.samples", "--ies", f"left lamp={tmp_path / 'dim.ies'}") == 0
    as_is, found = (open_samples(tmp_path / f"{name}.samples") for name in ("as_is", "dim"))
    assert found.values.mean() < 0.7 * as_is.values.mean()


def test_a_finished_bake_serves_as_the_light_of_surfaces(workshop, tmp_path):
    bake(workshop, tmp_path / "bake", "--samples", "64")
    assert sample(workshop, tmp_path / "a.samples", "--samples", "64") == 0
    for where in (tmp_path / "bake", tmp_path / "bake" / "scene.baked.glb"):
        assert sample(workshop, tmp_path / "b.samples", "--samples", "64", "--lightmap", str(where)) == 0
        found, expected = open_samples(tmp_path / "b.samples"), open_samples(tmp_path / "a.samples")
        np.testing.assert_allclose(found.values.mean(), expected.values.mean(), rtol=0.01)


def test_a_bake_without_all_light_or_of_another_scene_is_refused(workshop, tmp_path, capfd):
    live = write_workshop(tmp_path / "live.gltf", lambda j: lamp(j, "left lamp").update(_live()))
    bake(workshop, tmp_path / "indirect", "--samples", "4", "--mode", "indirect")
    bake(live, tmp_path / "live", "--samples", "4")
    bake(workshop, tmp_path / "whole", "--samples", "4")
    for scene, where, complaint in (
        (workshop, "indirect", "full light"),
        (live, "live", "live lights"),
        ("builtin:cornell", "whole", "other surfaces"),
    ):
        assert sample(scene, tmp_path / "data.samples", "--lightmap", str(tmp_path / where)) == 2
        assert complaint in capfd.readouterr().err
    assert not list(tmp_path.glob("data*"))


def _live() -> dict:
    return {"extras": {"irradia": {"mode": "realtime"}}}


def test_one_and_two_threads_write_the_same_bytes(workshop, tmp_path):
    files = []
    for threads in ("1", "2"):
        out = tmp_path / threads / "data.samples"
        command = ["sample", str(workshop), "-o", str(out), *SMALL, "--threads", threads]
        subprocess.run([sys.executable, "-m", "irradia", *command], check=True, capture_output=True)
        files.append([path.read_bytes() for path in sorted(out.parent.glob("data*.samples"))])
    assert len(files[0]) == 2
    assert files[0] == files[1]


def test_ctrl_c_leaves_the_beginning_of_the_dataset(workshop, tmp_path):
    out = tmp_path / "data.samples"
    options = ["--count", "100000000", "--samples", "64", "--integrator", "path", "--validation", "0"]
    command = [sys.executable, "-m", "irradia", "sample", str(workshop), "-o", str(out), *options]
    with subprocess.Popen(command, stderr=subprocess.PIPE) as running:
        deadline = time.monotonic() + 60.0
        while not (part_path(out).exists() and len(open_samples(out)) > 0):
            assert running.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.05)
        running.send_signal(signal.SIGINT)
        assert running.wait(timeout=60) == 130
    found = open_samples(out)
    assert found.finished
    assert 0 < len(found) < 100_000_000


@pytest.fixture
def ctrl_c(monkeypatch):
    """``ctrl_c("train", 50)``: the next sampling is asked to end after so many points of that file."""
    from irradia.bake.datasets import generate

    whole = generate.sample_rows

    def at(which: str, points: int) -> None:
        def rows(setting, options, name, *more):
            for part in whole(setting, options, name, *more):
                if name == which:
                    signal.raise_signal(signal.SIGINT)
                    part = part[:points]
                yield part

        monkeypatch.setattr(generate, "sample_rows", rows)

    return at


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("end", [".samples", ".bin"])
def test_ctrl_c_does_not_replace_a_larger_dataset(end, workshop, tmp_path, ctrl_c, capfd):
    out = tmp_path / f"data{end}"
    assert sample(workshop, out) == 0
    before = _contents(tmp_path)
    ctrl_c("train", 50)
    capfd.readouterr()
    assert sample(workshop, out, "--seed", "1", "--json") == 130
    said = json.loads(capfd.readouterr().out)
    assert _contents(tmp_path).items() >= before.items()
    stopped = tmp_path / f"data.stopped{end}"
    assert set(_contents(tmp_path)) - set(before) == {stopped.name, "data.stopped.validation.samples"}
    assert len(open_samples(stopped)) == 50
    assert said["path"] == str(stopped)
    assert said["kept"] == {"path": str(out), "points": 600}
    judge = open_samples(tmp_path / "data.stopped.validation.samples")
    assert judge.info.provenance["seed"] == 1
    assert said["validation"]["path"] == str(judge.path)


def test_ctrl_c_before_the_first_sample_leaves_an_earlier_dataset_and_its_judge(workshop, tmp_path, ctrl_c):
    assert sample(workshop, tmp_path / "data.samples") == 0
    before = _contents(tmp_path)
    ctrl_c("validation", 10)
    assert sample(workshop, tmp_path / "data.samples", "--seed", "1") == 130
    assert _contents(tmp_path) == before


def test_ctrl_c_replaces_a_smaller_dataset_and_one_that_is_damaged(workshop, tmp_path, ctrl_c):
    out = tmp_path / "data.samples"
    assert sample(workshop, out, "--count", "20") == 0
    ctrl_c("train", 50)
    assert sample(workshop, out, "--seed", "1") == 130
    assert len(open_samples(out)) == 50
    out.write_bytes(b"damaged")
    assert sample(workshop, out, "--seed", "2") == 130
    assert open_samples(out).info.provenance["seed"] == 2
    judge = open_samples(tmp_path / "data.validation.samples")
    assert judge.info.provenance["seed"] == 2


def test_a_whole_dataset_replaces_a_larger_one(workshop, tmp_path):
    out = tmp_path / "data.samples"
    for count in ("100", "20"):
        assert sample(workshop, out, "--count", count) == 0
    assert len(open_samples(out)) == 20
    assert set(_contents(tmp_path)) == {"data.samples", "data.validation.samples"}


@pytest.mark.parametrize(
    "arguments",
    [
        ["-o", "data.txt"],
        ["-o", "data.bin", "--kind", "sh-grid", "--order", "2"],
        ["-o", "data.samples", "--samples", "30"],
        ["-o", "data.samples", "--spacing", "0.5"],
        ["-o", "data.samples", "--integrator", "path", "--lightmap", "."],
        ["-o", "data.samples", "--lightmap", "."],
    ],
)
def test_bad_input_leaves_no_file(arguments, workshop, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert app.run(["sample", str(workshop), *arguments]) == 2
    assert capfd.readouterr().err
    assert list(tmp_path.iterdir()) == []
