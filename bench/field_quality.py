"""How good is a field of 50 kB, 200 kB, 1 MB? Hash grids, tri-planes and frequencies on three scenes.

    python bench/field_quality.py --model MODEL.gltf --env SKY.hdr     everything
    python bench/field_quality.py --scene builtin:cornell              one scene
    python bench/field_quality.py --only hash-200kB                    one preset, on all scenes
    python bench/field_quality.py --report                             only the page, from what is there

Fields hold indirect light: what the sun and punctual lamps send first is drawn live beside them. Each
scene is sampled once; then every preset (irradia.field.presets) is trained for --train-s seconds, its
tables are rounded and its file is judged by `irradia eval`: HDR-FLIP from the scene's first camera, and MSE
at random places in free space. Beside the hash grids stand grids of SH probes and a lightmap in as many
bytes. One preset is kept in 4 and 16 bits too, its leak ratio is measured in builtin:rooms, and on the atrium
a field learns coefficients of SH.

A row is kept as soon as it is measured (bench/results/field_quality.jsonl), and what has a row is not
measured again, so that the benchmark can be stopped and taken up. Samples and fields lie in --work.

Results go to ``bench/results/field_quality.md`` and ``.svg``.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from irradia.core import write_text_atomic
from support.field_page import quality_page
from support.field_plot import plot_flip_over_bytes
from support.field_rows import Rows
from support.field_run import Bench, Place, Settings, scene_name
from support.on_ground import put_on_ground

RESULTS = Path(__file__).parent / "results"
BUILTIN = ("builtin:cornell", "builtin:atrium")
ROOMS = "builtin:rooms"


def main() -> None:
    """Measures what has no row yet, then writes the page and the plot."""
    arguments = _parse()
    rows = Rows(arguments.results / "field_quality.jsonl")
    if not arguments.report:
        bench = Bench(arguments.work, rows, _settings(arguments))
        for place in _places(arguments):
            bench.measure(place, arguments.only)
    plot_flip_over_bytes(rows.all(), arguments.results / "field_quality.svg")
    page = quality_page(rows.all(), sys.argv[1:])
    write_text_atomic(arguments.results / "field_quality.md", page)
    print(page)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--scene", nargs="+", help="of these alone")
    parser.add_argument("--only", nargs="+", help="presets, or hash, triplane, frequency, bits, sh-mode")
    parser.add_argument("--model", type=Path, help="a .gltf that is put on a ground")
    parser.add_argument("--env", type=Path, help="the environment that lights it")
    parser.add_argument("--train-s", type=float, default=75.0, help="seconds of training a point")
    parser.add_argument("--samples", type=int, default=1_000_000, help="points to learn from")
    parser.add_argument("--rays", type=int, default=64, help="at each")
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--work", type=Path, default=Path("out/field-quality"))
    parser.add_argument("--results", type=Path, default=RESULTS)
    parser.add_argument("--report", action="store_true", help="measure nothing")
    return parser.parse_args()


def _settings(arguments: argparse.Namespace) -> Settings:
    return Settings(arguments.train_s, arguments.samples, arguments.rays, arguments.reference_spp)


def _places(arguments: argparse.Namespace) -> list[Place]:
    """The scenes, the rooms last: they are for leaks alone."""
    wanted = arguments.scene or [*BUILTIN, *([str(arguments.model)] if arguments.model else []), ROOMS]
    places = []
    for spec in wanted:
        if spec.startswith("builtin:"):
            places.append(Place(spec, leaks_only=spec == ROOMS))
        else:
            path = put_on_ground(Path(spec), arguments.work / scene_name(spec) / "scene")
            places.append(Place(str(path), env=arguments.env))
    return places


if __name__ == "__main__":
    main()
