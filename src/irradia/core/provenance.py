"""Where an artefact comes from: enough to make it again, or to see why one can't."""

from __future__ import annotations

import hashlib
import platform
import subprocess
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import irradia
from irradia.core.device import Device

# Libraries whose version can change a result.
KEY_LIBRARIES = ("mitsuba", "drjit", "numpy", "numba", "pyoidn", "xatlas", "scipy", "flip-evaluator")


@dataclass(frozen=True)
class Provenance:
    """What made an artefact.

    Attributes:
        irradia: Version of this program.
        commit: Commit of its checkout, with ``-modified`` if files differ; None outside a checkout.
        command: The command's name.
        config: Every option that shapes the result, defaults written out.
        seed: The root seed.
        inputs: SHA-256 by input name.
        libraries: Version by name, of those in ``KEY_LIBRARIES`` that are installed.
        device: Kind, name, threads and LLVM of the processor, or None where nothing was traced.
        python, system: Versions of what it ran on.
        created: UTC, ISO 8601.
        wall_s: Wall time of the whole command.
    """

    irradia: str
    commit: str | None
    command: str
    config: dict[str, Any]
    seed: int | None
    inputs: dict[str, str]
    libraries: dict[str, str]
    device: dict[str, Any] | None
    python: str
    system: str
    created: str
    wall_s: float

    def to_dict(self) -> dict[str, Any]:
        """Plain values, ready for JSON."""
        return asdict(self)

    def reproducible(self) -> dict[str, Any]:
        """As :meth:`to_dict`, without what differs between runs that give the same result: the time
        it took, when, and on how many threads. Files whose bytes must agree carry this.
        """
        plain = asdict(self)
        for key in ("created", "wall_s"):
            del plain[key]
        for holder in (plain["config"], plain["device"] or {}):
            holder.pop("threads", None)
        return plain


def record(
    command: str,
    config: Mapping[str, Any],
    *,
    seed: int | None,
    inputs: Mapping[str, str],
    device: Device | None,
    wall_s: float,
) -> Provenance:
    """Gathers the provenance of a result that has just been made."""
    return Provenance(
        irradia=irradia.__version__,
        commit=source_commit(),
        command=command,
        config=dict(config),
        seed=seed,
        inputs=dict(inputs),
        libraries=library_versions(),
        device=_device_dict(device),
        python=platform.python_version(),
        system=f"{platform.system()} {platform.release()} {platform.machine()}",
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        wall_s=round(wall_s, 3),
    )


def library_versions() -> dict[str, str]:
    """Installed versions of the libraries that can change a result."""
    found = {}
    for name in KEY_LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def source_commit() -> str | None:
    """The commit that this package is run from, or None when it is installed apart from a checkout."""
    top = Path(irradia.__file__).resolve().parents[2]
    if not (top / ".git").exists():
        return None
    commit = _git(top, "rev-parse", "HEAD")
    if not commit:
        return None
    modified = _git(top, "status", "--porcelain", "--untracked-files=no", "--", "src")
    return f"{commit}-modified" if modified else commit


def sha256_bytes(*parts: bytes) -> str:
    """SHA-256 of the parts, each preceded by its length so that no boundary can shift."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()


def sha256_file(path: Path | str) -> str:
    """SHA-256 of a file's bytes, as ``sha256sum`` prints it."""
    with Path(path).open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _device_dict(device: Device | None) -> dict[str, Any] | None:
    if device is None:
        return None
    library = device.libllvm.name if device.libllvm else None
    return {
        "kind": device.kind,
        "name": device.name,
        "threads": device.threads,
        "libllvm": library,
        "llvm": device.llvm_major,
    }


def _git(top: Path, *arguments: str) -> str:
    """Output of a git command, or "" where git is absent or refuses."""
    try:
        done = subprocess.run(
            ["git", "-C", str(top), *arguments],
            capture_output=True,
            text=True,
            timeout=10,
            check=False,
            stdin=subprocess.DEVNULL,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
