"""@irradia/three passes its own tests in node; what it draws is tested in browsers."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "web" / "packages" / "three"
NAMES = sorted(path.name.removesuffix(".test.ts") for path in (PACKAGE / "test").glob("*.test.ts"))


@pytest.fixture(scope="module")
def run_test(web_check):  # which builds the runtime that this imports
    """``run_test(name)`` gives what node said of a test and its return code."""
    compiler = PACKAGE.parents[1] / "node_modules" / "typescript" / "bin" / "tsc"
    (PACKAGE / "build").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=PACKAGE / "build") as out:  # where node finds three.js
        subprocess.run(["node", compiler, "--project", PACKAGE / "test", "--outDir", out], check=True)

        def run(name: str) -> subprocess.CompletedProcess[str]:
            test = Path(out) / "test" / f"{name}.test.js"
            return subprocess.run(
                ["node", "--test", "--test-reporter=spec", test],
                capture_output=True,
                text=True,
                timeout=120,
                check=False,
            )

        yield run


@pytest.mark.parametrize("name", NAMES)
def test_package_passes(run_test: Callable[[str], subprocess.CompletedProcess[str]], name: str) -> None:
    done = run_test(name)
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    assert "tests 0" not in done.stdout
