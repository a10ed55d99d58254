"""What every test may rely on: a cache of its own and the shared assets."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


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
