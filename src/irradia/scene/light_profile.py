"""Measured light distributions: from an IES table to a full sphere, and what a light sends where.

The sphere is spanned as in Type C photometry: the vertical angle θ from the light's axis, and the
horizontal angle φ round it, counter-clockwise for who looks against the beam, 0 towards the light's
``up``. In glTF's terms for an untransformed light: the axis is −Z, φ = 0 is +X and φ = 90° is +Y, so
that the X/Z plane is the vertical photometric plane, as EXT_lights_ies has it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from irradia.core.errors import InputError
from irradia.formats.ies import IesTable, decode_ies
from irradia.scene.monotone_cubic import monotone_cubic
from irradia.scene.types import F64, IesProfile, Light

_STEP_DEG = 0.5  # most tables stand at multiples of it, and between them it shows no edges
_N_VERTICAL = int(180 / _STEP_DEG) + 1
_N_HORIZONTAL = int(360 / _STEP_DEG) + 1


def load_profile(path: Path | str) -> tuple[IesProfile, tuple[str, ...]]:
    """Reads an IES file.

    Returns:
        The profile, and notes on what the file asked for that isn't done.

    Raises:
        InputError: It can't be read or is malformed.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"can't read this file: {error.strerror}", where=str(path)) from error
    table = decode_ies(data, str(path))
    return profile_from_ies(table, Path(path).name), table.notes


def profile_from_ies(table: IesTable, name: str = "") -> IesProfile:
    """Continues a table over the sphere by its symmetries and fills it in smoothly.

    Between measured angles runs a monotone cubic in each direction: it passes through every value
    and overshoots none. Directions beyond the measured vertical angles are dark.
    """
    sphere = _sphere_from_type_b(table) if table.photometric_type == "B" else _sphere_from_type_c(table)
    return IesProfile(np.ascontiguousarray(np.maximum(sphere, 0.0), np.float32), name)


def light_candela(light: Light, direction: F64) -> F64:
    """A profile's candela along unit world directions (N, 3) away from the light; the light's own
    intensity is not in it. The reference that the tracer's lookup is held to.
    """
    if light.profile is None:
        return np.ones(len(direction))
    axis, across, third = profile_frame(light)
    vertical = np.arccos(np.clip(direction @ axis, -1.0, 1.0)) / np.pi
    horizontal = np.arctan2(direction @ third, direction @ across) / (2.0 * np.pi) % 1.0
    return bilinear(light.profile.candela, vertical, horizontal)


def mean_candela(profile: IesProfile) -> float:
    """Over all directions: the light's lumens / 4π."""
    weight = np.sin(np.linspace(0.0, np.pi, len(profile.candela)))
    return float(profile.candela[:, :-1].mean(axis=1) @ weight / weight.sum())


def profile_frame(light: Light) -> tuple[F64, F64, F64]:
    """World directions of θ = 0, of (θ, φ) = (90°, 0°) and of (90°, 90°)."""
    axis = np.array(light.direction, np.float64)
    axis /= np.linalg.norm(axis)
    across = np.array(light.up, np.float64)
    across -= axis * (across @ axis)
    if np.linalg.norm(across) < 1e-6:  # up lies along the beam: any direction across it will do
        across = np.eye(3)[np.argmin(np.abs(axis))]
        across -= axis * (across @ axis)
    across /= np.linalg.norm(across)
    return axis, across, np.cross(across, axis)


def bilinear(table: np.ndarray, row: F64, column: F64) -> F64:
    """Values of a table at positions given in [0, 1] of its rows and columns."""
    y, x = row * (table.shape[0] - 1), column * (table.shape[1] - 1)
    y0 = np.clip(np.floor(y).astype(int), 0, table.shape[0] - 2)
    x0 = np.clip(np.floor(x).astype(int), 0, table.shape[1] - 2)
    fy, fx = y - y0, x - x0
    top = table[y0, x0] * (1.0 - fx) + table[y0, x0 + 1] * fx
    bottom = table[y0 + 1, x0] * (1.0 - fx) + table[y0 + 1, x0 + 1] * fx
    return top * (1.0 - fy) + bottom * fy


def _sphere_from_type_c(table: IesTable) -> F64:
    """(V, H) candela; two equal columns where the light is the same all round."""
    theta = np.linspace(0.0, 180.0, _N_VERTICAL)
    by_plane = _fill(table.vertical_deg, table.candela.T, theta)
    if len(table.horizontal_deg) == 1:
        return np.repeat(by_plane, 2, axis=1)
    angles, source = _whole_turn(table.horizontal_deg)
    around = np.concatenate([angles - 360.0, angles, angles + 360.0])
    phi = np.linspace(0.0, 360.0, _N_HORIZONTAL)
    return monotone_cubic(around, np.tile(by_plane[:, source], 3).T, phi).T


def _whole_turn(measured_deg: F64) -> tuple[F64, np.ndarray]:
    """All planes of a turn that mirrors give, and the measured plane that each one equals."""
    first, last = measured_deg[0], measured_deg[-1]
    if (first, last) == (0.0, 90.0):
        images = [measured_deg, 180.0 - measured_deg, 180.0 + measured_deg, 360.0 - measured_deg]
    elif (first, last) == (0.0, 180.0):
        images = [measured_deg, 360.0 - measured_deg]
    elif (first, last) == (90.0, 270.0):
        images = [measured_deg, 540.0 - measured_deg]
    else:
        images = [measured_deg]
    turned = np.round(np.concatenate(images) % 360.0, 9)
    angles, where = np.unique(turned, return_index=True)
    return angles, where % len(measured_deg)


def _sphere_from_type_b(table: IesTable) -> F64:
    """(V, H) candela: each direction of the sphere looked up at its Type B angles."""
    half = np.linspace(-90.0, 90.0, _N_VERTICAL)
    vertical, candela = _mirrored(table.vertical_deg, table.candela.T)
    by_plane = _fill(vertical, candela, half)
    horizontal, candela = _mirrored(table.horizontal_deg, by_plane.T)
    fine = _fill(horizontal, candela, half).T

    theta = np.radians(np.linspace(0.0, 180.0, _N_VERTICAL))[:, None]
    phi = np.radians(np.linspace(0.0, 360.0, _N_HORIZONTAL))[None, :]
    along, across, third = np.cos(theta) + 0.0 * phi, np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
    # along = cos H cos V, across = cos H sin V, third = −sin H (clockwise)
    angle_v = np.degrees(np.arctan2(across, along))
    angle_h = np.degrees(np.arcsin(np.clip(-third, -1.0, 1.0)))
    found = bilinear(fine, np.clip(angle_v / 180.0 + 0.5, 0.0, 1.0), angle_h / 180.0 + 0.5)
    return np.where(np.abs(angle_v) <= 90.0 + 1e-9, found, 0.0)


def _mirrored(angles: F64, values: F64) -> tuple[F64, F64]:
    """Angles from −90° on, where only the half from 0 was measured."""
    if angles[0] != 0.0:
        return angles, values
    return np.concatenate([-angles[:0:-1], angles]), np.concatenate([values[:0:-1], values])


def _fill(angles: F64, values: F64, at: F64) -> F64:
    """Values (A, K) between their angles, 0 outside them."""
    inside = (at >= angles[0] - 1e-9) & (at <= angles[-1] + 1e-9)
    return np.where(inside[:, None], monotone_cubic(angles, values, at), 0.0)
