"""What does baked light cost a page? Frames in each source of light against frames with the lightmap.

    python bench/web_cost.py [--scene builtin:cornell] [--size 160x90] [--rounds 5] [--backends webgpu webgl]

The presets of irradia.field.presets (with random weights, which take as long as trained ones), probes and
the lightmap light the same view of the same baked scene in Chromium, in turns. Each source is evaluated by
the materials (inline), and fields and probes also by a pass over the screen, once a pixel (full) and at half
resolution (half). Times are of whole frames, until the GPU is done, as ratios to the lightmap's frame in the
same round. Without a GPU, Chromium draws on the CPU: then ratios exaggerate arithmetic.

Operations and fetches are counted by formula, for one evaluation; bytes are of textures and uniforms.

Then pages are timed from their address to the first picture, in turns: plain three.js under even light, and
with the baked light. Results go to ``bench/results/web_cost.md``.
"""

from __future__ import annotations

import argparse
import json
import platform
import shlex
import shutil
import statistics
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np

from irradia.cli.machine import find_chromium
from irradia.core import write_text_atomic
from irradia.core.device import cpu_name
from irradia.core.provenance import source_commit
from irradia.core.rng import Seed
from irradia.export.read_baked import read_baked
from irradia.field.field import Field
from irradia.field.init import new_parameters
from irradia.field.native_fields import encode_field
from irradia.field.presets import PRESETS, Preset
from irradia.field.quantise import round_tables
from irradia.field.spec import FieldFrame
from irradia.scene.merge import merge
from support.web_cost_page import CostPage, Row

ROOT = Path(__file__).resolve().parents[1]
RESULTS = Path(__file__).parent / "results"
LIGHTMAP, PROBES = "lightmap", "probes"
HOWS = ("inline", "full", "half")


def main() -> None:
    """Bakes, times and writes the table."""
    arguments = _parse()
    arguments.work.mkdir(parents=True, exist_ok=True)
    scene = _baked(arguments)
    fields = _fields(scene, arguments.work)
    _build()
    view = _view(scene, arguments.size)
    answers = _time_frames(arguments, scene, fields, view)
    first = _time_first_pictures(arguments, scene, view)
    page = CostPage(_rows(answers, fields), answers, first, _facts(arguments, answers))
    write_text_atomic(RESULTS / "web_cost.md", page.markdown())
    print(page.markdown())


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--scene", default="builtin:cornell")
    parser.add_argument("--size", type=_size, default=(160, 90), help="of the picture, in pixels")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--first", type=int, default=5, help="rounds of first pictures")
    backends = ("webgpu", "webgl", "webgl2")
    parser.add_argument("--backends", nargs="+", default=["webgpu", "webgl"], choices=backends)
    parser.add_argument("--presets", nargs="+", default=list(PRESETS), choices=PRESETS)
    parser.add_argument("--work", type=Path, default=Path("out/web-cost"))
    return parser.parse_args()


def _size(text: str) -> tuple[int, int]:
    width, height = text.split("x")
    return int(width), int(height)


def _baked(arguments: argparse.Namespace) -> Path:
    """The scene with a lightmap and a grid of probes; noise changes nothing here."""
    command = [sys.executable, "-m", "irradia", "bake", arguments.scene, "-o", str(arguments.work / "baked")]
    command += ["--resolution", "512", "--samples", "4", "--no-report"]
    command += ["--probes", "auto", "--probe-samples", "64"]
    path = arguments.work / "baked" / "scene.baked.glb"
    if not path.is_file():
        subprocess.run(command, check=True)
    return path


def _fields(scene: Path, folder: Path) -> dict[str, Path]:
    """A file for each preset, its box the scene's."""
    positions = merge(read_baked(str(scene)).scene).positions
    box = np.stack([positions.min(axis=0), positions.max(axis=0)]).astype(np.float32)
    paths = {name: folder / f"{name}.safetensors" for name in PRESETS}
    for name, path in paths.items():
        path.write_bytes(_field(PRESETS[name], box))
    return paths


def _field(preset: Preset, box: np.ndarray) -> bytes:
    parameters = new_parameters(preset.spec, Seed(1))
    if "position" in parameters:
        shape = parameters["position"].shape
        parameters["position"] = Seed(2).numpy().uniform(-0.5, 0.5, shape).astype(np.float32)
    field = Field(preset.spec, FieldFrame(box), parameters)
    return encode_field(field if preset.bits is None else round_tables(field, preset.bits, 0))


