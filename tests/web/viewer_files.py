"""Files for the viewer to open, good ones and damaged ones, without a bake."""

from __future__ import annotations

import base64
import gzip
import json
import struct
from pathlib import Path

import numpy as np
import zstandard

from irradia.core.rng import Seed
from irradia.export.field_extension import put_field
from irradia.field.bin_writer import encode_bin
from irradia.field.encodings import HashGrid, Identity
from irradia.field.field import Field
from irradia.field.init import new_parameters
from irradia.field.native_fields import encode_field
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.formats.exr import write_exr_rgb
from irradia.formats.hdr import write_hdr
from irradia.formats.png import write_png
from irradia.scene.framing import look_at, save_camera
from irradia.scene.load import load_scene
from irradia.scene.types import Camera

from .made_light import FIELDS, bounds, made_field, write_made_scene

SCENE = "cornell"
CAMERA_EYE = (0.1, 0.4, -0.9)
CUT = ("glb", "safetensors", "safetensors.zst", "bin", "hdr", "exr", "png")


def write_files(folder: Path) -> dict[str, Path]:
    """All of them, by name."""
    _write_scene(folder / "scene.glb")
    _write_fields(folder)
    _write_pictures(folder)
    pose = look_at(np.array(CAMERA_EYE), np.array((0.28, 0.27, 0.28)))
    save_camera(
        Camera(world_from_camera=pose, yfov_rad=0.7, aspect=16 / 9, name="corner"), folder / "camera.json"
    )
    _write_damaged(folder)
    return {path.name: path for path in folder.iterdir()}


def _write_scene(path: Path) -> None:
    write_made_scene(path, SCENE, "sh")
    # The smallest: software renderers take seconds to compile a wide one, for each view anew.
    data = made_field(FIELDS["identity"], bounds(load_scene(f"builtin:{SCENE}")))
    put_field(path, zstandard.ZstdCompressor().compress(data))


def _write_fields(folder: Path) -> None:
    """One field in three files; a .bin has no SH of the normal."""
    position = HashGrid(n_levels=2, log2_table_size=8, base_resolution=2, max_resolution=8)
    spec = FieldSpec(position, Identity(), 16, 2)
    frame = FieldFrame(bounds(load_scene(f"builtin:{SCENE}")), 1.0, "full")
    field = Field(spec, frame, new_parameters(spec, Seed(7)))
    data = encode_field(field)
    (folder / "field.safetensors").write_bytes(data)
    (folder / "field.safetensors.zst").write_bytes(zstandard.ZstdCompressor().compress(data))
    (folder / "field.bin").write_bytes(encode_bin(field))


def _write_pictures(folder: Path) -> None:
    y, x = np.mgrid[:36, :64] / 64
    rgb = np.stack([x, y, 1 - x], axis=-1).astype(np.float32)
    write_png(folder / "render.png", np.round(rgb * 255).astype(np.uint8))
    write_hdr(folder / "render.hdr", rgb)
    write_exr_rgb(folder / "render.exr", rgb)
    write_hdr(folder / "sky.hdr", np.full((16, 32, 3), (0.2, 0.4, 0.8), np.float32))


def _write_damaged(folder: Path) -> None:
    names = {"glb": "scene", "hdr": "render", "exr": "render", "png": "render"}
    for suffix in CUT:
        whole = (folder / f"{names.get(suffix, 'field')}.{suffix}").read_bytes()
        (folder / f"cut.{suffix}").write_bytes(whole[: len(whole) // 2])
    (folder / "empty.glb").write_bytes(b"")
    (folder / "notes.txt").write_text("not a scene", encoding="utf-8")
    (folder / "no-json.glb").write_bytes(struct.pack("<4sIIII", b"glTF", 2, 28, 8, 0x4E4F534A) + b"{]      ")
    (folder / "light.glb").write_bytes(_without_light((folder / "scene.glb").read_bytes()))
    weights = bytearray((folder / "field.safetensors").read_bytes())
    weights[-2:] = b"\x00\x7c"  # infinity as a half float
    (folder / "infinite.safetensors").write_bytes(weights)


def _without_light(scene: bytes) -> bytes:
    """The scene with zeros in place of its lightmap."""
    start, length = 20, struct.unpack_from("<I", scene, 12)[0]
    document = json.loads(scene[start : start + length])
    view = document["bufferViews"][document["extensions"]["IRRADIA_lighting"]["lightmap"]["bufferView"]]
    damaged = bytearray(scene)
    at = start + length + 8 + view.get("byteOffset", 0)
    damaged[at : at + view["byteLength"]] = bytes(view["byteLength"])
    return bytes(damaged)


def write_kept_page(page: str, files: dict[str, Path], target: Path) -> None:
    """A viewer's page with a scene, a field and a render inside it, as ``export --single-file`` writes it."""
    camera = {"worldFromCamera": np.eye(4).T.ravel().tolist(), "yfovRad": 0.7, "aspect": 1.5, "name": "front"}
    camera["worldFromCamera"][12:15] = [0.3, 0.2, -0.5]
    reference = {"name": "traced", "url": "r.hdr", "kind": "hdr", "camera": camera}
    scene = {"name": "room", "url": "s.glb", "fields": [{"name": "small", "url": "f.safetensors"}]}
    manifest = {"format": "irradia-manifest", "version": 1, "scenes": [{**scene, "references": [reference]}]}
    parts = [f'<script type="application/json" id="irradia-manifest">{json.dumps(manifest)}</script>']
    for url, name in (
        ("s.glb", "scene.glb"),
        ("f.safetensors", "field.safetensors"),
        ("r.hdr", "render.hdr"),
    ):
        text = base64.b64encode(gzip.compress(files[name].read_bytes())).decode()
        parts.append(
            f'<script type="text/plain" data-irradia-file="{url}" data-encoding="gzip">{text}</script>'
        )
    charset = '<meta charset="utf-8">'
    target.write_text(page.replace(charset, charset + "".join(parts)), encoding="utf-8")
