"""Where to look from: a scene's own camera, a saved one, or one that frames what is there."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from irradia.core.errors import InputError
from irradia.core.files import write_text_atomic
from irradia.scene.interior import find_interior_view
from irradia.scene.merge import merge
from irradia.scene.types import F64, Camera, Rgb, Scene

OUTSIDE_YFOV_RAD = math.radians(30.0)
OUTSIDE_AZIMUTH_DEG = 32.0  # to the right of the front, which in glTF is +Z
OUTSIDE_ELEVATION_DEG = 18.0
OUTSIDE_MARGIN = 1.06
INSIDE_YFOV_RAD = math.radians(62.0)
DEFAULT_ASPECT = 16.0 / 9.0


def camera_from_spec(
    scene: Scene, spec: str | None, aspect: float | None = None, *, where: str = "--camera"
) -> Camera:
    """The camera that ``--camera`` asks for.

    Args:
        scene: Its cameras are numbered from 0.
        spec: An index, a camera's name, a JSON file from :func:`save_camera`, ``auto`` for
            :func:`frame_scene`, or None: the scene's first camera if it has one, else ``auto``.
        aspect: Width over height; None keeps the camera's.
        where: What an error names.

    Raises:
        InputError: No camera matches, or the file is not a camera.
    """
    if spec is None and scene.cameras:
        camera = scene.cameras[0]
    elif spec is None or spec == "auto":
        camera = frame_scene(scene, aspect or DEFAULT_ASPECT)
    elif Path(spec).suffix.lower() == ".json":
        camera = load_camera(spec)
    else:
        camera = _scene_camera(scene, spec, where)
    return replace(camera, aspect=aspect) if aspect else camera


def frame_scene(scene: Scene, aspect: float = DEFAULT_ASPECT) -> Camera:
    """A camera that shows the scene well.

    Rooms are seen from inside, at eye height along their longest view. All else is seen whole from
    its front right and a little above, as close as its vertices allow.

    Raises:
        InputError: The scene has no triangles.
    """
    mesh = merge(scene)
    if len(mesh.indices) == 0:
        raise InputError("there is nothing to look at: the scene has no triangles", where=scene.name)
    view = find_interior_view(mesh)
    if view is not None:
        pose = look_at(view.eye, view.target)
        return Camera(pose, INSIDE_YFOV_RAD, aspect, name="auto")
    used = np.unique(mesh.indices)
    return _frame_from_outside(mesh.positions[used].astype(np.float64), aspect)


def look_at(eye: F64, target: F64) -> F64:
    """(4, 4) world_from_camera that looks from ``eye`` to ``target``: +Y up, +X right if vertical."""
    backward = _unit(eye - target, otherwise=(0.0, 0.0, 1.0))
    right = _unit(np.cross((0.0, 1.0, 0.0), backward), otherwise=(1.0, 0.0, 0.0))
    world_from_camera = np.eye(4)
    world_from_camera[:3, :3] = np.stack([right, np.cross(backward, right), backward], axis=1)
    world_from_camera[:3, 3] = eye
    return world_from_camera


def save_camera(camera: Camera, path: Path | str) -> None:
    """Writes a camera as JSON: :func:`camera_record`."""
    write_text_atomic(path, json.dumps(camera_record(camera), indent=2) + "\n")


def load_camera(path: Path | str) -> Camera:
    """Reads what :func:`save_camera` wrote.

    Raises:
        InputError: The file is absent, no JSON, or no camera.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise _no_camera(path, f"{type(error).__name__}: {error}") from error
    return camera_from_record(content, str(path))


def camera_record(camera: Camera) -> dict[str, Any]:
    """A camera as plain values: ``world_from_camera`` (rows), ``yfov_deg``, ``aspect``, ``name``."""
    return {
        "world_from_camera": camera.world_from_camera.tolist(),
        "yfov_deg": math.degrees(camera.yfov_rad),
        "aspect": camera.aspect,
        "name": camera.name,
    }


