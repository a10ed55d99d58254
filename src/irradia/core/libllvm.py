"""Finds a system libLLVM that Dr.Jit can compile with.

Tried with Dr.Jit 1.5: 19 and 22 work, 14 is refused, 15 and 16 abort the process on the first
minimum or maximum. So candidates are taken newest first, none older than 17, and each is asked in
a process of its own (:mod:`irradia.core.llvm_probe`, half a second); a yes is remembered until the
file or Dr.Jit changes.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from irradia.core.cache import cache_dir
from irradia.core.errors import InputError, MissingDependencyError
from irradia.core.files import write_text_atomic

VARIABLE = "DRJIT_LIBLLVM_PATH"
OLDEST_MAJOR = 17
PROBE_TIMEOUT_S = 120.0

_LINUX_FOLDERS = (
    "/usr/lib/*-linux-gnu",
    "/usr/lib/llvm-*/lib",
    "/usr/lib/llvm*/lib",
    "/usr/lib64",
    "/usr/lib64/llvm*/lib",
    "/usr/lib",
    "/usr/local/lib",
    "/opt/llvm*/lib",
)
_MAC_FOLDERS = (
    "/opt/homebrew/opt/llvm*/lib",
    "/usr/local/opt/llvm*/lib",
    "/opt/local/libexec/llvm-*/lib",
)
_PATTERNS = {
    "linux": ("libLLVM*.so*",),
    "darwin": ("libLLVM*.dylib",),
    "win32": ("LLVM-C.dll", "LLVM*.dll"),
}
_VERSION = re.compile(r"(?:libLLVM[-.](?:so\.)?|llvm[-@]?)(\d+)", re.IGNORECASE)


@dataclass(frozen=True)
class Candidate:
    """A libLLVM on this machine.

    Attributes:
        path: The file, links resolved.
        major: Version by its name; None where the name has none.
    """

    path: Path
    major: int | None


@dataclass(frozen=True)
class Verdict:
    """Whether a candidate works, and if not, why."""

    candidate: Candidate
    works: bool
    reason: str


def find_libllvm() -> Verdict:
    """The newest libLLVM that works; one named by ``DRJIT_LIBLLVM_PATH`` goes first and alone.

    Raises:
        InputError: If the variable names a library that does not work.
        MissingDependencyError: If no library works; the message lists those that were tried.
    """
    named = os.environ.get(VARIABLE)
    if named:
        return _named(named)
    refused: list[Verdict] = []
    for candidate in candidates():
        verdict = judge(candidate)
        if verdict.works:
            return verdict
        refused.append(verdict)
    raise MissingDependencyError(_nothing_works(refused), fix=install_line())


def candidates() -> list[Candidate]:
    """Every libLLVM in the places where systems keep it, newest first, each file once."""
    found: dict[Path, Candidate] = {}
    for folder in _folders():
        for pattern in _PATTERNS.get(sys.platform, _PATTERNS["linux"]):
            for path in folder.glob(pattern):
                resolved = path.resolve()
                if resolved.is_file():
                    found.setdefault(resolved, Candidate(resolved, major_version(resolved)))
    return sorted(found.values(), key=lambda c: (-(c.major or 0), str(c.path)))


def major_version(path: Path) -> int | None:
    """The major version in a library's name, or else in the folders above it."""
    for part in reversed(path.parts):
        match = _VERSION.search(part)
        if match:
            return int(match.group(1))
    return None


def judge(candidate: Candidate) -> Verdict:
    """Asks the candidate, unless it is known to be too old or remembered to work."""
    if candidate.major is not None and candidate.major < OLDEST_MAJOR:
        return Verdict(candidate, False, f"LLVM {candidate.major} is older than {OLDEST_MAJOR}")
    key = _fingerprint(candidate.path)
    if key in _remembered():
        return Verdict(candidate, True, "worked before")
    reason = probe(candidate.path)
    if reason:
        return Verdict(candidate, False, reason)
    _remember(key)
    return Verdict(candidate, True, "its probe gave the right numbers")


