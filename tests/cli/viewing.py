"""A viewer to stand in for the built one, and folders of results to show in it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irradia.export import web_viewer
from irradia.export.web_views import write_views
from irradia.scene.framing import look_at
from irradia.scene.types import Camera

ROOT = Path(__file__).resolve().parents[2]
WEIGHTS = ROOT / "vectors" / "hash-fp32.safetensors"
PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>viewer</title>
<link rel="stylesheet" href="./viewer.css">
<script type="module" src="./viewer.js"></script>
</head>
<body></body>
</html>
"""
# What it shows of itself is enough to see that files arrive whole.
SCRIPT = """
const embedded = document.getElementById("irradia-manifest");
const meta = document.querySelector('meta[name="irradia-manifest"]');
async function open(url) {
  const element = document.querySelector(`script[data-irradia-file="${CSS.escape(url)}"]`);
  if (!element) return (await fetch(url)).arrayBuffer();
  const blob = new Blob([Uint8Array.from(atob(element.textContent), (c) => c.charCodeAt(0))]);
  if (element.dataset.encoding === "identity") return blob.arrayBuffer();
  return new Response(blob.stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}
async function show() {
  const manifest = embedded ? JSON.parse(embedded.textContent) : await (await fetch(meta.content)).json();
  const sizes = {};
  for (const scene of manifest.scenes) {
    for (const file of [scene, ...scene.fields, ...scene.references]) {
      sizes[file.url] = (await open(file.url)).byteLength;
    }
  }
  return { title: manifest.title, sizes, remark: "</script><!-- in a text" };
}
const root = document.documentElement;
root.dataset.state = "loading";
show().then(
  (found) => { document.body.textContent = JSON.stringify(found); root.dataset.state = "ready"; },
  (error) => { root.dataset.message = String(error); root.dataset.state = "error"; },
);
"""


@pytest.fixture
def viewer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a small viewer that is taken for the built one."""
    folder = write_viewer(tmp_path / "viewer")
    monkeypatch.setattr(web_viewer, "PLACES", (folder,))
    return folder


def write_viewer(folder: Path) -> Path:
    """A viewer that shows what it has read."""
    folder.mkdir(exist_ok=True)
    (folder / "index.html").write_text(PAGE)
    (folder / "viewer.js").write_text(SCRIPT)
    (folder / "viewer.css").write_text("body { margin: 0 }\n")
    return folder


def write_results(folder: Path, scene: str = "box", n_views: int = 1) -> Path:
    """A folder as a bake leaves it: a .glb (here without anything in it), a field, references."""
    folder.mkdir(parents=True)
    (folder / "scene.baked.glb").write_bytes(glb())
    shutil.copyfile(WEIGHTS, folder / "field.safetensors")
    cameras = [
        Camera(look_at(np.array([i, 1.0, 3.0]), np.zeros(3)), 0.7, 2.0, f"camera {i}") for i in range(n_views)
    ]
    pictures = [np.full((4, 8, 3), 0.25, np.float32)] * n_views
    record: dict[str, Any] = {"scene": scene, "views": write_views(folder, cameras, pictures, 64)}
    (folder / "bake.json").write_text(json.dumps(record))
    return folder


def glb() -> bytes:
    """The smallest .glb."""
    text = b'{"asset":{"version":"2.0"}} '
    size = (12 + 8 + len(text)).to_bytes(4, "little")
    head = b"glTF" + (2).to_bytes(4, "little") + size
    return head + len(text).to_bytes(4, "little") + b"JSON" + text
