"""Where an artefact comes from."""

from __future__ import annotations

import hashlib
import json
import subprocess

import irradia
from irradia.core import provenance
from irradia.core.device import Device


def _record(**changes):
    arguments = {"seed": 7, "inputs": {"scene": "ab"}, "device": None, "wall_s": 1.23456} | changes
    return provenance.record("bake", {"samples": 64}, **arguments)


def test_a_record_holds_all_that_is_needed_to_make_the_result_again():
    made = _record(device=Device("cpu", "Some CPU", 2)).to_dict()
    assert made["irradia"] == irradia.__version__
    assert made["seed"] == 7
    assert made["config"] == {"samples": 64}
    assert made["inputs"] == {"scene": "ab"}
    assert made["device"]["name"] == "Some CPU"
    assert made["wall_s"] == 1.235
    assert made["libraries"]["mitsuba"]
    assert set(made["libraries"]) <= set(provenance.KEY_LIBRARIES)


def test_a_record_is_plain_json():
    made = _record(device=Device("cpu", "Some CPU", 2)).to_dict()
    assert json.loads(json.dumps(made)) == made


def test_equal_runs_on_other_threads_have_equal_reproducible_records():
    records = []
    for threads in (1, 2):
        made = provenance.record(
            "bake",
            {"samples": 64, "threads": threads},
            seed=7,
            inputs={},
            device=Device("cpu", "Some CPU", threads),
            wall_s=float(threads),
        )
        records.append(made.reproducible())
    assert records[0] == records[1]
    assert records[0]["config"] == {"samples": 64}


def test_the_commit_is_the_checkouts(repo_root):
    head = subprocess.run(
        ["git", "-C", str(repo_root), "rev-parse", "HEAD"], capture_output=True, text=True, check=True
    )
    assert provenance.source_commit() in (head.stdout.strip(), head.stdout.strip() + "-modified")


def test_there_is_no_commit_outside_a_checkout(tmp_path, monkeypatch):
    package = tmp_path / "lib" / "irradia" / "__init__.py"
    package.parent.mkdir(parents=True)
    package.write_text("")
    monkeypatch.setattr(irradia, "__file__", str(package))
    assert provenance.source_commit() is None


def test_a_files_hash_is_that_of_sha256sum(tmp_path):
    path = tmp_path / "data"
    path.write_bytes(b"light" * 100_000)
    assert provenance.sha256_file(path) == hashlib.sha256(b"light" * 100_000).hexdigest()


def test_moving_a_byte_over_a_boundary_changes_the_hash():
    assert provenance.sha256_bytes(b"ab", b"c") != provenance.sha256_bytes(b"a", b"bc")
