"""Rays from a pinhole camera."""

from __future__ import annotations

import math

from irradia.scene.types import Camera
from irradia.transport.backend import dr, mi


def camera_ray(
    camera: Camera, width: int, height: int, pixel: mi.UInt32, jitter: mi.Point2f
) -> tuple[mi.Point3f, mi.Vector3f]:
    """A ray through a place of a pixel: its origin and unit direction.

    Args:
        camera: Where from; its aspect gives way to that of the picture.
        width: Of the picture, in pixels.
        height: Likewise.
        pixel: Number, row by row from the top left.
        jitter: The place, in [0, 1)².
    """
    row = pixel // width
    column = pixel - row * width
    scale = 2.0 * math.tan(camera.yfov_rad / 2.0) / height
    x = (mi.Float(column) + jitter.x - 0.5 * width) * scale
    y = (0.5 * height - mi.Float(row) - jitter.y) * scale
    m = [[float(v) for v in row] for row in camera.world_from_camera]
    direction = mi.Vector3f(*[m[i][0] * x + m[i][1] * y - m[i][2] for i in range(3)])
    return mi.Point3f(*[m[i][3] for i in range(3)]), dr.normalize(direction)
