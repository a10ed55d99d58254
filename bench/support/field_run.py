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
from irradia.field.files import load_field, save_field
from irradia.field.presets import PRESETS, Preset
from irradia.field.quantise import FinishOptions, finish, train_on
from irradia.field.quantised import Bits
from irradia.field.registry import print_spec
from irradia.field.spec import FieldSpec
from irradia.formats.samples import open_samples
from support.field_rows import Row, Rows

SEVERAL_BITS = "hash-200kB"  # the preset that is rounded in three ways, and whose leaks are measured
BASELINES = "sh1,sh2,visibility,lightmap"  # beside the hash grids, in as many bytes
SH_MODE = FieldSpec(HashGrid(8, 17, 2, 16, 512), None, 32, 2, mode="sh1", head="linear")
"""As one row of the Unity project's table, which names the same architecture."""
INDIRECT = ("--quantity", "indirect")  # the sun and lamps are drawn live, as engines do
BLOCK = 16  # values to a scale of 4 bits; one scale for a whole level costs twice as much FLIP
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
        presets = {SEVERAL_BITS: PRESETS[SEVERAL_BITS]} if place.leaks_only else PRESETS
        for name, preset in presets.items():
            if only is None or name in only or _kind(name) in only:
                self._preset(place, name, preset)
        if place.spec == "builtin:atrium" and (only is None or "sh-mode" in only):
            self._sh_mode(place)

    def _preset(self, place: Place, name: str, preset: Preset) -> None:
        """One training, and what comes of it in so many bits."""
        self._field(place, name, name, preset, preset.bits)
        if name == SEVERAL_BITS and not place.leaks_only:
            for bits in (4, None):
                self._field(place, f"bits-{bits or 16} of {name}", name, preset, bits)

    def _field(self, place: Place, row: str, name: str, preset: Preset, bits: Bits | None) -> None:
        if self._rows.has(scene_name(place.spec), row, asdict(self._settings)):
            return
        trained = self._folder(place) / f"{name}.{self._settings.train_s:g}s.safetensors"
        data = self._samples(place, "volume")
        how = self._train(data, trained, preset)
        weights = self._folder(place) / f"{row.replace(' ', '-')}.safetensors.zst"
        _round(trained, weights, bits, data, preset.batch_size)
        beside = BASELINES if row == name and _kind(name) == "hash" and not place.leaks_only else "none"
        judged = self._judge(place, weights, beside)
        field, *rivals = judged["rivals"]
        self._keep(place, row, {"trained": how, "query": judged["query"], **_figures(field)})
        for rival in rivals:
            self._keep(place, f"{rival['key']} beside {name}", _figures(rival))

    def _sh_mode(self, place: Place) -> None:
        name = "sh-mode"
        if self._rows.has(scene_name(place.spec), name, asdict(self._settings)):
            return
        plain = self._folder(place) / f"{name}.{self._settings.train_s:g}s.safetensors"
        weights = plain.with_name(f"{name}.safetensors.zst")
        data, preset = self._samples(place, "sh-random"), Preset(SH_MODE, None)
        trained = self._train(data, plain, preset)
        _round(plain, weights, None, data, preset.batch_size)
        self._keep(place, name, {"trained": trained, "n_bytes": weights.stat().st_size})

    def _samples(self, place: Place, kind: str) -> Path:
        path = self._folder(place) / f"{kind}.samples"
        if not path.exists():
            s = self._settings
            amount = ["--count", str(s.samples), "--samples", str(s.rays)]
            _irradia("sample", place.spec, "-o", path, "--kind", kind, *amount, *INDIRECT, *place.light)
        return path

    def _train(self, data: Path, weights: Path, preset: Preset) -> dict[str, Any]:
        """Trains, unless that was done; returns what is worth keeping of it."""
        summary = weights.with_suffix(".json")
        if not summary.exists():
            spec = weights.with_suffix(".spec.json")
            spec.write_text(print_spec(preset.spec), encoding="utf-8")
            how = ["--time", self._settings.train_s, "--batch-size", preset.batch_size, "--precision", "fp32"]
            how += ["--lr-encoding", preset.lr_encoding, "--lr-network", preset.lr_network]
            done = _irradia("train", data, "-o", weights, "--spec", spec, *how)
            kept = ("train_s", "steps", "batch_size", "validation", "parameters", "samples_per_s", "backend")
            summary.write_text(json.dumps({key: done[key] for key in kept}), encoding="utf-8")
        return json.loads(summary.read_text(encoding="utf-8"))

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
        s = self._settings
        folder = self._work / scene_name(place.spec) / f"{s.samples}x{s.rays}"
        folder.mkdir(parents=True, exist_ok=True)
        return folder


def _round(trained: Path, weights: Path, bits: Bits | None, data: Path, batch_size: int) -> None:
    """Writes a trained field with its tables in so many bits, or as halves after as many steps more."""
    field, samples = load_field(trained), open_samples(data)
    options = FinishOptions(block=BLOCK if bits == 4 else 0, batch_size=batch_size)
    save_field(weights, finish(field, bits, samples, options) if bits else train_on(field, samples, options))


def scene_name(spec: str) -> str:
    """``cornell`` of ``builtin:cornell``, ``Helmet`` of ``…/Helmet.gltf``."""
    return spec.removeprefix("builtin:") if spec.startswith("builtin:") else Path(spec).stem


def _kind(name: str) -> str:
    return name.split("-", maxsplit=1)[0]


def _figures(judged: dict[str, Any]) -> Row:
    kept = {key: judged[key] for key in ("n_bytes", "flip", "space", "leaks", "views")}
    return {**kept, "label": judged["name"], "pixels": "scene"}  # before, whole pictures were scored


def _irradia(*arguments: object) -> dict[str, Any]:
    """Runs a command in a process of its own and returns what it printed with ``--json``."""
    command = [sys.executable, "-m", "irradia", *map(str, arguments), "--json"]
    print("$ irradia", shlex.join(command[3:]), file=sys.stderr, flush=True)
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        sys.exit(f"{shlex.join(command)} ended with {done.returncode}")
    return json.loads(done.stdout)
