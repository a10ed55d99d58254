"""Real spherical harmonics to order 2, and irradiance from them.

Order and signs are those of docs/conventions.md: Y₀₀, Y₁₋₁ (y), Y₁₀ (z), Y₁₁ (x), Y₂₋₂ (xy), Y₂₋₁ (yz),
Y₂₀ (3z² − 1), Y₂₁ (xz), Y₂₂ (x² − y²), every constant positive, axes glTF's. Coefficients are of
radiance; the cosine lobe (Ramamoorthi and Hanrahan 2001, equation 8: π, 2π/3, π/4) is applied on
evaluation.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

N_COEFFICIENTS = 9
BAND = np.array([0, 1, 1, 1, 2, 2, 2, 2, 2])  # the order l of each coefficient
COSINE_LOBE = np.array([math.pi, 2.0 * math.pi / 3.0, math.pi / 4.0])  # by l

_C0 = 0.5 * math.sqrt(1.0 / math.pi)  # 0.282095
_C1 = math.sqrt(3.0 / (4.0 * math.pi))  # 0.488603
_C2 = 0.5 * math.sqrt(15.0 / math.pi)  # 1.092548
_C20 = 0.25 * math.sqrt(5.0 / math.pi)  # 0.315392
_C22 = 0.25 * math.sqrt(15.0 / math.pi)  # 0.546274
CONSTANTS = (_C0, _C1, _C2, _C20, _C22)


def sh_basis(directions: ArrayLike) -> NDArray[np.float64]:
    """The nine functions at unit directions, (…, 3) → (…, 9)."""
    x, y, z = np.moveaxis(np.asarray(directions, np.float64), -1, 0)
    return np.stack(
        [
            np.full_like(x, _C0),
            _C1 * y,
            _C1 * z,
            _C1 * x,
            _C2 * x * y,
            _C2 * y * z,
            _C20 * (3.0 * z * z - 1.0),
            _C2 * x * z,
            _C22 * (x * x - y * y),
        ],
        axis=-1,
    )


def irradiance_weights(normals: ArrayLike) -> NDArray[np.float64]:
    """(…, 9) weights whose sum with radiance coefficients is E on surfaces of unit ``normals`` (…, 3)."""
    return sh_basis(normals) * COSINE_LOBE[BAND]


def irradiance(coefficients: ArrayLike, normals: ArrayLike) -> NDArray[np.float64]:
    """E, W·m⁻², linear Rec.709.

    Args:
        coefficients: (…, 4 or 9, 3) of radiance.
        normals: (…, 3) unit; leading axes broadcast against those of ``coefficients``.
    """
    series = np.asarray(coefficients, np.float64)
    weights = irradiance_weights(normals)[..., : series.shape[-2]]
    return np.einsum("...i,...ic->...c", weights, series)


def light_on(coefficients: ArrayLike, normals: ArrayLike) -> NDArray[np.float64]:
    """:func:`irradiance`, and nothing where the cut-off series dips below it."""
    return np.maximum(irradiance(coefficients, normals), 0.0)


def fibonacci_sphere(n: int) -> NDArray[np.float64]:
    """(n, 3) unit directions, evenly spread (spherical Fibonacci lattice, Keinert et al. 2015)."""
    index = np.arange(n) + 0.5
    z = 1.0 - 2.0 * index / n
    turn = index * (math.pi * (3.0 - math.sqrt(5.0)))
    radius = np.sqrt(1.0 - z * z)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=-1)
