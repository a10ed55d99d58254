"""Probes as one sees them in an engine's editor: shaded spheres before a picture of the scene."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from irradia.bake.probes.survey import REACH_IN_SPACINGS
from irradia.core.sh import irradiance
from irradia.formats.probes import EMPTY, FILLED, VALID, ProbeSet
from irradia.scene.types import Camera

F32 = NDArray[np.float32]
_RADIUS = 0.12  # of the spacing
_FILLED_TINT = np.array([1.0, 0.55, 0.1])  # rim of probes that stand in walls


def draw_probes(
    probes: ProbeSet, camera: Camera, image: F32, depth: F32 | None = None, *, radius_m: float | None = None
) -> F32:
    """Draws every probe as a white sphere lit by its own coefficients.

    Args:
        probes: The probes.
        camera: That ``image`` was seen by.
        image: (H, W, 3) linear radiance; a new one is returned.
        depth: (H, W) metres along the camera's axis to what hides probes; None hides none.
        radius_m: Of the spheres; None suits the spacing.

    Returns:
        (H, W, 3) linear radiance: E/π on the spheres. Probes that took their light from neighbours
        have an orange rim, empty ones are left out.
    """
    result = image.copy()
    nearest = np.full(image.shape[:2], np.inf) if depth is None else depth.astype(np.float64).copy()
    world_from_camera = camera.world_from_camera
    places = np.where((probes.state == VALID)[:, None], probes.places, probes.positions)
    offsets = places.astype(np.float64) - world_from_camera[:3, 3]
    local = offsets @ world_from_camera[:3, :3]
    radii = np.full(len(probes), radius_m or 0.0)
    if radius_m is None:
        radii = _RADIUS / REACH_IN_SPACINGS * probes.reach.astype(np.float64)
    shown = np.flatnonzero((local[:, 2] < -2.0 * radii) & (probes.state != EMPTY))
    for probe in shown[np.argsort(local[shown, 2])]:
        _draw_sphere(result, nearest, probes, int(probe), local[probe], float(radii[probe]), camera)
    return result


def _draw_sphere(
    image: F32,
    nearest: NDArray[np.float64],
    probes: ProbeSet,
    probe: int,
    centre: NDArray[np.float64],
    radius: float,
    camera: Camera,
) -> None:
    """One sphere, as the disc that it nearly is; ``image`` and ``nearest`` are changed."""
    height, width = nearest.shape
    focal_px = 0.5 * height / math.tan(0.5 * camera.yfov_rad)
    distance = -float(centre[2])
    column, row = (
        0.5 * width + focal_px * centre[0] / distance,
        0.5 * height - focal_px * centre[1] / distance,
    )
    radius_px = max(focal_px * radius / distance, 0.7)
    x = np.arange(max(math.floor(column - radius_px), 0), min(math.ceil(column + radius_px), width))
    y = np.arange(max(math.floor(row - radius_px), 0), min(math.ceil(row + radius_px), height))
    if len(x) == 0 or len(y) == 0:
        return
    u, v = np.meshgrid((x + 0.5 - column) / radius_px, (row - y - 0.5) / radius_px)
    square = u * u + v * v
    facing = np.sqrt(np.maximum(1.0 - square, 0.0))
    where = np.ix_(y, x)
    visible = (square < 1.0) & (distance - radius * facing < nearest[where])
    normals = np.stack([u, v, facing], axis=-1) @ camera.world_from_camera[:3, :3].T
    shade = irradiance(probes.coefficients[probe], normals) / math.pi
    if probes.state[probe] == FILLED:
        rim = (square > 0.6)[..., None]
        shade = np.where(rim, _FILLED_TINT * max(float(shade.mean()), 1e-3), shade)
    image[where] = np.where(visible[..., None], shade, image[where])
    nearest[where] = np.where(visible, distance - radius * facing, nearest[where])
