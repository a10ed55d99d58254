"""A real bake in stock three.js against our own picture of it, from the scene's camera."""

from __future__ import annotations

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
        # Shade under a sun of 100 klx: 8 bits have few codes for it.
        ("builtin:atrium", 512, []),
        ("builtin:blocks", 256, ["--compatible"]),
    ],
)
def test_three_js_is_as_bright_as_our_own_picture(
    draw_in_three_js, tmp_path: Path, scene: str, resolution: int, options: list[str]
) -> None:
    irradia(
        "bake",
        scene,
        "-o",
        tmp_path / "out",
        "--resolution",
        f"{resolution}",
        "--samples",
        "16",
        "--no-report",
        *options,
    )
    baked = tmp_path / "out" / "scene.baked.glb"
    size = ("--width", f"{WIDTH_PX}", "--height", f"{HEIGHT_PX}", "--spp", "64")
    irradia("render", baked, "--baked", "-o", tmp_path / "ours.exr", "--camera", "0", *size)
    camera = document_to_scene(read_document(baked)).cameras[0]
    view = {
        "width": WIDTH_PX,
        "height": HEIGHT_PX,
        "yfovRad": camera.yfov_rad,
        "worldFromCamera": np.asarray(camera.world_from_camera).T.ravel().tolist(),
    }
    theirs, ours = draw_in_three_js(baked, view), read_image(tmp_path / "ours.exr")
    # Background and lamps are no lightmap; at edges three.js has one sample and we have 64.
    grey = ours.sum(axis=-1)
    lamp = grey > 10.0 * np.median(grey[grey > 0.0])
    smooth = is_smooth(ours) & is_smooth(theirs) & ~lamp
    assert smooth.sum() > 0.3 * np.count_nonzero(grey)
    ratio = theirs[smooth].mean(axis=0) / ours[smooth].mean(axis=0)
    assert np.all(np.abs(ratio - 1.0) < MAX_ERROR), ratio
    per_pixel = theirs[smooth].sum(axis=-1) / ours[smooth].sum(axis=-1)
    assert np.all(np.abs(np.percentile(per_pixel, [10, 90]) - 1.0) < MAX_ERROR)


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
