"""Removes the noise of a lightmap chart by chart: Intel Open Image Denoise's ``RTLightmap`` filter.

The filter's network looks about a hundred texels far. On a whole page a black island keeps a
thousandth of its surroundings, and a bright half shifts the other by two percent. So every chart is
denoised on a canvas of its own: no light passes from one to another, whether they touch in space or
not. The filter's time is proportional to the canvas from 16 × 16 texels up, so the cost is that of the
margins: little for walls, twice to three times a whole page's for scans in thousands of charts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.bake.texels import TexelSet
from irradia.core.errors import InternalError, MissingDependencyError
from irradia.core.progress import Progress
from irradia.scene.types import F32

_MARGIN = 4  # texels round a chart; 16 lower the error by another 3 % and cost up to three times the time
_BLACK_RADIUS = 3  # a texel stays exactly 0 where nothing within this distance is lit
_MAX_MEMORY_MB = 800  # the filter cuts larger canvases into tiles
_KEY = 0.18  # where the mean log luminance is brought to, as the filter does by itself per image
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)


def denoise(values: F32, texels: TexelSet, progress: Progress, *, n_threads: int | None = None) -> F32:
    """Estimates the noise-free values of a lightmap.

    One input scale serves all charts, so that equal light stays equal. Each chart keeps its mean,
    colour by colour, since the filter loses one to two percent of noisy light. Texels without any
    light near them stay exactly 0. The same input gives the same bits on any number of threads.

    Args:
        values: (N, 3) linear, ≥ 0 and finite, noise independent between texels.
        texels: Says which values are neighbours and which chart they are on.
        progress: Shows the stage "denoise".
        n_threads: For the filter; all processors by default.

    Returns:
        (N, 3) denoised values.

    Raises:
        MissingDependencyError: The denoiser is not installed or doesn't load here.
    """
    result = values.copy()
    lit = values.max(axis=1, initial=0.0) > 0
    if not lit.any():
        return result
    # A chart of one texel keeps its mean, and so its value.
    charts = [members for members in _charts(texels) if len(members) > 1 and lit[members].any()]
    with _Filter(_input_scale(values[lit]), n_threads) as network:
        total = float(sum(len(members) for members in charts))
        with progress.stage("denoise", total=total, unit="texel") as stage:
            for members in charts:
                result[members] = _denoise_chart(network, values[members], _Chart.of(members, texels))
                stage.advance(len(members))
    return result


def _charts(texels: TexelSet) -> list[NDArray[np.int64]]:
    """Indices of each chart's texels, in ascending order of charts."""
    order = np.argsort(texels.chart, kind="stable")
    chart = texels.chart[order]
    return np.split(order, np.flatnonzero(chart[1:] != chart[:-1]) + 1)


@dataclass(frozen=True)
class _Chart:
    """Where a chart's texels lie on its canvas.

    Attributes:
        y, x: (M,) position on the canvas.
        shape: (height, width) of the canvas, margins included.
        weight: (M,) coverage.
    """

    y: NDArray[np.int64]
    x: NDArray[np.int64]
    shape: tuple[int, int]
    weight: F32

    @classmethod
    def of(cls, members: NDArray[np.int64], texels: TexelSet) -> _Chart:
        """Lays the texels (M,) of one chart, all on one page, on a canvas."""
        y, x = np.divmod(texels.pixel[members].astype(np.int64), texels.width_px)
        y, x = y - y.min() + _MARGIN, x - x.min() + _MARGIN
        shape = int(y.max()) + 1 + _MARGIN, int(x.max()) + 1 + _MARGIN
        return cls(y, x, shape, texels.coverage[members])


