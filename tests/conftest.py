"""What every test may rely on: a cache of its own and the shared assets."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from irradia.core.files import write_atomic

ROOT = Path(__file__).resolve().parents[1]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leaves tests of the GPU out where there is none; pytest counts them as deselected."""
    from irradia.core.device import cuda_status

    if cuda_status().optix:
        return
    left_out = [item for item in items if item.get_closest_marker("cuda")]
    items[:] = [item for item in items if item not in left_out]
    config.hook.pytest_deselected(items=left_out)


@pytest.fixture(scope="session", autouse=True)
def _own_cache(tmp_path_factory):
    """Keeps the user's cache out of the tests, and the tests out of the user's cache."""
    if "IRRADIA_CACHE" in os.environ:
        yield
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("IRRADIA_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session")
def repo_root() -> Path:
    """The checkout's top folder."""
    return ROOT


@pytest.fixture(scope="session")
def shared_assets() -> Path:
    """Models and HDRIs beside the checkout, or where ``IRRADIA_ASSETS`` says. A test that wants
    them fails without them.
    """
    folder = Path(os.environ.get("IRRADIA_ASSETS", ROOT.parent / "shared" / "assets"))
    if not folder.is_dir():
        pytest.fail(f"shared assets are missing: {folder} (set IRRADIA_ASSETS)")
    return folder


@pytest.fixture(scope="session")
def cpu_device():
    """Makes Dr.Jit usable in this process; tests that trace ask for it before importing."""
    from irradia.core.device import prepare

    return prepare("cpu")


@pytest.fixture(scope="session")
def web_check(tmp_path_factory):
    """Runs one of web/checks in node: ``web_check("validate", *arguments)`` gives its JSON.

    Fails where node or the packages of web/ are missing; ``make setup-dev`` installs both.
    """
    node, compiler = _node_and_compiler()
    for package in ("runtime", "three"):  # in the order of their imports
        folder = ROOT / "web" / "packages" / package
        _build(folder, folder / "dist", tmp_path_factory.mktemp(package))
    subprocess.run([node, compiler, "--project", ROOT / "web"], check=True)

    def run(name: str, *arguments: Path | str) -> Any:
        command = [node, ROOT / "web" / "dist" / "checks" / f"{name}.js", *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
        if done.returncode:
            pytest.fail(f"web check {name} failed:\n{done.stderr}")
        return json.loads(done.stdout)

    return run


@pytest.fixture(scope="session")
def runtime_node(tmp_path_factory):
    """Builds @irradia/runtime with its tests, and runs node on those: ``runtime_node("print-baked.js", …)``
    gives what the finished process printed, and its return code.
    """
    node, _ = _node_and_compiler()
    package = ROOT / "web" / "packages" / "runtime"
    for project, out in ((package, package / "dist"), (package / "test", package / "build")):
        _build(project, out, tmp_path_factory.mktemp(out.name))

    def run(*arguments: Path | str) -> subprocess.CompletedProcess[str]:
        command = [node, *map(str, arguments)]
        return subprocess.run(
            command, cwd=package / "build", capture_output=True, text=True, timeout=300, check=False
        )

    return run


def _node_and_compiler() -> tuple[str, Path]:
    node = shutil.which("node")
    compiler = ROOT / "web" / "node_modules" / "typescript" / "bin" / "tsc"
    if node is None or not compiler.is_file():
        pytest.fail("node or web/node_modules is missing: run `make setup-dev`")
    return node, compiler


def _build(project: Path, out: Path, built: Path) -> None:
    """Compiles into ``built``, then replaces files of ``out``, whole and only where they changed: several
    processes of a run may do so at once.
    """
    node, compiler = _node_and_compiler()
    subprocess.run([node, compiler, "--project", project, "--outDir", built], check=True)
    for source in built.rglob("*.*"):
        target = out / source.relative_to(built)
        if not target.exists() or target.read_bytes() != source.read_bytes():
            with write_atomic(target) as stream:
                stream.write(source.read_bytes())


@pytest.fixture(scope="session")
def chromium() -> str:
    """The browser that draws; fails where there is none, as ``make setup-dev`` installs one."""
    from irradia.cli.machine import find_chromium

    program = find_chromium()
    if program is None:
        pytest.fail("chromium is missing: run `make setup-dev`, or set IRRADIA_CHROMIUM")
    return program
