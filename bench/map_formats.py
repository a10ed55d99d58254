"""What does each lightmap format cost, and what does it keep?

    python bench/map_formats.py [--scene SCENE|LIGHTMAP.exr ...] [--resolution 1024] [--samples 256]

Errors are of texels that charts cover and relative to the texel's largest channel; the map's darkest
texels (under 2⁻⁸ of the scale) are left out, since formats of little range keep them absolutely.
"""

from __future__ import annotations

import argparse
import platform
import shlex
import statistics
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np

from irradia.core import write_text_atomic
from irradia.core.device import cpu_name
from irradia.core.provenance import source_commit
from irradia.export.map_files import FORMATS, read_map, write_maps
from irradia.formats.lightmap import LightmapFile
from support.baked_lightmap import lightmap_of, parse_arguments

DARK = 2.0**-8
RESULTS = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Row:
    """One map in one format.

    Attributes:
        bytes_per_texel: Of the file.
        worst, p99, median: Of the relative error.
        write_s, read_s: Of page 0, each run.
    """

    source: str
    name: str
    bytes_per_texel: float
    worst: float
    p99: float
    median: float
    write_s: tuple[float, ...]
    read_s: tuple[float, ...]


def main() -> None:
    """Measures, prints and writes the table."""
    arguments = parse_arguments(__doc__)
    rows = []
    for source in arguments.scene:
        lightmap = lightmap_of(source, arguments.resolution, arguments.samples)
        rows += [_measure(source, lightmap, name, arguments.repeats) for name in FORMATS]
    text = _markdown(rows, arguments)
    write_text_atomic(RESULTS / "map_formats.md", text)
    print(text)


def _measure(source: str, lightmap: LightmapFile, name: str, repeats: int) -> Row:
    write_s, read_s = [], []
    with tempfile.TemporaryDirectory() as folder:
        write_maps(folder, lightmap, (name,))  # compiles
        for _ in range(repeats):
            start = time.perf_counter()
            path = write_maps(folder, lightmap, (name,))[0]
            written = time.perf_counter()
            found = read_map(path)
            write_s.append((written - start) / len(lightmap.pages))
            read_s.append(time.perf_counter() - written)
        size = path.stat().st_size
    truth = lightmap.pages[0]
    largest = truth.max(axis=-1)
    counted = lightmap.covered[0] & (largest > DARK * lightmap.scale)
    error = np.abs(found - truth).max(axis=-1)[counted] / largest[counted]
    return Row(
        source=Path(source).name if source.endswith(".exr") else source,
        name=name,
        bytes_per_texel=size / largest.size,
        worst=float(error.max()),
        p99=float(np.percentile(error, 99)),
        median=float(np.median(error)),
        write_s=tuple(write_s),
        read_s=tuple(read_s),
    )


def _markdown(rows: list[Row], arguments: argparse.Namespace) -> str:
    lines = [
        "# Lightmap formats",
        "",
        "| map | format | bytes a texel, packed | worst error | 99th percentile | median | write | read |",
        "|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row.source} | `{row.name}` | {row.bytes_per_texel:.2f} | {row.worst:.2%} | {row.p99:.2%} | "
        f"{row.median:.3%} | {statistics.median(row.write_s):.2f} s | {statistics.median(row.read_s):.2f} s |"
        for row in rows
    ]
    facts = [
        f"Machine: {cpu_name()}, {platform.system()}, Python {platform.python_version()}",
        f"Commit: {source_commit()}; date: {time.strftime('%Y-%m-%d')}",
        "Errors: of covered texels over 2⁻⁸ of the scale, relative to the texel's largest channel; one page",
        f"Runs: {arguments.repeats} each, medians",
        f"Command: `{shlex.join(['python', 'bench/map_formats.py', *sys.argv[1:]])}`",
    ]
    return "\n".join([*lines, "", *(f"- {fact}" for fact in facts)]) + "\n"


if __name__ == "__main__":
    main()