def _denoise_chart(network: _Filter, values: F32, chart: _Chart) -> F32:
    canvas, inside = _canvas(values, chart)
    clean = np.maximum(network(canvas)[chart.y, chart.x], 0.0)
    clean[_black(canvas, inside)[chart.y, chart.x]] = 0.0
    before = (values * chart.weight[:, None]).sum(axis=0, dtype=np.float64)
    after = (clean * chart.weight[:, None]).sum(axis=0, dtype=np.float64)
    return clean * np.where(after > 0, before / np.maximum(after, 1e-30), 0.0).astype(np.float32)


def _canvas(values: F32, chart: _Chart) -> tuple[F32, NDArray[np.bool_]]:
    """The chart with its surroundings filled by reflection at its border; and the mask of the chart.

    Reflected noise is noise like the rest. Stretching the border outward would lay streaks instead,
    which the network takes for structure.
    """
    from scipy.ndimage import distance_transform_edt

    canvas = np.zeros((*chart.shape, 3), np.float32)
    inside = np.zeros(chart.shape, np.bool_)
    canvas[chart.y, chart.x] = values
    inside[chart.y, chart.x] = True
    nearest = np.asarray(distance_transform_edt(~inside, return_distances=False, return_indices=True))
    y, x = np.nonzero(~inside)
    near_y, near_x = nearest[0][y, x], nearest[1][y, x]
    mirror_y = np.clip(2 * near_y - y, 0, chart.shape[0] - 1)
    mirror_x = np.clip(2 * near_x - x, 0, chart.shape[1] - 1)
    reflects = inside[mirror_y, mirror_x]
    canvas[y, x] = canvas[np.where(reflects, mirror_y, near_y), np.where(reflects, mirror_x, near_x)]
    return canvas, inside


def _black(canvas: F32, inside: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Texels of the canvas with nothing lit near them on the chart."""
    from scipy.ndimage import maximum_filter

    brightest = np.where(inside, canvas.max(axis=2), 0.0)
    return maximum_filter(brightest, size=2 * _BLACK_RADIUS + 1, mode="constant") <= 0


def _input_scale(lit: F32) -> float:
    """One exposure for everything: the geometric mean of what is lit goes to middle grey."""
    luminance = np.maximum(lit @ _LUMINANCE, 1e-20).astype(np.float64)
    return float(_KEY / np.exp(np.log(luminance).mean()))


class _Filter:
    """The ``RTLightmap`` filter; it takes the colour alone, no albedo and no normals."""

    def __init__(self, input_scale: float, n_threads: int | None) -> None:
        try:
            import pyoidn
        except (ImportError, OSError, AttributeError) as error:
            raise MissingDependencyError(
                f"Open Image Denoise doesn't load: {error}",
                fix="pip install pyoidn, or bake with --no-denoise",
            ) from error
        self._oidn = pyoidn
        self._device = pyoidn.Device(pyoidn.OIDN_DEVICE_TYPE_CPU)
        if n_threads is not None:
            self._device.set_int("numThreads", n_threads)
        self._device.commit()
        self._filter = pyoidn.Filter(self._device, pyoidn.OIDN_FILTER_TYPE_RT_LIGHTMAP)
        self._filter.set_float("inputScale", input_scale)
        self._filter.set_int("maxMemoryMB", _MAX_MEMORY_MB)

    def __enter__(self) -> _Filter:
        return self

    def __exit__(self, *_: object) -> None:
        self._filter.release()
        self._device.release()

    def __call__(self, canvas: F32) -> F32:
        """Denoises (H, W, 3)."""
        source = np.ascontiguousarray(canvas, np.float32)
        target = np.empty_like(source)
        self._filter.set_image(self._oidn.OIDN_IMAGE_COLOR, source, self._oidn.OIDN_FORMAT_FLOAT3)
        self._filter.set_image(self._oidn.OIDN_IMAGE_OUTPUT, target, self._oidn.OIDN_FORMAT_FLOAT3)
        self._filter.commit()
        self._filter.execute()
        error = self._device.get_error()
        if error is not None:
            raise InternalError(f"Open Image Denoise failed: {error}")
        return target
