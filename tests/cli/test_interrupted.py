"""Runs that Ctrl-C has ended early say so alike: exit code 130, ``ok`` false, ``interrupted`` true."""

from __future__ import annotations

import json

import pytest

from irradia.bake.shards import Shard
from irradia.cli import app
from irradia.cli.bake_job import BakeJob, BakeSummary
from irradia.cli.job_json import job_to_json

_HALF = {"complete": False, "out": "x", "rows": [], "failed": [], "n_runs": 1}


@pytest.fixture
def stopped(monkeypatch, tmp_path):
    """Has all work end early; gives the files that command lines name."""
    for name in ("a.samples", "a.npz"):
        (tmp_path / name).write_bytes(b"")
    part = Shard(1, 1, job_to_json(BakeJob("builtin:cornell", tmp_path)), {}, "", {}, (), 0.0)
    summary = BakeSummary({}, (), complete=False)
    monkeypatch.setattr("irradia.cli.bake_job.run_bake", lambda *_, **__: summary)
    monkeypatch.setattr("irradia.cli.bake.describe", lambda *_: "")
    monkeypatch.setattr("irradia.bake.shards.read_shard", lambda _: part)
    monkeypatch.setattr("irradia.bake.shards.in_order", list)
    monkeypatch.setattr("irradia.cli.sample_job.run_sampling", lambda *_: dict(_HALF))
    monkeypatch.setattr("irradia.cli.train_run.run_training", lambda *_: dict(_HALF))
    monkeypatch.setattr("irradia.cli.train.describe", lambda _: "")
    monkeypatch.setattr("irradia.cli.sweep_job.run_sweep", lambda *_: dict(_HALF))
    monkeypatch.setattr("irradia.cli.sweep_arguments.check_arguments", lambda *_: None)
    return tmp_path


@pytest.mark.parametrize(
    "arguments",
    [
        ("bake", "builtin:cornell", "-o", "out"),
        ("demo",),
        ("merge", "a.npz", "-o", "out"),
        ("sample", "builtin:cornell", "-o", "b.samples"),
        ("train", "a.samples", "-o", "a.safetensors"),
        ("sweep", "a.samples", "-o", "out", "--grid", "pareto"),
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_run_that_was_stopped_says_so(stopped, monkeypatch, capfd, arguments):
    monkeypatch.chdir(stopped)
    assert app.run([*arguments, "--json"]) == app.INTERRUPTED
    said = json.loads(capfd.readouterr().out)
    assert (said["ok"], said["interrupted"]) == (False, True)