def _build() -> None:
    """Compiles the packages of web/ and its checks."""
    web = ROOT / "web"
    for project in ("packages/runtime", "packages/three", "."):
        compiler = web / "node_modules" / "typescript" / "bin" / "tsc"
        subprocess.run([_node(), compiler, "--project", web / project], check=True)


def _node() -> str:
    node = shutil.which("node")
    if node is None:
        raise SystemExit("node is missing: run `make setup-dev`")
    return node


def _view(scene: Path, size: tuple[int, int]) -> dict[str, Any]:
    camera = read_baked(str(scene)).scene.cameras[0]
    matrix = camera.world_from_camera.T.ravel().tolist()
    return {"width": size[0], "height": size[1], "worldFromCamera": matrix, "yfovRad": camera.yfov_rad}


def _time_frames(
    arguments: argparse.Namespace, scene: Path, fields: dict[str, Path], view: dict[str, Any]
) -> list[dict[str, Any]]:
    sources = [LIGHTMAP, PROBES, *arguments.presets]
    request = {
        "scene": "/scene.glb",
        "view": view,
        "fields": {name: f"/{fields[name].name}" for name in arguments.presets},
        "sources": sources,
        "screened": sources[1:],
        "rounds": arguments.rounds,
    }
    requests = arguments.work / "requests.json"
    requests.write_text(json.dumps([{"backend": name, **request} for name in arguments.backends]))
    served = [f"/scene.glb={scene}", *(f"/{path.name}={path}" for path in fields.values())]
    answers = _check("cost", requests, _chromium(), *served)
    for wanted, answer in zip(arguments.backends, answers, strict=True):
        if answer["backend"] != wanted:
            raise SystemExit(f"expected to draw by {wanted}, drew by {answer['backend']}")
    return answers


def _time_first_pictures(
    arguments: argparse.Namespace, scene: Path, view: dict[str, Any]
) -> dict[str, list[float]]:
    path = arguments.work / "view.json"
    path.write_text(json.dumps(view))
    return _check("first-picture", scene, path, str(arguments.first), arguments.work, _chromium())


def _check(name: str, *arguments: Path | str) -> Any:
    command = [_node(), ROOT / "web" / "dist" / "checks" / f"{name}.js", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"web check {name} failed:\n{done.stderr[-4000:]}")
    return json.loads(done.stdout)


def _chromium() -> str:
    program = find_chromium()
    if program is None:
        raise SystemExit("chromium is missing: run `make setup-dev`, or set IRRADIA_CHROMIUM")
    return program


def _rows(answers: Sequence[dict[str, Any]], fields: dict[str, Path]) -> list[Row]:
    """One for each source, its ratios by backend and way."""
    costs = answers[0]["costs"]
    names = list(dict.fromkeys(timing["source"] for timing in answers[0]["timings"]))
    return [
        Row(
            name,
            file_bytes=fields[name].stat().st_size if name in fields else None,
            **costs[name],
            ratios={answer["backend"]: _ratios(answer, name) for answer in answers},
        )
        for name in names
    ]


def _ratios(answer: dict[str, Any], name: str) -> dict[str, list[float]]:
    times = {(timing["source"], timing["how"]): timing["milliseconds"] for timing in answer["timings"]}
    base = times[LIGHTMAP, "inline"]
    return {
        how: [ms / b for ms, b in zip(times[name, how], base, strict=True)]
        for how in HOWS
        if (name, how) in times
    }


def _facts(arguments: argparse.Namespace, answers: Sequence[dict[str, Any]]) -> list[str]:
    width, height = arguments.size
    frames = ", ".join(f"{answer['backend']} {_lightmap_ms(answer):.1f} ms" for answer in answers)
    return [
        f"Machine: {cpu_name()}, {platform.system()}, Python {platform.python_version()}; no GPU is used",
        f"Commit: {source_commit()}; date: {time.strftime('%Y-%m-%d')}",
        f"Scene: {arguments.scene}, its first camera, {width} × {height} pixels; with the lightmap a frame "
        f"takes {frames}",
        "Backends: webgpu and webgl2 are WebGPURenderer's two, webgl is WebGLRenderer",
        f"Runs: {arguments.rounds} rounds of one frame each in turns, {arguments.first} of first pictures; "
        "medians of ratios within a round, with the extreme rounds",
        f"Command: `{shlex.join(['python', 'bench/web_cost.py', *sys.argv[1:]])}`",
    ]


def _lightmap_ms(answer: dict[str, Any]) -> float:
    found = next(t for t in answer["timings"] if (t["source"], t["how"]) == (LIGHTMAP, "inline"))
    return statistics.median(found["milliseconds"])


if __name__ == "__main__":
    main()