def probe(path: Path) -> str:
    """Compiles a few kernels in a process of its own; "" if they give the right numbers."""
    from irradia.core.llvm_probe import ANSWER

    environment = {**os.environ, VARIABLE: str(path)}
    command = [sys.executable, "-m", "irradia.core.llvm_probe"]
    try:
        done = subprocess.run(
            command,
            env=environment,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=PROBE_TIMEOUT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"its probe did not end in {PROBE_TIMEOUT_S:.0f} s"
    if done.returncode == 0 and done.stdout.strip() == ANSWER:
        return ""
    last = (done.stderr.strip().splitlines() or ["no message"])[-1]
    return f"its probe ended with code {done.returncode}: {last}"


def install_line() -> str:
    """What to run here to get a libLLVM that works."""
    if sys.platform == "darwin":
        return "brew install llvm"
    if sys.platform == "win32":
        return "winget install LLVM.LLVM"
    return (
        "Debian, Ubuntu: sudo apt-get install libllvm19 libatomic1 · Fedora: sudo dnf install llvm-libs "
        "libatomic · Arch: sudo pacman -S llvm-libs · without root: conda install llvmdev, "
        f"or set {VARIABLE} to a libLLVM of version {OLDEST_MAJOR} or newer"
    )


def _named(name: str) -> Verdict:
    path = Path(name)
    if not path.is_file():
        raise InputError("no such library", where=f"{VARIABLE}={name}", fix=f"unset {VARIABLE} to search")
    verdict = judge(Candidate(path.resolve(), major_version(path.resolve())))
    if not verdict.works:
        raise InputError(verdict.reason, where=f"{VARIABLE}={name}", fix=f"unset {VARIABLE} to search")
    return verdict


def _nothing_works(refused: list[Verdict]) -> str:
    if not refused:
        return "Dr.Jit needs a system libLLVM and none was found"
    lines = "".join(f"\n    {v.candidate.path}: {v.reason}" for v in refused)
    return f"Dr.Jit needs a system libLLVM and none of these works:{lines}"


def _folders() -> list[Path]:
    """Folders that may hold a libLLVM, this Python environment's own first."""
    own = [Path(sys.prefix) / "lib", Path(sys.prefix) / "Library" / "bin"]
    if sys.platform == "win32":
        installed = Path(os.environ.get("PROGRAMFILES", "C:/Program Files")) / "LLVM" / "bin"
        on_path = [Path(p) for p in os.environ.get("PATH", "").split(os.pathsep) if p]
        return [f for f in (*own, installed, *on_path) if f.is_dir()]
    patterns = _MAC_FOLDERS if sys.platform == "darwin" else _LINUX_FOLDERS
    system = [folder for pattern in patterns for folder in sorted(Path("/").glob(pattern[1:]))]
    return [f for f in (*own, *system, *_ldconfig_folders()) if f.is_dir()]


def _ldconfig_folders() -> list[Path]:
    """Folders of the libraries that the dynamic linker knows; none where it has no cache."""
    for program in ("/sbin/ldconfig", "/usr/sbin/ldconfig"):
        if not Path(program).exists():
            continue
        listing = subprocess.run([program, "-p"], capture_output=True, text=True, check=False).stdout
        paths = (line.rsplit("=> ", 1)[-1] for line in listing.splitlines() if "libLLVM" in line)
        return sorted({Path(p.strip()).parent for p in paths})
    return []


def _remembered() -> list[str]:
    """Fingerprints of libraries that worked. Failures are not kept: they may have been passing."""
    try:
        known = json.loads(_memory().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []
    return [k for k in known if isinstance(k, str)] if isinstance(known, list) else []


def _remember(key: str) -> None:
    # A folder that can't be written costs half a second per run, no more.
    with contextlib.suppress(OSError):
        write_text_atomic(_memory(), json.dumps(sorted({*_remembered(), key}), indent=1))


def _memory() -> Path:
    return cache_dir() / "libllvm.json"


def _fingerprint(path: Path) -> str:
    """Changes with the file and with Dr.Jit."""
    stat = path.stat()
    try:
        drjit = version("drjit")
    except PackageNotFoundError:
        drjit = "none"
    return f"{path}|{stat.st_size}|{stat.st_mtime_ns}|drjit {drjit}"
