"""Surfaces from a profile: turned on a lathe, or drawn along a path as a moulding.

A profile is (N, 2): distance outward and height. Its front is on the right of its direction, so a
profile that climbs faces outward. Corners sharper than CREASE_DEG stay hard, the rest is smooth.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from irradia.scene.builtin.mesh import Array, Mesh, drop_degenerate, grid, join
from irradia.scene.builtin.shapes import circle

CREASE_DEG = 38.0


def lathe(profile: ArrayLike, n_sides: int) -> Mesh:
    """Turns a profile (radius, height), bottom to top, about the Y axis."""
    radial = circle(n_sides)
    up = np.broadcast_to([0.0, 1.0, 0.0], radial.shape)
    radius = float(np.asarray(profile)[:, 0].max())
    along = np.linspace(0, 2 * np.pi * radius, n_sides + 1)
    return drop_degenerate(_smooth_sweep(profile, np.zeros_like(radial), radial, up, along))


def sweep_arc(profile: ArrayLike, radius: float, n_steps: int, *, rise: float | None = None) -> Mesh:
    """Draws a profile (outward = +Z, height = away from the centre) along a half circle in the XY
    plane, from −X over +Y to +X; ``rise`` other than the radius makes it a half ellipse.
    """
    rise = radius if rise is None else rise
    angle = np.linspace(np.pi, 0.0, n_steps + 1)
    points = np.stack([radius * np.cos(angle), rise * np.sin(angle), 0 * angle], axis=-1)
    away = np.stack([rise * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=-1)
    away /= np.linalg.norm(away, axis=-1, keepdims=True)
    out = np.broadcast_to([0.0, 0.0, 1.0], points.shape)
    step = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return _smooth_sweep(profile, points, out, away, np.concatenate([[0.0], np.cumsum(step)]))


def moulding(profile: ArrayLike, corners: ArrayLike, *, closed: bool = False) -> Mesh:
    """Draws a profile (outward, height) along a horizontal polyline of (N, 3), mitred at its corners.

    Outward is on the right of the path seen from above: clockwise round a court faces into it,
    counter-clockwise round a pier faces away from it. The ends of an open one are not capped.
    """
    points = np.asarray(corners, np.float64)
    ends = np.roll(points, -1, axis=0) if closed else points[1:]
    starts = points if closed else points[:-1]
    along = ends - starts
    length = np.linalg.norm(along, axis=1)
    out = np.cross(along / length[:, None], [0.0, 1.0, 0.0])
    mitres = _mitres(out, closed)
    up = np.array([[0.0, 1.0, 0.0]] * 2)
    distance = np.concatenate([[0.0], np.cumsum(length)])
    sides = []
    for k, (start, end) in enumerate(zip(starts, ends, strict=True)):
        mitre = mitres[[k, (k + 1) % len(mitres)]]
        normals = np.stack([out[k], out[k]])
        sides.append(
            _smooth_sweep(profile, np.stack([start, end]), mitre, up, distance[k : k + 2], normal_out=normals)
        )
    return join(*sides)


def square_moulding(profile: ArrayLike, half_x: float, half_z: float | None = None, y: float = 0.0) -> Mesh:
    """A moulding round an upright rectangular pier on the Y axis, facing away from it."""
    half_z = half_x if half_z is None else half_z
    corners = [(-half_x, y, half_z), (half_x, y, half_z), (half_x, y, -half_z), (-half_x, y, -half_z)]
    return moulding(profile, corners, closed=True)


def court_moulding(profile: ArrayLike, half_x: float, half_z: float, y: float) -> Mesh:
    """A moulding round a rectangular court centred on the Y axis, facing into it."""
    corners = [(-half_x, y, -half_z), (half_x, y, -half_z), (half_x, y, half_z), (-half_x, y, half_z)]
    return moulding(profile, corners, closed=True)


def _mitres(out: Array, closed: bool) -> Array:
    """Outward vectors at the corners, longer where the path bends."""
    before = np.roll(out, 1, axis=0) if closed else np.concatenate([out[:1], out])
    after = out if closed else np.concatenate([out, out[-1:]])
    return (before + after) / (1.0 + np.einsum("nc,nc->n", before, after))[:, None]


def _smooth_sweep(
    profile: ArrayLike,
    origins: Array,
    out: Array,
    up: Array,
    distance: Array,
    *,
    normal_out: Array | None = None,
) -> Mesh:
    """Grids over (path, profile) for each smooth run of the profile; distance is the path's length."""
    normal_out = out if normal_out is None else normal_out
    runs = []
    for points, normals, arc_length in _smooth_runs(np.asarray(profile, np.float64)):
        positions = origins[:, None] + out[:, None] * points[None, :, :1] + up[:, None] * points[None, :, 1:]
        directions = normal_out[:, None] * normals[None, :, :1] + up[:, None] * normals[None, :, 1:]
        uv = np.stack(np.broadcast_arrays(distance[:, None], -arc_length[None]), axis=-1)
        runs.append(grid(positions, directions, uv))
    return join(*runs)


def _smooth_runs(points: Array) -> Iterator[tuple[Array, Array, Array]]:
    """Splits a polyline at its creases into (points, 2D normals, arc length)."""
    along = np.diff(points, axis=0)
    length = np.linalg.norm(along, axis=1)
    along /= length[:, None]
    arc_length = np.concatenate([[0.0], np.cumsum(length)])
    bend = np.einsum("nc,nc->n", along[:-1], along[1:])
    creases = np.flatnonzero(bend < np.cos(np.radians(CREASE_DEG))) + 1
    bounds = [0, *creases.tolist(), len(points) - 1]
    facing = np.stack([along[:, 1], -along[:, 0]], axis=1)
    for first, last in itertools.pairwise(bounds):
        inside = facing[first:last]
        normals = np.concatenate([inside[:1], inside[:-1] + inside[1:], inside[-1:]])
        yield points[first : last + 1], normals, arc_length[first : last + 1]
