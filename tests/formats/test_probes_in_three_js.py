"""A probe grid in stock three.js, drawn in Chromium with the loader that the documentation prints."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from irradia.formats.probes import ProbeGrid
from irradia.formats.probes_three import write_three_grid

from .test_probes import made

LOBE_TIMES_CONSTANT = np.array(
    [0.886227] + [1.023327] * 3 + [0.858085, 0.858085, 0.247708, 0.858085, 0.429043]
)


def lit_grid() -> tuple[ProbeGrid, np.ndarray]:
    """Probes whose light differs from one to the next, mostly even so that no clamping hides errors."""
    grid = ProbeGrid(np.float32([-1, 2, 0.5]), np.float32([0.5, 1.0, 0.75]), (3, 2, 4))
    rng = np.random.default_rng(31)
    series = rng.normal(scale=0.25, size=(24, 9, 3)).astype(np.float32)
    series[:, 0] = rng.uniform(3, 6, (24, 3))
    return grid, series


def expected(grid: ProbeGrid, series: np.ndarray, position: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """E/π by hand: half a spacing along the normal, trilinear, then the cosine lobe."""
    shape = np.array(grid.shape)
    at = np.clip((position + 0.5 * grid.spacing * normal - grid.origin) / grid.spacing, 0, shape - 1)
    low = np.minimum(np.floor(at).astype(int), np.maximum(shape - 2, 0))
    total = np.zeros((9, 3))
    for corner in np.ndindex(2, 2, 2):
        x, y, z = np.minimum(low + corner, shape - 1)
        weight = np.where(corner, at - low, 1 - (at - low)).prod()
        total += weight * series[x + shape[0] * (y + shape[1] * z)]
    x, y, z = normal
    functions = np.array([1, y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y])
    return (LOBE_TIMES_CONSTANT * functions) @ total / np.pi


def test_three_js_shines_as_the_coefficients_say(web_check, chromium: str, tmp_path: Path) -> None:
    grid, series = lit_grid()
    write_three_grid(tmp_path / "probes.json", made(24, coefficients=series, structure=grid))
    rng = np.random.default_rng(32)
    low, high = grid.origin, grid.origin + grid.spacing * (np.array(grid.shape) - 1)
    positions = rng.uniform(low, high, (40, 3))
    normals = rng.normal(size=(40, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    places = [{"position": p.tolist(), "normal": n.tolist()} for p, n in zip(positions, normals, strict=True)]
    (tmp_path / "places.json").write_text(json.dumps(places))
    shades = web_check("probe-grid", tmp_path / "probes.json", tmp_path / "places.json", chromium)
    by_hand = [expected(grid, series, p, n) for p, n in zip(positions, normals, strict=True)]
    # Software filtering of 3D textures has 8 bits of fraction.
    np.testing.assert_allclose(shades, by_hand, rtol=0.02)
