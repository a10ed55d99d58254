"""A lightmap to measure on: read from a file, or baked by the command line."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from irradia.formats.lightmap import LightmapFile, read_lightmap


def lightmap_of(source: str, resolution: int, samples: int) -> LightmapFile:
    """Reads ``source`` where it ends in .exr, else bakes it as a scene."""
    if source.endswith(".exr"):
        return read_lightmap(source)
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "irradia", "bake", source, "-o", folder, "--no-report"]
        command += ["--resolution", str(resolution), "--samples", str(samples)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"the bake failed:\n{done.stderr[-4000:]}")
        return read_lightmap(Path(folder) / "lightmap.exr")