def camera_from_record(record: Any, where: str) -> Camera:
    """The camera of a :func:`camera_record`.

    Args:
        record: Whatever was found in its place.
        where: What an error names.

    Raises:
        InputError: It is no camera.
    """
    try:
        pose = np.array(record["world_from_camera"], np.float64)
        yfov_rad = math.radians(float(record["yfov_deg"]))
        aspect = float(record.get("aspect", DEFAULT_ASPECT))
        name = str(record.get("name", ""))
    except (ValueError, KeyError, TypeError) as error:
        raise _no_camera(where, f"{type(error).__name__}: {error}") from error
    if pose.shape != (4, 4) or not np.all(np.isfinite(pose)) or abs(np.linalg.det(pose)) < 1e-9:
        raise _no_camera(where, "world_from_camera must be an invertible 4 × 4 matrix")
    if not (0.0 < yfov_rad < math.pi and 0.0 < aspect < math.inf):
        raise _no_camera(where, "yfov_deg must lie between 0 and 180, and aspect above 0")
    return Camera(pose, yfov_rad, aspect, name)


def _no_camera(path: Path | str, reason: str) -> InputError:
    return InputError(
        f"expected a saved camera, found: {reason}",
        where=str(path),
        fix='A camera file holds {"world_from_camera": 4 rows of 4, "yfov_deg": 45, "aspect": 1.5}.',
    )


def _scene_camera(scene: Scene, spec: str, where: str) -> Camera:
    names = [camera.name for camera in scene.cameras]
    if spec in names:
        return scene.cameras[names.index(spec)]
    if spec.isdecimal() and int(spec) < len(names):
        return scene.cameras[int(spec)]
    listed = ", ".join(f"{index} ({name})" if name else str(index) for index, name in enumerate(names))
    raise InputError(
        f"there is no camera {spec!r}; the scene has {listed or 'none'}",
        where=where,
        fix="Give an index, a name, a saved .json, or 'auto'.",
    )


def _frame_from_outside(points: F64, aspect: float) -> Camera:
    """The nearest position on a fixed viewing direction from which all points are in the picture."""
    azimuth, elevation = math.radians(OUTSIDE_AZIMUTH_DEG), math.radians(OUTSIDE_ELEVATION_DEG)
    backward = np.array(
        [
            math.sin(azimuth) * math.cos(elevation),
            math.sin(elevation),
            math.cos(azimuth) * math.cos(elevation),
        ]
    )
    pose = look_at(backward, np.zeros(3))
    seen = points @ pose[:3, :3]  # along the camera's right, up and backward
    slope_y = math.tan(OUTSIDE_YFOV_RAD / 2.0) / OUTSIDE_MARGIN
    needed = max(
        _touching_distance(seen[:, 0], seen[:, 2], slope_y * aspect),
        _touching_distance(seen[:, 1], seen[:, 2], slope_y),
    )
    # A scene of one point, or flat along the view, still needs a distance.
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    nearest = float(seen[:, 2].max()) + max(0.05 * extent, 1e-3)
    eye_backward = max(needed, nearest)
    distance = eye_backward - seen[:, 2]
    centre = [_centre(seen[:, axis], distance) for axis in (0, 1)]
    pose[:3, 3] = pose[:3, :3] @ np.array([*centre, eye_backward])
    return Camera(pose, OUTSIDE_YFOV_RAD, aspect, name="auto")


def _touching_distance(across: F64, backward: F64, slope: float) -> float:
    """Where the view's two sides, ``across`` = ± slope · distance, meet when both touch the points."""
    return float(np.max(across + slope * backward) + np.max(-across + slope * backward)) / (2.0 * slope)


def _centre(across: F64, distance: F64) -> float:
    """The eye's place across the view that leaves equal room on both sides of the picture."""
    low, high = float(across.min()), float(across.max())
    for _ in range(50):  # bisection: the further the eye, the further left everything is seen
        middle = 0.5 * (low + high)
        seen = (across - middle) / distance
        low, high = (middle, high) if seen.max() + seen.min() > 0.0 else (low, middle)
    return 0.5 * (low + high)


def _unit(vector: F64, otherwise: Rgb) -> F64:
    length = np.linalg.norm(vector)
    return vector / length if length > 0.0 else np.array(otherwise)
