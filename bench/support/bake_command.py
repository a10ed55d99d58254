"""Runs ``irradia bake`` as a user does: in a process of its own, by its command line."""

from __future__ import annotations

import json
import platform
import shlex
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from typing import Any

from irradia.core.device import cpu_name
from irradia.core.provenance import source_commit
from support.kept import Kept


@dataclass(frozen=True)
class Run:
    """One finished bake.

    Attributes:
        wall_s: From starting the process to its end.
        result: What it printed with ``--json``.
    """

    wall_s: float
    result: dict[str, Any]

    @property
    def lightmap(self) -> dict[str, Any]:
        """Size and contents of the map."""
        return self.result["lightmap"]


def run_bake(scene: str, *options: str) -> Run:
    """Bakes to a folder that is thrown away; stops the benchmark if that fails."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "irradia", "bake", scene, "-o", f"{folder}/out", "--json", *options]
        start = time.perf_counter()
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        wall_s = time.perf_counter() - start
    if done.returncode:
        sys.exit(f"{shlex.join(command)} ended with {done.returncode}")
    return Run(wall_s, json.loads(done.stdout))


def run_bake_once(steps: Kept, step: str, scene: str, *options: str) -> Run:
    """The same, unless an earlier run of the benchmark has kept it."""
    kept = steps.value(step, lambda: asdict(run_bake(scene, *options)))
    return Run(**kept)


def facts(script: str, threads: int) -> list[str]:
    """What a table was measured on, as Markdown list items."""
    return [
        f"- Machine: {cpu_name()}, {threads} threads, {platform.system()},"
        f" Python {platform.python_version()}",
        f"- Commit: {source_commit()}; date: {time.strftime('%Y-%m-%d')}",
        f"- Command: `{shlex.join(['python', script, *sys.argv[1:]])}`",
    ]
