"""Modular blocks that adjoin look like one surface."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.seam_points import SeamPoints, find_seam_points
from irradia.metrics.seam import seam_difference

from .lit_scenes import bake, laid_out, lit, places

pytestmark = pytest.mark.usefixtures("cpu_device")

RESOLUTION = 192
_NO_DIFFERENCE = 0.1  # of the reference, which isn't denoised: its noise


def _differences(pages: np.ndarray, points: SeamPoints) -> np.ndarray:
    return seam_difference(pages, points.page, points.position_px)


def test_filtered_light_agrees_across_every_shared_edge():
    scene = lit("blocks")
    layout = laid_out(scene, RESOLUTION)
    mesh, _, _ = places(scene, layout)
    points = find_seam_points(mesh, layout)
    reference = bake(scene, RESOLUTION, 1024, seed=11, seams=False)
    alike = _differences(reference.pages, points) < _NO_DIFFERENCE
    assert alike.mean() > 0.5

    cut = _differences(bake(scene, RESOLUTION, 64, denoise=True, seams=False).pages, points)[alike]
    closed = _differences(bake(scene, RESOLUTION, 64, denoise=True).pages, points)[alike]
    assert cut.max() > 0.02
    assert closed.max() <= 0.005
