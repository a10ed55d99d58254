"""How well and how fast is the BC6H encoder, by how many partitions it tries?

    python bench/bc6h.py [--scene SCENE|LIGHTMAP.exr ...] [--resolution 1024] [--samples 256] [--repeats 3]

Errors are of texels that charts cover, in units of the map's scale: PSNR of linear values with peak 1 (the
99.9th percentile lies there), and of base-2 logarithms with a peak of 8 stops, the range over which
DARK = 2⁻⁸ lets errors count. MB/s are of the half floats that go in, 6 bytes a texel, on all cores.
"""

from __future__ import annotations

import argparse
import math
import platform
import shlex
import statistics
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np
from numpy.typing import NDArray

from irradia.core import write_text_atomic
from irradia.core.device import cpu_name
from irradia.core.provenance import source_commit
from irradia.export.map_files import texel_weights
from irradia.formats.bc6h import DARK, decode_bc6h, encode_bc6h
from irradia.formats.lightmap import LightmapFile
from support.baked_lightmap import lightmap_of, parse_arguments

PARTITIONS = (0, 1, 4, 8, 32)
STOPS = -math.log2(DARK)
TEXEL_BYTES = 6
RESULTS = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Row:
    """One map at one effort.

    Attributes:
        seconds: Of each run.
    """

    source: str
    n_partitions: int
    psnr_db: float
    log2_psnr_db: float
    rmse_stops: float
    mean_ratio: float
    megabytes: float
    seconds: tuple[float, ...]


def main() -> None:
    """Measures, prints and writes the table."""
    arguments = parse_arguments(__doc__)
    encode_bc6h(np.ones((8, 8, 3), np.float32))  # compiles
    rows = []
    for source in arguments.scene:
        lightmap = lightmap_of(source, arguments.resolution, arguments.samples)
        rows += [_measure(source, lightmap, n, arguments.repeats) for n in PARTITIONS]
    text = _markdown(rows, arguments)
    write_text_atomic(RESULTS / "bc6h.md", text)
    print(text)


def _measure(source: str, lightmap: LightmapFile, n_partitions: int, repeats: int) -> Row:
    page = lightmap.pages[0] / np.float32(lightmap.scale)
    covered = lightmap.covered[0]
    weights = texel_weights(lightmap, 0)
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        blocks = encode_bc6h(page, weights, n_partitions=n_partitions)
        seconds.append(time.perf_counter() - start)
    back = decode_bc6h(blocks, *page.shape[:2])[covered].astype(np.float64)
    truth = page[covered].astype(np.float64)
    stops = np.log2(np.maximum(back, DARK)) - np.log2(np.maximum(truth, DARK))
    return Row(
        source=Path(source).name if source.endswith(".exr") else source,
        n_partitions=n_partitions,
        psnr_db=_psnr(back - truth, 1.0),
        log2_psnr_db=_psnr(stops, STOPS),
        rmse_stops=float(np.sqrt(np.mean(stops**2))),
        mean_ratio=float(back.mean() / truth.mean()),
        megabytes=page.shape[0] * page.shape[1] * TEXEL_BYTES / 1e6,
        seconds=tuple(seconds),
    )


def _psnr(error: NDArray[np.float64], peak: float) -> float:
    return 10.0 * math.log10(peak**2 / float(np.mean(error**2)))


def _markdown(rows: list[Row], arguments: argparse.Namespace) -> str:
    lines = [
        "# The BC6H encoder",
        "",
        "| map | partitions | PSNR | PSNR of log2 | RMSE in stops | mean ratio | MB/s | slowest – fastest |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        rates = sorted(row.megabytes / seconds for seconds in row.seconds)
        lines.append(
            f"| {row.source} | {row.n_partitions} | {row.psnr_db:.2f} dB | {row.log2_psnr_db:.2f} dB | "
            f"{row.rmse_stops:.4f} | {row.mean_ratio:.5f} | {statistics.median(rates):.1f} | "
            f"{rates[0]:.1f} – {rates[-1]:.1f} |"
        )
    facts = [
        f"Machine: {cpu_name()}, {platform.system()}, Python {platform.python_version()}",
        f"Commit: {source_commit()}; date: {time.strftime('%Y-%m-%d')}",
        "PSNR of linear values over the scale, peak 1; of log2 of values raised to 2⁻⁸, peak 8 stops",
        "MB/s: of half floats in, 6 bytes a texel, all cores",
        f"Runs: {arguments.repeats} each, medians; texels that charts cover",
        f"Command: `{shlex.join(['python', 'bench/bc6h.py', *sys.argv[1:]])}`",
    ]
    return "\n".join([*lines, "", *(f"- {fact}" for fact in facts)]) + "\n"


if __name__ == "__main__":
    main()
