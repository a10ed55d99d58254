"""A lightmap to measure on: read from a file, or baked by the command line."""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from irradia.formats.lightmap import LightmapFile, read_lightmap

SCENES = ("builtin:cornell", "builtin:atrium")


def parse_arguments(description: str | None) -> argparse.Namespace:
    """The command line of a benchmark that measures on lightmaps."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--scene", nargs="+", default=SCENES, help="a scene to bake, or a lightmap.exr")
    parser.add_argument("--resolution", type=int, default=1024, help="page edge in texels")
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--repeats", type=int, default=3)
    return parser.parse_args()


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
