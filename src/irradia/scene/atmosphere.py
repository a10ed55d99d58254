"""A clear atmosphere, spectral: light from the sun and light scattered by air and haze.

Rayleigh, aerosol and ozone layers over a round Earth. First-order scattering is integrated along
the view ray; all higher orders are taken as isotropic and summed as a geometric series, after
*A Scalable and Production Ready Sky and Atmosphere Rendering Technique* (Hillaire 2020, eq. 5–10).
Ours differs: 17 wavelengths instead of RGB, and haze set by Preetham's turbidity (*A Practical
Analytic Model for Daylight*, Preetham et al. 1999, §2: the ratio of the optical thickness of hazy
to clean air).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from irradia.scene.spectrum import WAVELENGTH_NM
from irradia.scene.types import F64

EARTH_RADIUS_M = 6.36e6
ATMOSPHERE_TOP_M = 6.0e4  # above it is less than 0.1 % of the air
OBSERVER_HEIGHT_M = 2.0

RAYLEIGH_SCALE_HEIGHT_M = 8.0e3
HAZE_SCALE_HEIGHT_M = 1.2e3
RAYLEIGH_DEPTH_550 = 0.098  # vertical optical thickness of clean air at 550 nm
HAZE_ANGSTROM_EXPONENT = 1.3
HAZE_SINGLE_SCATTERING_ALBEDO = 0.92
HAZE_ASYMMETRY = 0.76  # Henyey–Greenstein
OZONE_PEAK_PER_M = 1.88e-6  # absorption at 600 nm in the middle of the layer
OZONE_LAYER_M = (2.5e4, 1.5e4)  # centre, half width of a tent


@dataclass(frozen=True)
class Atmosphere:
    """Air of one turbidity over a grey ground.

    Attributes:
        turbidity: 1 is pure air, 2 very clear, 3 clear, 6 hazy.
        ground_albedo: Reflectance of the ground, which lights the air from below.
    """

    turbidity: float
    ground_albedo: float

    @cached_property
    def rayleigh_per_m(self) -> F64:
        """(λ,) scattering at sea level."""
        return RAYLEIGH_DEPTH_550 / RAYLEIGH_SCALE_HEIGHT_M * (550.0 / WAVELENGTH_NM) ** 4.08

    @cached_property
    def haze_per_m(self) -> F64:
        """(λ,) extinction by aerosols at sea level."""
        depth = (self.turbidity - 1.0) * RAYLEIGH_DEPTH_550
        return depth / HAZE_SCALE_HEIGHT_M * (550.0 / WAVELENGTH_NM) ** HAZE_ANGSTROM_EXPONENT

    @cached_property
    def ozone_per_m(self) -> F64:
        """(λ,) absorption in the middle of the ozone layer: the Chappuis band as one Gaussian."""
        return OZONE_PEAK_PER_M * np.exp(-0.5 * ((WAVELENGTH_NM - 600.0) / 50.0) ** 2)

    def scattering(self, height_m: F64) -> tuple[F64, F64]:
        """(…, λ) scattering coefficients of air and of haze."""
        air, haze, _ = _densities(height_m)
        return (
            air[..., None] * self.rayleigh_per_m,
            haze[..., None] * self.haze_per_m * HAZE_SINGLE_SCATTERING_ALBEDO,
        )

    def transmittance(self, height_m: F64, cos_zenith: F64) -> F64:
        """(…, λ) share of light that arrives from outside along a direction; 0 through the Earth."""
        columns = _columns_to_space(height_m, cos_zenith)
        passed = np.exp(-self._depth(columns))
        return np.where(_hits_ground(height_m, cos_zenith)[..., None], 0.0, passed)

    def sky_radiance(self, directions: F64, to_sun: F64) -> F64:
        """(N, λ) radiance per unit of solar irradiance outside, for (N, 3) upward directions, +Y up."""
        higher_orders = _HigherOrders(self, float(to_sun[1]))
        start = np.array([0.0, EARTH_RADIUS_M + OBSERVER_HEIGHT_M, 0.0])
        # A few rays at a time stay in the processor's cache: three times as fast as all at once.
        parts = np.array_split(directions, max(1, len(directions) // 128))
        return np.concatenate([self.march(start, part, to_sun, higher_orders, 40)[0] for part in parts])

    def _depth(self, columns: F64) -> F64:
        """(…, λ) optical thickness of (…, 3) column lengths."""
        return columns @ np.stack([self.rayleigh_per_m, self.haze_per_m, self.ozone_per_m])

    def march(
        self, start: F64, directions: F64, to_sun: F64, higher_orders: _HigherOrders | None, n_steps: int
    ) -> tuple[F64, F64, F64]:
        """Integrates along rays from one point.

        Without ``higher_orders`` phase functions are isotropic, as eq. 5 asks.

        Returns:
            (N, λ) radiance, (N, λ) share that would scatter again under unit radiance from
            everywhere (eq. 7), (N, λ) transmittance to the end of the ray.
        """
        length = _ray_length(start, directions)
        # Quadratic spacing: the haze is thin, and near the observer.
        edges = np.linspace(0.0, 1.0, n_steps + 1) ** 2
        distance = length[:, None] * 0.5 * (edges[:-1] + edges[1:])
        step = length[:, None] * np.diff(edges)
        points = start + distance[..., None] * directions[:, None, :]
        radius = np.linalg.norm(points, axis=-1)
        height = radius - EARTH_RADIUS_M
        cos_sun = points @ to_sun / radius

        air, haze = self.scattering(height)
        columns = np.stack(_densities(height), axis=-1) * step[..., None]
        before = self._depth(np.cumsum(columns, axis=1) - 0.5 * columns)
        reaching_eye = np.exp(-before) * step[..., None]
        if higher_orders is None:
            scattered = (air + haze) / (4.0 * np.pi)
            source = scattered * self.transmittance(height, cos_sun)
        else:
            cos_angle = (directions @ to_sun)[:, None, None]
            phased = air * _rayleigh_phase(cos_angle) + haze * _haze_phase(cos_angle)
            source = phased * self.transmittance(height, cos_sun)
            source += (air + haze) * higher_orders.at(height, cos_sun)
        again = np.sum(reaching_eye * (air + haze), axis=1)
        return np.sum(reaching_eye * source, axis=1), again, np.exp(-self._depth(columns.sum(axis=1)))


class _HigherOrders:
    """Ψ_ms (eq. 10): radiance of all scattering beyond the first, per height and sun angle."""

    _HEIGHT_M = np.linspace(0.0, 1.0, 12) ** 2 * (ATMOSPHERE_TOP_M * 0.999) + OBSERVER_HEIGHT_M
    _N_DIRECTIONS = 48

    def __init__(self, atmosphere: Atmosphere, cos_sun: float) -> None:
        # A ray to the horizon ends where the sun stands up to 8° higher or lower.
        elevation = np.arcsin(cos_sun) + np.radians(np.linspace(-9.0, 9.0, 7))
        self._cos_sun = np.sin(np.clip(elevation, -0.5 * np.pi, 0.5 * np.pi))
        directions = _sphere(self._N_DIRECTIONS)
        table = [
            [self._gather(atmosphere, directions, height, cosine) for cosine in self._cos_sun]
            for height in self._HEIGHT_M
        ]
        self._table = np.array(table)

    @staticmethod
    def _gather(atmosphere: Atmosphere, directions: F64, height: float, cos_sun: float) -> F64:
        """(λ,) Ψ_ms at one point: second order over one minus the share that scatters again."""
        start = np.array([0.0, EARTH_RADIUS_M + height, 0.0])
        to_sun = np.array([np.sqrt(max(0.0, 1.0 - cos_sun**2)), cos_sun, 0.0])
        radiance, again, through = atmosphere.march(start, directions, to_sun, None, n_steps=20)
        down = _hits_ground(np.full(len(directions), height), directions[:, 1])
        lit = atmosphere.transmittance(np.zeros(1), np.array([cos_sun])) * max(cos_sun, 0.0)
        radiance = radiance + np.where(down[:, None], through * lit * atmosphere.ground_albedo / np.pi, 0.0)
        return radiance.mean(axis=0) / (1.0 - again.mean(axis=0))

    def at(self, height_m: F64, cos_sun: F64) -> F64:
        """(…, λ) Ψ_ms between the tabulated points."""
        return _look_up(self._table, (self._HEIGHT_M, self._cos_sun), height_m, cos_sun)


def _densities(height_m: F64) -> tuple[F64, F64, F64]:
    """Air, haze and ozone relative to where their coefficients are given."""
    height = np.maximum(height_m, 0.0)
    centre, half_width = OZONE_LAYER_M
    return (
        np.exp(-height / RAYLEIGH_SCALE_HEIGHT_M),
        np.exp(-height / HAZE_SCALE_HEIGHT_M),
        np.maximum(0.0, 1.0 - np.abs(height - centre) / half_width),
    )


def _columns_to_space(height_m: F64, cos_zenith: F64) -> F64:
    """(…, 3) column of each constituent to the top; from a table, as every step of a ray asks."""
    heights, cosines, table = _column_table()
    return _look_up(table, (heights, cosines), height_m, cos_zenith)


@cache
def _column_table() -> tuple[F64, F64, F64]:
    """Heights, cosines of the zenith angle, and the columns from there to the top."""
    heights = np.linspace(0.0, 1.0, 48) ** 2 * ATMOSPHERE_TOP_M
    # Finest at the horizon, where a column grows tenfold within a few degrees.
    spread = np.linspace(-0.6, 1.0, 129)
    cosines = np.sign(spread) * spread**2
    return heights, cosines, np.array([_integrate_columns(height, cosines) for height in heights])


def _look_up(table: F64, axes: tuple[F64, F64], x: F64, y: F64) -> F64:
    """Bilinear interpolation of (rows, columns, …), clamped at the edges."""
    row, row_share = _cell(axes[0], x)
    column, column_share = _cell(axes[1], y)
    near = table[row, column] * (1 - column_share) + table[row, column + 1] * column_share
    far = table[row + 1, column] * (1 - column_share) + table[row + 1, column + 1] * column_share
    return near * (1 - row_share) + far * row_share


def _cell(axis: F64, x: F64) -> tuple[np.ndarray, F64]:
    """Index of the cell that holds ``x``, and how far along it lies, with an axis for channels."""
    position = np.interp(x, axis, np.arange(len(axis)))
    index = np.minimum(position.astype(int), len(axis) - 2)
    return index, (position - index)[..., None]


def _integrate_columns(height_m: float, cosines: F64) -> F64:
    start = np.array([0.0, EARTH_RADIUS_M + height_m, 0.0])
    directions = np.stack([np.sqrt(1.0 - cosines**2), cosines, np.zeros_like(cosines)], axis=-1)
    length = _ray_length(start, directions, through_ground=True)
    edges = np.linspace(0.0, 1.0, 201)
    points = start + (length[:, None] * 0.5 * (edges[:-1] + edges[1:]))[..., None] * directions[:, None, :]
    height = np.linalg.norm(points, axis=-1) - EARTH_RADIUS_M
    return np.stack(_densities(height), axis=-1).sum(axis=1) * (length / 200.0)[:, None]


def _ray_length(start: F64, directions: F64, through_ground: bool = False) -> F64:
    """(N,) distance to the top of the atmosphere, or to the ground where that is nearer."""
    along = directions @ start
    radius_squared = start @ start

    def root(sphere_radius: float, sign: float) -> F64:
        return -along + sign * np.sqrt(np.maximum(along**2 - radius_squared + sphere_radius**2, 0.0))

    top = root(EARTH_RADIUS_M + ATMOSPHERE_TOP_M, 1.0)
    if through_ground:
        return top
    height = np.full(len(directions), np.sqrt(radius_squared) - EARTH_RADIUS_M)
    hits = _hits_ground(height, directions[:, 1])
    return np.where(hits, np.maximum(root(EARTH_RADIUS_M, -1.0), 0.0), top)


def _hits_ground(height_m: F64, cos_zenith: F64) -> np.ndarray:
    ratio = EARTH_RADIUS_M / (EARTH_RADIUS_M + np.maximum(height_m, 0.0))
    return cos_zenith < -np.sqrt(np.maximum(1.0 - ratio**2, 0.0))


def _rayleigh_phase(cosine: F64) -> F64:
    return 3.0 / (16.0 * np.pi) * (1.0 + cosine**2)


def _haze_phase(cosine: F64) -> F64:
    g = HAZE_ASYMMETRY
    return (1.0 - g * g) / (4.0 * np.pi) / (1.0 + g * g - 2.0 * g * cosine) ** 1.5


def _sphere(n: int) -> F64:
    """(n, 3) directions spread evenly (a Fibonacci spiral)."""
    index = np.arange(n) + 0.5
    cosine = 1.0 - 2.0 * index / n
    phi = np.pi * (1.0 + 5.0**0.5) * index
    sine = np.sqrt(1.0 - cosine**2)
    return np.stack([np.cos(phi) * sine, cosine, np.sin(phi) * sine], axis=-1)
