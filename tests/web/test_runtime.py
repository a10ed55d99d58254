"""@irradia/runtime passes its own tests in node."""

from __future__ import annotations

from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parents[2] / "web" / "packages" / "runtime" / "test"
NAMES = sorted(path.name.removesuffix(".test.ts") for path in TESTS.glob("*.test.ts"))


@pytest.mark.parametrize("name", NAMES)
def test_package_passes(runtime_node, name: str) -> None:
    done = runtime_node("--test", "--test-reporter=spec", f"{name}.test.js")
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    assert "tests 0" not in done.stdout
