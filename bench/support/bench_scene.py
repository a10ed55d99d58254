"""The scene that both sides bake: matte, lit as the command line lights it, laid out once."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

from irradia.cli.lighting import LightOptions, light_scene
from irradia.core.progress import silent_progress
from irradia.scene.layout import LightmapLayout
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
from irradia.scene.load import load_scene
from irradia.scene.types import Scene
from support.bake_task import matte_twin


def load_bench_scene(spec: str, resolution_px: int) -> tuple[Scene, LightmapLayout]:
    """A scene as ``irradia bake`` would see it but for speculars, on one page."""
    scene = matte_twin(light_scene(load_scene(spec), LightOptions()))
    return scene, layout_lightmap(scene, LayoutOptions(resolution=resolution_px), silent_progress())


def save_bench_scene(path: Path, scene: Scene, layout: LightmapLayout) -> None:
    """Keeps both for :mod:`support.irradia_bake`, so that every bake has the very same layout."""
    path.write_bytes(pickle.dumps((replace(scene, document=None), layout)))


def read_bench_scene(path: Path) -> tuple[Scene, LightmapLayout]:
    """What :func:`save_bench_scene` kept a moment ago; not for files from elsewhere."""
    return pickle.loads(path.read_bytes())
