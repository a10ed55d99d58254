"""A real bake in stock three.js against our own picture of it, from the scene's camera."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from irradia.formats.image import read_image
from irradia.scene.gltf import document_to_scene, read_document

MAX_ERROR = 0.02
WIDTH_PX, HEIGHT_PX = 192, 144


def irradia(*arguments: str | Path) -> None:
    command = [sys.executable, "-m", "irradia", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, f"exit code {done.returncode} of {command[3]}:\n{done.stderr}"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "resolution", "options"),
    [
        ("builtin:cornell", 256, []),
        ("builtin:blocks", 256, ["--compatible"]),
        # Shade under a sun of 100 klx: 8 bits have few codes for it.
        ("builtin:atrium", 1024, ["--compatible"]),
    ],
)
def test_three_js_is_as_bright_as_our_own_picture(
    draw_in_three_js, tmp_path: Path, scene: str, resolution: int, options: list[str]
) -> None:
    size = ("--resolution", f"{resolution}", "--samples", "16", "--no-report")
    irradia("bake", scene, "-o", tmp_path / "out", *size, *options)
    white = tmp_path / "white.glb"
    white.write_bytes(in_plain_white((tmp_path / "out" / "scene.baked.glb").read_bytes()))
    size = ("--width", f"{WIDTH_PX}", "--height", f"{HEIGHT_PX}", "--spp", "64")
    irradia("render", white, "--baked", "-o", tmp_path / "ours.exr", "--camera", "0", *size)
    camera = document_to_scene(read_document(white)).cameras[0]
    view = {
        "width": WIDTH_PX,
        "height": HEIGHT_PX,
        "yfovRad": camera.yfov_rad,
        "worldFromCamera": np.asarray(camera.world_from_camera).T.ravel().tolist(),
    }
    theirs, ours = draw_in_three_js(white, view), read_image(tmp_path / "ours.exr")
    # Background is no lightmap; at edges three.js has one sample and we have 64.
    smooth = is_smooth(ours) & is_smooth(theirs)
    assert smooth.sum() > 0.15 * np.count_nonzero(ours.sum(axis=-1))
    grey = ours.sum(axis=-1)
    shade = smooth & (grey < np.median(grey[smooth]))
    for where in (smooth, shade):
        ratio = theirs[where].mean(axis=0) / ours[where].mean(axis=0)
        assert np.all(np.abs(ratio - 1.0) < MAX_ERROR), ratio
    per_pixel = theirs[smooth].sum(axis=-1) / ours[smooth].sum(axis=-1)
    assert np.all(np.abs(np.percentile(per_pixel, [10, 90]) - 1.0) < MAX_ERROR)


def in_plain_white(glb: bytes) -> bytes:
    """The file with matte white materials, so that only its lightmap is compared.

    Of a lightmapped surface stock three.js shows the diffuse part alone, and it filters textures in
    its own way.
    """
    end = 20 + int.from_bytes(glb[12:16], "little")
    contents = json.loads(glb[20:end])
    for material in contents["materials"]:
        lightmap = {k: v for k, v in material.get("extensions", {}).items() if k == "MOZ_lightmap"}
        sides = {"doubleSided": material.get("doubleSided", False)}
        material.clear()
        material["pbrMetallicRoughness"] = {"baseColorFactor": [0.7, 0.7, 0.7, 1.0], "metallicFactor": 0.0}
        material["extensions"] = {**lightmap, "KHR_materials_specular": {"specularFactor": 0.0}}
        material.update(sides)
    contents["extensionsUsed"] = sorted({*contents.get("extensionsUsed", []), "KHR_materials_specular"})
    text = json.dumps(contents).encode()
    text += b" " * (-len(text) % 4)
    chunk = len(text).to_bytes(4, "little") + b"JSON" + text + glb[end:]
    return glb[:8] + (12 + len(chunk)).to_bytes(4, "little") + chunk


def is_smooth(image: np.ndarray) -> np.ndarray:
    """Lit pixels that differ little from their neighbours."""
    grey = image.sum(axis=-1)
    padded = np.pad(grey, 1, mode="edge")
    low, high = grey.copy(), grey.copy()
    for y in range(3):
        for x in range(3):
            shifted = padded[y : y + grey.shape[0], x : x + grey.shape[1]]
            low, high = np.minimum(low, shifted), np.maximum(high, shifted)
    return (low > 0.0) & (high < 1.1 * low)
