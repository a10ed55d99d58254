"""Rooms: whether surfaces enclose the viewer, and where inside to stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irradia.scene.merge import MergedMesh
from irradia.scene.surface import SurfaceSamples, sample_surface
from irradia.scene.types import F64

N_SURFACE_SAMPLES = 20_000
N_BANDS, N_SECTORS = 12, 24  # directions in which a probe looks: equal solid angles
ENCLOSED_SHARE = 0.6  # a room without a roof or an end wall is still a room, a ground plane (0.5) is not
EYE_HEIGHT_M = 1.6
HALF_VIEW_COSINE = 0.75


@dataclass(frozen=True)
class InteriorView:
    """A viewpoint inside a room and what it looks at, world space."""

    eye: F64
    target: F64


@dataclass(frozen=True)
class _Probe:
    """What one point sees.

    Attributes:
        enclosed: Share of directions in which the nearest surface shows its front.
        distance: (bands · sectors,) metres to that surface; 0 where there is none or its back.
        nearest: Metres to the nearest surface in any direction.
    """

    enclosed: float
    distance: F64
    nearest: float


def find_interior_view(mesh: MergedMesh) -> InteriorView | None:
    """A view along the longest stretch of a room, or None where the scene is no room.

    The rule: the median of nine points around the middle sees fronts of surfaces in at least 60 %
    of all directions. From inside a closed object one sees backs; from among objects, the sky.
    """
    samples = sample_surface(mesh, N_SURFACE_SAMPLES)
    if len(samples.positions) == 0:
        return None
    low, high = samples.positions.min(axis=0), samples.positions.max(axis=0)
    middle = [_probe(samples, point) for point in _grid(low, high, 0.3, 3, 0.5 * (low[1] + high[1]))]
    if np.median([probe.enclosed for probe in middle]) < ENCLOSED_SHARE:
        return None
    eyes = _grid(low, high, 0.08, 6, _eye_level(low[1], high[1]))
    size = float(np.linalg.norm(high - low))
    rated = [_best_view(eye, _probe(samples, eye), size) for eye in eyes]
    _, view = max(rated, key=lambda item: item[0])
    return view


def _eye_level(floor: float, ceiling: float) -> float:
    """Standing height in a room of human size; in proportion where units or size are unusual."""
    height = ceiling - floor
    return floor + float(np.clip(EYE_HEIGHT_M, 0.12 * height, 0.5 * height))


def _grid(low: F64, high: F64, inset: float, n: int, level: float) -> list[F64]:
    """Points in n rows and columns at one height, a share of the box away from its sides."""
    steps = np.linspace(inset, 1.0 - inset, n)
    size = high - low
    return [np.array([low[0] + u * size[0], level, low[2] + v * size[2]]) for u in steps for v in steps]


def _probe(samples: SurfaceSamples, point: F64) -> _Probe:
    """Splats the samples around a point into directions and keeps the nearest of each.

    With thousands of samples a direction the nearest is close to what a ray would hit; no ray
    tracer is needed, and a grating of thin bars counts as the wall that it looks like.
    """
    offset = samples.positions - point
    distance = np.maximum(np.linalg.norm(offset, axis=1), 1e-9)
    facing = np.einsum("nk,nk->n", offset, samples.normals) < 0.0
    band = np.minimum((0.5 * (1.0 - offset[:, 1] / distance) * N_BANDS).astype(int), N_BANDS - 1)
    turn = np.arctan2(offset[:, 0], -offset[:, 2]) / (2.0 * np.pi) + 0.5
    sector = np.minimum((turn * N_SECTORS).astype(int), N_SECTORS - 1)
    cell = band * N_SECTORS + sector
    farthest_first = np.argsort(-distance, kind="stable")
    nearest = np.full(N_BANDS * N_SECTORS, -1)
    nearest[cell[farthest_first]] = farthest_first
    front = (nearest >= 0) & facing[nearest]
    return _Probe(float(front.mean()), np.where(front, distance[nearest], 0.0), float(distance.min()))


def _best_view(eye: F64, probe: _Probe, size: float) -> tuple[float, InteriorView]:
    """The horizontal direction with the longest mean view, and a score to compare eyes by."""
    directions = _cell_directions()
    azimuth = 2.0 * np.pi * (np.arange(N_SECTORS) / N_SECTORS - 0.5)
    headings = np.stack([np.sin(azimuth), np.zeros(N_SECTORS), -np.cos(azimuth)], axis=1)
    in_view = directions @ headings.T > HALF_VIEW_COSINE
    mean_distance = (probe.distance[:, None] * in_view).sum(axis=0) / in_view.sum(axis=0)
    best = int(np.argmax(mean_distance))
    # Something right before the lens spoils a view, and so does standing outside the walls.
    clearance = min(1.0, probe.nearest / (0.05 * size))
    score = mean_distance[best] * clearance * probe.enclosed
    return float(score), InteriorView(eye, eye + headings[best] * mean_distance[best])


def _cell_directions() -> F64:
    """(bands · sectors, 3) centres of the directions that a probe tells apart."""
    cosine = 1.0 - 2.0 * (np.arange(N_BANDS) + 0.5) / N_BANDS
    azimuth = 2.0 * np.pi * ((np.arange(N_SECTORS) + 0.5) / N_SECTORS - 0.5)
    sine = np.sqrt(1.0 - cosine**2)[:, None]
    x, y, z = np.broadcast_arrays(sine * np.sin(azimuth), cosine[:, None], -sine * np.cos(azimuth))
    return np.stack([x, y, z], axis=-1).reshape(-1, 3)
