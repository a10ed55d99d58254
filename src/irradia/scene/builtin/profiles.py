"""Lines of classical mouldings, to be joined into profiles of (outward, height)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from irradia.scene.builtin.mesh import Array


def chain(*parts: ArrayLike) -> Array:
    """Joins points and curves into one profile; points that repeat their predecessor are dropped."""
    points = np.concatenate([np.atleast_2d(np.asarray(p, np.float64)) for p in parts])
    keep = np.concatenate([[True], np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-9])
    return points[keep]


def torus(x: float, y: float, height: float, n: int = 6) -> Array:
    """A half-round swelling outward from x, between y and y + height."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, n + 1)
    radius = height / 2
    return np.stack([x + radius * np.cos(angle), y + radius + radius * np.sin(angle)], axis=1)


def scotia(x0: float, x1: float, y: float, height: float, depth: float, n: int = 6) -> Array:
    """A hollow from (x0, y) to (x1, y + height), ``depth`` behind the straight line."""
    t = np.linspace(0, 1, n + 1)
    x = x0 + (x1 - x0) * t - depth * np.sin(np.pi * t)
    return np.stack([x, y + height * t], axis=1)


def cyma(x0: float, x1: float, y: float, height: float, n: int = 8) -> Array:
    """An S-curve from (x0, y) to (x1, y + height), upright at both ends."""
    t = np.linspace(0, 1, n + 1)
    return np.stack([x0 + (x1 - x0) * (1 - np.cos(np.pi * t)) / 2, y + height * t], axis=1)


def cavetto(x0: float, x1: float, y: float, height: float, n: int = 6) -> Array:
    """A quarter-hollow that leaves (x0, y) upright and arrives at (x1, y + height) level."""
    angle = np.linspace(0, np.pi / 2, n + 1)
    return np.stack([x0 + (x1 - x0) * (1 - np.cos(angle)), y + height * np.sin(angle)], axis=1)


def ovolo(x0: float, x1: float, y: float, height: float, n: int = 6) -> Array:
    """A quarter-round that leaves (x0, y) level and arrives at (x1, y + height) upright."""
    angle = np.linspace(0, np.pi / 2, n + 1)
    return np.stack([x0 + (x1 - x0) * np.sin(angle), y + height * (1 - np.cos(angle))], axis=1)
