"""Reading between probes without light coming through walls: the reference for every shader.

Each of the eight probes around a place counts by four factors (Majercik et al. 2019, "Dynamic Diffuse
Global Illumination with Ray-Traced Irradiance Fields", section 5.2):

    trilinear      by the place in the cell
    validity       probes inside walls don't count
    side           probes behind the surface count less
    sight          how likely the probe sees the place, by Chebyshev's inequality from the mean and
                   deviation of the distances that it saw in that direction

Ours differs in what is stored (deviations rather than mean squares, which lose the difference in half
floats) and in that light is radiance SH, so that one set of weights serves any normal.

The alternative is a mask of neighbours per cell, as Unity's probe volumes have: eight bits are
cheaper, but know only cells. Where a wall crosses a cell they can't tell its sides apart; the distances
can, and they work alike for grids, octrees and loose probes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.bake.probes.neighbours import NOBODY, probes_around
from irradia.bake.probes.octahedral import bilinear_taps, octahedral_uv
from irradia.core.sh import irradiance
from irradia.formats.probes import VALID, ProbeSet

F64 = NDArray[np.float64]

# Of a probe's reach: places on surfaces are looked at from a little above. Twice as much would push
# things that face a thin wall through it, half as much would mistake a wall's far side for its near one.
NORMAL_BIAS = 0.025
_SMALLEST_SIGHT = 1e-6  # so that a place that no probe sees still gets something
_LEAST_DEVIATION = 0.01  # of the reach: sight fades over some distance, else rounding would band
_CRUSH = 0.2  # weights below it fall off with their cube, which hides the tail of Chebyshev's bound
_POINTS_AT_ONCE = 1 << 15


def irradiance_at(probes: ProbeSet, points: F64, normals: F64, *, on_surface: bool = True) -> F64:
    """E, (Q, 3) W·m⁻², linear Rec.709, never negative.

    Args:
        probes: The probes.
        points: (Q, 3) metres.
        normals: (Q, 3) unit.
        on_surface: Whether the places lie on surfaces of the scene. Things that move between them
            take the weights of the place alone: lifted along a normal, a place near a thin wall
            that it faces would get through to the other side.
    """
    series = interpolate(probes, points, normals if on_surface else None)
    return np.maximum(irradiance(series, normals), 0.0)


def interpolate(probes: ProbeSet, points: F64, normals: F64 | None = None) -> F64:
    """Radiance coefficients (Q, 9, 3) at places.

    Args:
        probes: The probes.
        points: (Q, 3) metres.
        normals: (Q, 3) of the scene's surface there; None for places in free space.
    """
    points = np.asarray(points, np.float64)
    result = np.zeros((len(points), *probes.coefficients.shape[1:]))
    for first in range(0, len(points), _POINTS_AT_ONCE):
        part = slice(first, first + _POINTS_AT_ONCE)
        index, weight = probe_weights(probes, points[part], None if normals is None else normals[part])
        result[part] = np.einsum("qk,qk...->q...", weight, probes.coefficients[index])
    return result


def probe_weights(probes: ProbeSet, points: F64, normals: F64 | None = None) -> tuple[NDArray[np.int64], F64]:
    """The eight probes around each place (Q, 8) and their shares (Q, 8), which sum to 1, or to 0 where
    there are no valid probes at all.
    """
    index, weight = probes_around(probes, points)
    known = index != NOBODY
    index = np.where(known, index, 0)
    weight = weight * known * (probes.state[index] == VALID)
    weight = _with_sight(probes, points, normals, index, weight)
    return index, weight / np.maximum(weight.sum(axis=1, keepdims=True), 1e-30)


def _with_sight(
    probes: ProbeSet, points: F64, normals: F64 | None, index: NDArray[np.int64], weight: F64
) -> F64:
    """Weights times what each probe can see of the place."""
    places = probes.places.astype(np.float64)[index]
    reach = probes.reach.astype(np.float64)[index]
    seen_at = points[:, None]
    if normals is not None:
        seen_at = seen_at + normals[:, None] * (NORMAL_BIAS * reach)[..., None]
        towards = places - points[:, None]
        towards /= np.maximum(np.linalg.norm(towards, axis=-1, keepdims=True), 1e-9)
        facing = np.einsum("qkc,qc->qk", towards, normals)
        weight = weight * ((0.5 * facing + 0.5) ** 2 + 0.2)
    way = seen_at - places
    length = np.linalg.norm(way, axis=-1)
    direction = np.where(length[..., None] > 1e-9, way / np.maximum(length, 1e-9)[..., None], (0.0, 1.0, 0.0))
    sight = _sight(probes, index, direction, length, reach)
    crushed = np.where(sight < _CRUSH, sight**3 / _CRUSH**2, sight)
    return weight * np.maximum(crushed, _SMALLEST_SIGHT)


def _sight(probes: ProbeSet, index: NDArray[np.int64], direction: F64, length: F64, reach: F64) -> F64:
    """(Q, 8) bound on the share of a probe's rays in a direction that get further than ``length``."""
    size = probes.distance.shape[1]
    taps, shares = bilinear_taps(octahedral_uv(direction), size)
    texels = probes.distance.reshape(len(probes), size * size, 2)[index[..., None], taps]
    mean, deviation = np.moveaxis(np.einsum("qkt,qktc->qkc", shares, texels), -1, 0)
    variance = np.maximum(deviation, _LEAST_DEVIATION * reach) ** 2
    beyond = np.maximum(length - mean, 0.0)
    return np.where(length <= mean, 1.0, (variance / (variance + beyond**2)) ** 3)
