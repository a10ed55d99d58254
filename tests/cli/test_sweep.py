"""``irradia sweep``: grids, folders of runs, tables; what was stopped goes on."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from irradia.cli import app
from irradia.cli.sweep_grid import BUILT_IN, SweepRun, expand, read_grid, run_name
from irradia.cli.sweep_job import _formula_cost, describe
from irradia.cli.sweep_runs import SweepJob, command_line, finished
from irradia.cli.sweep_table import make_row, write_tables
from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.field.encodings import Identity, TriPlane
from irradia.field.field import Field
from irradia.field.files import save_field
from irradia.field.init import new_parameters
from irradia.field.quantise import round_tables
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.formats.samples import SampleInfo, SampleWriter

BOX = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
COMMON = {"steps": 20, "batch-size": 64, "backend": "numpy", "hidden-dim": 8, "hidden-layers": 1}
GRID = {"common": COMMON, "grids": [{"encoding": "frequency", "n-frequencies": [1, 2]}]}


@pytest.fixture
def data(tmp_path):
    rng = np.random.default_rng(0)
    position = rng.random((400, 3))
    normal = rng.standard_normal((400, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    path = tmp_path / "room.samples"
    with SampleWriter(path, SampleInfo("surface", BOX)) as writer:
        rows = [position, normal, 2.0 + np.sin(3.0 * position), np.zeros((400, 1))]
        writer.append(np.concatenate(rows, axis=1).astype(np.float32))
    return path


@pytest.fixture
def grid(tmp_path):
    def write(content):
        path = tmp_path / "grid.json"
        path.write_text(json.dumps(content))
        return path

    return write


@pytest.fixture
def sweep(capfd):
    """Runs the command with --json; gives its exit code and what it said."""

    def run(*arguments):
        code = app.run(["sweep", *map(str, arguments), "--json"])
        return code, json.loads(capfd.readouterr().out)

    return run


def test_the_unity_projects_batch_has_99_runs_of_its_three_kinds():
    runs = read_grid("nic99", {})
    kinds = [run.choices["encoding"] for run in runs]
    assert {kind: kinds.count(kind) for kind in kinds} == {"hash": 72, "frequency": 18, "triplane": 9}


@pytest.mark.parametrize("name", BUILT_IN)
def test_names_of_built_in_runs_differ_and_fit_folders(name):
    names = [run.name for run in read_grid(name, {})]
    assert len(set(names)) == len(names)
    assert all(len(n) < 80 and set(n) <= set("-_.") | set(map(chr, range(48, 123))) for n in names)


def test_every_list_is_varied_with_every_other():
    runs = expand({"grids": [{"encoding": "hash", "n-levels": [1, 2], "hidden-dim": [8, 16, 32]}]}, {}, "g")
    assert [run.name for run in runs] == [f"hash-L{n}-w{w}" for n in (1, 2) for w in (8, 16, 32)]


def test_a_grids_own_values_are_stronger_than_common_ones_and_the_command_lines_than_both():
    content = {"common": {"steps": 1, "seed": 1}, "grids": [{"encoding": "hash", "seed": 2}]}
    assert expand(content, {"steps": 9}, "g")[0].choices == {"steps": 9, "seed": 2, "encoding": "hash"}


def test_flags_are_given_or_left_out():
    run = SweepRun("x", {"include-identity": True, "sh-mode": False, "time": 2.5})
    assert run.arguments == ["--include-identity", "--time=2.5"]


def test_a_run_with_a_checkpoint_goes_on(tmp_path):
    job, run = SweepJob(tmp_path / "d", "", tmp_path, seed=3, threads=1), SweepRun("x", {"seed": 4})
    job.folder(run).mkdir(parents=True)
    assert "--resume" not in command_line(job, run)
    (job.folder(run) / "field.checkpoint.npz").touch()
    assert "--resume" in command_line(job, run)
    seeds = [word for word in command_line(job, run) if word.startswith("--seed")]
    assert seeds == ["--seed=3", "--seed=4"], "the last counts: the grid's own"


def test_a_name_tells_what_has_no_short_form():
    assert run_name({"encoding": "hash", "loss": "l2", "direction": "sh:3"}) == "hash-loss_l2-direction_sh_3"


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ([], "grids"),
        ({"grids": []}, "grids"),
        ({"grids": [{"n-level": 3}]}, "n-levels"),
        ({"grids": [{"out": "x"}]}, "unknown key 'out'"),
        ({"grids": [{"n-levels": []}]}, "n-levels"),
        ({"grids": [{"n-levels": [[1]]}]}, "n-levels"),
        ({"grids": [{"encoding": "hash"}, {"encoding": "hash"}]}, "two runs"),
        ({"grid": [], "grids": [{}]}, "unknown key 'grid'"),
        ({"grids": [3]}, "object of options"),
    ],
)
def test_a_wrong_grid_is_named(content, said):
    with pytest.raises(InputError, match=said):
        expand(content, {}, "grid.json")


def test_fields_tables_and_page_are_written_and_kept(sweep, data, grid, tmp_path):
    out = tmp_path / "out"
    code, said = sweep(data, "-o", out, "--grid", grid(GRID))
    assert code == 0
    assert said["complete"]
    assert [row["name"] for row in said["rows"]] == ["frequency-K1", "frequency-K2"]
    with (out / "sweep.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["option.n-frequencies"] for row in rows] == ["1", "2"]
    assert all(float(row["relmse"]) > 0 and int(row["bytes"]) > 0 for row in rows)
    assert all(float(row["queries_per_s"]) > 0 for row in rows)
    page = (out / "sweep.html").read_text()
    assert page.count("<circle") > 6
    assert "frequency-K2" in page
    written = (out / "runs" / "frequency-K1" / "field.safetensors").stat().st_mtime_ns
    assert sweep(data, "-o", out, "--grid", grid(GRID))[0] == 0
    assert (out / "runs" / "frequency-K1" / "field.safetensors").stat().st_mtime_ns == written


def test_other_options_train_anew(sweep, data, grid, tmp_path):
    out = tmp_path / "out"
    one = {"common": COMMON, "grids": [{"encoding": "frequency", "n-frequencies": 1}]}
    sweep(data, "-o", out, "--grid", grid(one))
    assert sweep(data, "-o", out, "--grid", grid(one), "--list")[1]["rows"]
    assert not sweep(data, "-o", out, "--grid", grid(one), "--steps", 30, "--list")[1]["rows"]


def test_parquet_holds_what_the_csv_holds(tmp_path):
    from pyarrow import parquet

    runs = [SweepRun("a", {"encoding": "hash", "n-levels": 4}), SweepRun("b", {"finish": "int8"})]
    good = {"ok": True, "validation": {"relmse": 0.5}, "bytes": 10}
    rows = [make_row(runs[0], good, {"flops": 7}), make_row(runs[1], {"ok": False, "error": "no"}, {})]
    write_tables(tmp_path, rows)
    table = parquet.read_table(tmp_path / "sweep.parquet").to_pydict()
    assert table["relmse"] == [0.5, None]
    assert table["status"] == ["done", "failed"]
    assert table["option.n-levels"] == [4, None]
    assert table["option.finish"] == [None, "int8"]
    assert table["error"] == [None, "no"]


def test_a_run_that_fails_is_told_and_the_others_go_on(sweep, data, grid, tmp_path):
    content = {
        "common": COMMON,
        "grids": [{"encoding": "frequency", "loss": "log", "head": ["exp", "linear"]}],
    }
    code, said = sweep(data, "-o", tmp_path / "out", "--grid", grid(content))
    assert code == 2
    assert [row["status"] for row in said["rows"]] == ["done", "failed"]
    assert not said["ok"]
    assert "above zero" in said["failed"][0]["error"]


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ({"head": ["exp", "nothing"]}, "nothing"),
        ({"steps": 0}, "expected 1 to"),
        ({"lr-final": 2}, "up to 1"),
        ({"include-identity": "-oelsewhere"}, "--include-identity"),
        ({"n-levels": True}, "--n-levels"),
    ],
)
def test_a_bad_value_is_told_before_anything_is_trained(sweep, data, grid, tmp_path, wrong, complaint):
    content = {"common": COMMON, "grids": [{"encoding": "frequency", **wrong}]}
    code, said = sweep(data, "-o", tmp_path / "out", "--grid", grid(content))
    assert code == 2
    assert complaint in said["error"]["message"]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["..", ".", "-x", ""])
def test_no_run_is_named_so_that_it_would_be_another_folder(name):
    with pytest.raises(InputError, match="name of a run"):
        expand({"grids": [{"encoding": name}]}, {}, "g")


@pytest.fixture
def ended(tmp_path):
    """A run that left a result, with a field or without; gives what counts of it."""

    def leave(result, *, field=False):
        job, run = SweepJob(tmp_path / "d", "", tmp_path, seed=3, threads=1), SweepRun("x", {"steps": 4})
        job.folder(run).mkdir(parents=True)
        (job.folder(run) / "request.json").write_text(json.dumps(job.request(run)))
        (job.folder(run) / "result.json").write_text(json.dumps(result))
        if field:
            job.field(run).touch()
        return finished(job, run)

    return leave


@pytest.mark.parametrize("code", [-9, 1, 130, 137])
def test_a_run_that_was_killed_is_tried_again(ended, code):
    assert ended({"ok": False, "exit_code": code}) is None


def test_a_run_with_wrong_options_has_failed_for_good(ended):
    assert ended({"ok": False, "exit_code": 2, "error": "no"})["error"] == "no"


@pytest.mark.parametrize("field", [True, False])
def test_a_run_whose_field_has_gone_is_tried_again(ended, field):
    assert (ended({"ok": True}, field=field) is not None) == field


def test_runs_whose_error_is_no_number_are_told_last():
    rows = [
        {"name": name, "status": "done", "bytes": 10, "relmse": relmse}
        for name, relmse in (("broken", None), ("good", 0.5))
    ]
    told = describe({"rows": rows, "n_runs": 2, "out": "x", "failed": [], "complete": True}).splitlines()
    assert "relMSE 5.000e-01" in told[1]
    assert "relMSE –" in told[2]


def test_bytes_of_a_query_are_those_of_the_file(tmp_path):
    spec = FieldSpec(TriPlane(8, 4), Identity(), width=8, n_hidden_layers=1)
    made = Field(spec, FieldFrame(np.array(BOX, np.float32)), new_parameters(spec, Seed(0)))
    save_field(tmp_path / "halves.safetensors", made)
    save_field(tmp_path / "codes.safetensors", round_tables(made, 8))
    halves, codes = (
        _formula_cost(tmp_path / f"{name}.safetensors")["encoding_bytes"] for name in ("halves", "codes")
    )
    assert codes == halves / 2


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_a_killed_sweep_goes_on_where_it_was(sweep, data, grid, tmp_path):
    slow = {"n-frequencies": 2, "steps": 4000, "checkpoint": 0.05}
    each = [{"encoding": "frequency", "n-frequencies": 1}, {"encoding": "frequency", **slow}]
    path = grid({"common": COMMON, "grids": each})
    out, whole = tmp_path / "out", tmp_path / "whole"
    command = [sys.executable, "-m", "irradia", "sweep", str(data), "-o", str(out), "--grid", str(path)]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    last = next(run.name for run in read_grid(str(path), {}) if "K2" in run.name)
    checkpoint = out / "runs" / last / "field.checkpoint.npz"
    _wait_for(checkpoint.is_file)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert len(sweep(data, "-o", out, "--grid", path, "--list")[1]["rows"]) == 1
    _wait_until_still(checkpoint)
    code, said = sweep(data, "-o", out, "--grid", path)
    assert (code, said["rows"][1]["steps"]) == (0, 4000)
    sweep(data, "-o", whole, "--grid", path)
    fields = [folder / "runs" / last / "field.safetensors" for folder in (out, whole)]
    assert fields[0].read_bytes() == fields[1].read_bytes()


def _wait_until_still(checkpoint):
    """The training that a killed sweep had started ends by itself."""
    before = checkpoint.stat().st_mtime_ns
    time.sleep(1.0)
    assert checkpoint.stat().st_mtime_ns == before, "its training lives on"


def _wait_for(condition, limit_s=60.0):
    end = time.monotonic() + limit_s
    while not condition():
        assert time.monotonic() < end, "nothing came"
        time.sleep(0.05)
