"""``irradia doctor``."""

from __future__ import annotations

import json
import re
import tomllib

import pytest

from irradia.cli import app, machine
from irradia.cli.machine import Check
from irradia.core.device import CudaStatus
from irradia.core.errors import MissingDependencyError
from irradia.field.backends import backend, matrix, matrix_text


def test_this_machine_is_ready_to_bake(capfd):
    assert app.run(["doctor", "--json"]) == 0
    said = json.loads(capfd.readouterr().out)
    assert said["ready"] is True
    states = {check["name"]: check["state"] for check in said["checks"]}
    assert states["Python"] == states["libLLVM"] == states["Denoiser"] == "ok"
    assert {"CUDA, OptiX", "Node.js", "Chromium", "Cache", "Packages"} <= set(states)


def test_the_backends_of_fields_are_listed(capfd):
    assert app.run(["doctor", "--json"]) == 0
    table = json.loads(capfd.readouterr().out)["field_backends"]
    assert table == matrix()
    assert app.run(["doctor"]) == 0
    shown = capfd.readouterr().out
    assert matrix_text() in shown
    assert f"--backend auto starts with {backend('auto').name}" in shown


def test_something_missing_is_exit_code_2_with_the_cure(monkeypatch, capfd):
    monkeypatch.setattr(
        "irradia.cli.doctor.check_all", lambda: [Check("libLLVM", "missing", "none was found", "apt-get it")]
    )
    assert app.run(["doctor"]) == 2
    shown = capfd.readouterr().out
    assert "MISSING  libLLVM" in shown
    assert "apt-get it" in shown
    assert "Not ready: 1 to mend" in shown


def test_what_only_some_uses_need_does_not_fail(monkeypatch, capfd):
    monkeypatch.setattr("irradia.cli.doctor.check_all", lambda: [Check("Node.js", "optional", "absent", "x")])
    assert app.run(["doctor"]) == 0
    assert "Ready to bake." in capfd.readouterr().out


def test_no_libllvm_shows_the_install_line(monkeypatch):
    def nothing():
        raise MissingDependencyError("none was found", fix="the line")

    monkeypatch.setattr(machine, "find_libllvm", nothing)
    assert machine.check_libllvm() == Check("libLLVM", "missing", "none was found", "the line")


def test_an_absent_package_is_named(monkeypatch):
    monkeypatch.setattr(machine, "PACKAGES", ("numpy", "no_such_package"))
    check = machine.check_packages()
    assert check.state == "missing"
    assert check.found == "absent: no_such_package"


def test_every_dependency_of_the_core_install_is_looked_for(repo_root):
    project = tomllib.loads((repo_root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    names = {re.split(r"[<>=]", entry)[0] for entry in project["dependencies"]}
    imported = {"pillow": "PIL", "flip-evaluator": "flip_evaluator"}
    assert {imported.get(name, name) for name in names} == set(machine.PACKAGES)


def test_an_old_python_is_refused(monkeypatch):
    monkeypatch.setattr(machine.sys, "version_info", (3, 10, 2))
    assert machine.check_python().state == "missing"


def test_a_gpu_without_optix_says_which_library_is_missing(monkeypatch):
    monkeypatch.setattr(machine, "cuda_status", lambda: CudaStatus("GPU", False, "its OptiX library is not"))
    check = machine.check_cuda()
    assert check.state == "optional"
    assert "OptiX library" in check.found
    assert "libnvoptix" in check.fix


@pytest.mark.parametrize(
    ("version", "state"), [("v16.1.0", "optional"), ("v18.0.0", "ok"), ("v120.1.1", "ok")]
)
def test_nodes_version_decides(monkeypatch, version, state):
    class Done:
        returncode = 0
        stdout = version + "\n"

    monkeypatch.setattr(machine.shutil, "which", lambda name: "/bin/node")
    monkeypatch.setattr(machine, "_run", lambda command: Done)
    assert machine.check_node().state == state


def test_without_node_the_cure_is_named(monkeypatch):
    monkeypatch.setattr(machine.shutil, "which", lambda name: None)
    check = machine.check_node()
    assert check.state == "optional"
    assert "nodejs" in check.fix


def test_a_cache_that_cannot_be_written_is_reported(monkeypatch, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("IRRADIA_CACHE", str(blocked / "below"))
    assert machine.check_cache().state == "optional"


def test_the_named_browser_must_exist(monkeypatch, tmp_path):
    monkeypatch.setenv("IRRADIA_CHROMIUM", str(tmp_path / "none"))
    assert machine.find_chromium() is None
