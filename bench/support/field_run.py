"""Runs the steps of a field by its command line: sample, train, judge."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from irradia.core.device import cpu_name
from irradia.core.provenance import source_commit
from irradia.field.encodings import HashGrid
from irradia.field.presets import PRESETS, Preset
from irradia.field.registry import print_spec
from irradia.field.spec import FieldSpec
from support.field_rows import Row, Rows

EIGHTH = "hash-200kB"  # the preset that is rounded in three ways, and whose leaks are measured
BASELINES = "sh1,sh2,visibility,lightmap"  # beside the hash grids, in as many bytes
SH_MODE = FieldSpec(HashGrid(8, 17, 2, 16, 512), None, 32, 2, mode="sh1", head="linear")
"""As one row of the Unity project's table, which names the same architecture."""
N_PIXELS = 512 * 288


@dataclass(frozen=True)
class Settings:
    """What all points have in common.

    Attributes:
        train_s: Seconds of training.
        samples, rays: Points to learn from, and rays at each.
        reference_spp: Of the pictures that are compared with.
    """

    train_s: float
    samples: int
    rays: int
    reference_spp: int


@dataclass(frozen=True)
class Place:
    """A scene.

    Attributes:
        spec: A file or ``builtin:NAME``.
        env: Image that lights it.
        leaks_only: Measures one field, for its leak ratio.
    """

    spec: str
    env: Path | None = None
    leaks_only: bool = False

    @property
    def light(self) -> list[str]:
        """Options of every command."""
        return ["--env", str(self.env)] if self.env else []


class Bench:
    """Measures what has no row yet.

    Args:
        work: Folder for samples and fields.
        rows: What is known.
        settings: Of all points.
    """

    def __init__(self, work: Path, rows: Rows, settings: Settings) -> None:
        self._work, self._rows, self._settings = work, rows, settings

    def measure(self, place: Place, only: list[str] | None) -> None:
        """All rows of a scene, or those that ``only`` names."""
        for name, preset in self._presets(place).items():
            if only is None or name in only or _kind(name) in only:
                self._field(place, name, preset)
        if place.leaks_only:
            return
        if place.spec == "builtin:atrium" and (only is None or "sh-mode" in only):
            self._sh_mode(place)

    def _presets(self, place: Place) -> dict[str, Preset]:
        """Every preset, and one in other bits."""
        if place.leaks_only:
            return {EIGHTH: PRESETS[EIGHTH]}
        spec = PRESETS[EIGHTH].spec
        other = {f"bits-{bits or 16} of {EIGHTH}": Preset(spec, bits) for bits in (4, None)}
        return {**PRESETS, **other}

    def _field(self, place: Place, name: str, preset: Preset) -> None:
        if self._rows.has(scene_name(place.spec), name):
            return
        weights = self._folder(place) / f"{name.replace(' ', '-')}.safetensors.zst"
        trained = self._train(self._samples(place, "volume"), weights, preset)
        beside = BASELINES if name in PRESETS and _kind(name) == "hash" and not place.leaks_only else "none"
        judged = self._judge(place, weights, beside)
        self._keep(
            place, name, {"trained": trained, "query": judged["query"], **_figures(judged["rivals"][0])}
        )
        for rival in judged["rivals"][1:]:
            self._keep(place, f"{rival['key']} beside {name}", _figures(rival))

    def _sh_mode(self, place: Place) -> None:
        name = "sh-mode"
        if self._rows.has(scene_name(place.spec), name):
            return
        weights = self._folder(place) / f"{name}.safetensors"
        trained = self._train(self._samples(place, "sh-random"), weights, Preset(SH_MODE, None))
        self._keep(place, name, {"trained": trained, "n_bytes": weights.stat().st_size})

    def _samples(self, place: Place, kind: str) -> Path:
        path = self._folder(place) / f"{kind}.samples"
        if not path.exists():
            s = self._settings
            amount = ["--count", str(s.samples), "--samples", str(s.rays)]
            _irradia("sample", place.spec, "-o", path, "--kind", kind, *amount, *place.light)
        return path

    def _train(self, data: Path, weights: Path, preset: Preset) -> dict[str, Any]:
        spec = weights.with_suffix(".spec.json")
        spec.write_text(print_spec(preset.spec), encoding="utf-8")
        rounding = [] if preset.bits is None else ["--finish", f"int{preset.bits}"]
        how = ["--time", str(self._settings.train_s), "--batch-size", str(preset.batch_size)]
        how += ["--lr-encoding", str(preset.lr_encoding), "--lr-network", str(preset.lr_network)]
        done = _irradia("train", data, "-o", weights, "--spec", spec, *how, *rounding)
        kept = ("train_s", "steps", "batch_size", "validation", "parameters", "samples_per_s", "backend")
        return {key: done[key] for key in kept}

    def _judge(self, place: Place, weights: Path, baselines: str) -> dict[str, Any]:
        looks = ["--pixels", str(N_PIXELS), "--reference-spp", str(self._settings.reference_spp)]
        camera = ["--camera", "0"] if place.spec.startswith("builtin:") else []
        out = self._folder(place) / "eval" / weights.name
        scene = ["--scene", place.spec, *place.light, *camera]
        return _irradia("eval", weights, *scene, "-o", out, *looks, "--baselines", baselines)

    def _keep(self, place: Place, name: str, values: Row) -> None:
        about = {"commit": source_commit(), "cpu": cpu_name(), "settings": asdict(self._settings)}
        self._rows.add({"scene": scene_name(place.spec), "name": name, **values, **about})

    def _folder(self, place: Place) -> Path:
        folder = self._work / scene_name(place.spec)
        folder.mkdir(parents=True, exist_ok=True)
        return folder


def scene_name(spec: str) -> str:
    """``cornell`` of ``builtin:cornell``, ``Helmet`` of ``…/Helmet.gltf``."""
    return spec.removeprefix("builtin:") if spec.startswith("builtin:") else Path(spec).stem


def _kind(name: str) -> str:
    return name.split("-", maxsplit=1)[0]


def _figures(judged: dict[str, Any]) -> Row:
    kept = {key: judged[key] for key in ("n_bytes", "flip", "space", "leaks", "views")}
    return {**kept, "label": judged["name"]}


def _irradia(*arguments: object) -> dict[str, Any]:
    """Runs a command in a process of its own and returns what it printed with ``--json``."""
    command = [sys.executable, "-m", "irradia", *map(str, arguments), "--json"]
    print("$ irradia", shlex.join(command[3:]), file=sys.stderr, flush=True)
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        sys.exit(f"{shlex.join(command)} ended with {done.returncode}")
    return json.loads(done.stdout)
