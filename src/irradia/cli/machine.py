"""The checks behind ``irradia doctor``: each says what it found and how to mend it."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from irradia.core.cache import cache_dir
from irradia.core.device import CUDA_FIX, cuda_status
from irradia.core.errors import InputError
from irradia.core.libllvm import find_libllvm

OLDEST_PYTHON = (3, 11)
OLDEST_NODE = 18
PACKAGES = (
    "click",
    "DracoPy",
    "drjit",
    "flip_evaluator",
    "mitsuba",
    "numba",
    "numpy",
    "OpenEXR",
    "PIL",
    "pyoidn",
    "safetensors",
    "scipy",
    "xatlas",
    "zstandard",
)
CHROMIUM_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


@dataclass(frozen=True)
class Check:
    """One answer.

    Attributes:
        name: What was looked at.
        state: ``ok``; ``missing`` if baking needs it; ``optional`` if only some uses do.
        found: What is there, or why it doesn't do.
        fix: How to mend it; "" where nothing needs mending.
    """

    name: str
    state: Literal["ok", "missing", "optional"]
    found: str
    fix: str = ""


def check_all() -> list[Check]:
    """Every check, what baking needs first."""
    checks: tuple[Callable[[], Check], ...] = (
        check_python,
        check_packages,
        check_libllvm,
        check_denoiser,
        check_cache,
        check_cuda,
        check_node,
        check_chromium,
    )
    return [check() for check in checks]


def check_python() -> Check:
    """Python's version."""
    found = ".".join(map(str, sys.version_info[:3]))
    if sys.version_info >= OLDEST_PYTHON:
        return Check("Python", "ok", found)
    wanted = ".".join(map(str, OLDEST_PYTHON))
    return Check("Python", "missing", found, f"Install Python {wanted} or newer, then run make setup.")


def check_packages() -> Check:
    """The libraries of the core install, looked up without importing them."""
    absent = [name for name in PACKAGES if importlib.util.find_spec(name) is None]
    if not absent:
        return Check("Packages", "ok", f"all {len(PACKAGES)} of the core install")
    return Check("Packages", "missing", "absent: " + ", ".join(absent), "pip install irradia")


def check_libllvm() -> Check:
    """The library that compiles CPU kernels."""
    try:
        verdict = find_libllvm()
    except InputError as error:
        return Check("libLLVM", "missing", error.message, error.fix or "")
    return Check("libLLVM", "ok", f"{verdict.candidate.path} ({verdict.reason})")


def check_denoiser() -> Check:
    """Open Image Denoise, asked in a process of its own because it loads large weights."""
    code = "import pyoidn; d = pyoidn.Device(); d.commit(); d.release()"
    done = _run([sys.executable, "-c", code])
    if done is not None and done.returncode == 0:
        return Check("Denoiser", "ok", "Open Image Denoise starts")
    reason = "it did not answer" if done is None else (done.stderr.strip().splitlines() or ["it failed"])[-1]
    return Check("Denoiser", "missing", reason, "pip install pyoidn, or bake with --no-denoise.")


def check_cache() -> Check:
    """Whether unwraps and answers can be kept."""
    folder = cache_dir()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        return Check(
            "Cache", "optional", f"{folder}: {error.strerror}", "Set IRRADIA_CACHE to a folder of yours."
        )
    return Check("Cache", "ok", str(folder))


def check_cuda() -> Check:
    """An NVIDIA GPU with OptiX."""
    status = cuda_status()
    if status.gpu and status.optix:
        return Check("CUDA, OptiX", "ok", status.gpu)
    return Check("CUDA, OptiX", "optional", f"{status.problem}; the CPU does everything", CUDA_FIX)


def check_node() -> Check:
    """Node.js, which the web packages and their tests need."""
    program = shutil.which("node")
    done = _run([program, "--version"]) if program else None
    version = done.stdout.strip() if done and done.returncode == 0 else ""
    fix = f"Install Node.js {OLDEST_NODE} or newer; Debian 12, Ubuntu 24.04: sudo apt-get install nodejs npm"
    if not version:
        return Check("Node.js", "optional", "absent; only the web packages need it", fix)
    if int(version.lstrip("v").split(".")[0]) < OLDEST_NODE:
        return Check("Node.js", "optional", f"{version} is older than {OLDEST_NODE}", fix)
    return Check("Node.js", "ok", f"{version} ({program})")


def check_chromium() -> Check:
    """A browser for the tests of what is drawn in one."""
    program = find_chromium()
    if program:
        return Check("Chromium", "ok", program)
    fix = "Debian: sudo apt-get install chromium, or set IRRADIA_CHROMIUM to a browser."
    return Check("Chromium", "optional", "absent; only the web tests need it", fix)


def find_chromium() -> str | None:
    """The browser of ``IRRADIA_CHROMIUM``, else the first on the path."""
    override = os.environ.get("IRRADIA_CHROMIUM")
    if override:
        return override if Path(override).is_file() else None
    return next((path for name in CHROMIUM_NAMES if (path := shutil.which(name))), None)


def _run(command: list[str]) -> subprocess.CompletedProcess[str] | None:
    try:
        return subprocess.run(
            command, capture_output=True, text=True, errors="replace", timeout=60, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
