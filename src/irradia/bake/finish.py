"""From gathered texels to pages that can be filtered: denoise, fill, close seams, dilate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.bake.denoise import denoise as remove_noise
from irradia.bake.dilate import GUTTER_PX, add_rings, fill_invalid, fill_rest, page_state
from irradia.bake.texels import TexelSet
from irradia.core.errors import MissingDependencyError
from irradia.core.progress import Progress
from irradia.scene.types import F32, U32

if TYPE_CHECKING:
    from irradia.bake.seam_points import SeamPoints
    from irradia.bake.seams import SeamSystem

Denoiser = Callable[[F32, TexelSet], F32]
"""Removes noise from values (N, C) of texels whose ``chart`` numbers what may be smoothed together."""


@dataclass(frozen=True)
class FinishOptions:
    """Which steps are taken.

    Attributes:
        denoise: Whether noise is removed; where the denoiser is missing this is said and left out.
        seams: Whether seams are closed, where they are known.
        dilate: Whether uncovered texels get a colour; without it they stay 0, but for the ring beside
            charts that filtering reads.
    """

    denoise: bool = True
    seams: bool = True
    dilate: bool = True


class Finisher:
    """Finishes all maps of one bake: the irradiance first, then those that go with it.

    Args:
        texels: The covered texels.
        valid: (N,) whether a texel's light counts; the others take it from their chart.
        options: Which steps are taken.
        progress: Shows the stages "denoise", "seams" and "dilate".
        region: (N,) of valid texels, finer than charts: see :mod:`irradia.bake.regions`.
        seams: From :func:`find_seam_points`; without them none is closed.
    """

    def __init__(
        self,
        texels: TexelSet,
        valid: NDArray[np.bool_],
        options: FinishOptions,
        progress: Progress,
        *,
        region: U32 | None = None,
        seams: SeamPoints | None = None,
    ) -> None:
        self._texels = texels
        self._valid = valid
        self._options = options
        self._progress = progress
        self._region = region
        self._points = seams if options.seams else None
        self._systems: dict[bool, SeamSystem] = {}

    def irradiance(self, irradiance_over_pi: F32) -> F32:
        """Finishes the map that all others go with.

        Args:
            irradiance_over_pi: (N, 3) linear, ≥ 0.

        Returns:
            (P, H, W, 3) float32, no texel empty.
        """
        values = np.ascontiguousarray(irradiance_over_pi, np.float32)
        pages, state = self._smooth_pages(values, lambda v, t: remove_noise(v, t, self._progress))
        self._systems.clear()
        self._prepare_seams(pages, relative=True)
        return self._close_and_fill(pages, state, self._systems.get(True), lowest=0.0)

    def companion(
        self,
        values: F32,
        pages: F32,
        *,
        denoiser: Denoiser | None = None,
        lowest: float | None = None,
        relative: bool = True,
        close_seams: bool = True,
    ) -> F32:
        """Finishes a map that goes with the irradiance, such as directions or a shadow mask.

        Args:
            values: (N, C) linear, any number of channels.
            pages: (P, H, W, 3) the finished irradiance; it says where something stands on a seam.
            denoiser: What removes this map's noise; None leaves it.
            lowest: No value gets below it; None for signed channels.
            relative: Whether values go in proportion to the irradiance, as spherical harmonics do;
                directions and masks don't.
            close_seams: False for what differs from side to side, as tangent space does.

        Returns:
            (P, H, W, C) float32.
        """
        own, state = self._smooth_pages(np.ascontiguousarray(values, np.float32), denoiser)
        if close_seams and relative not in self._systems:
            self._prepare_seams(pages, relative=relative)
        system = self._systems.get(relative) if close_seams else None
        return self._close_and_fill(own, state, system, lowest=lowest)

    def _prepare_seams(self, pages: F32, *, relative: bool) -> None:
        from irradia.bake.seams import seam_system

        if self._points is not None:
            with self._progress.stage("seams"):
                self._systems[relative] = seam_system(
                    self._points,
                    self._texels,
                    pages,
                    valid=self._valid,
                    region=self._region,
                    relative=relative,
                )

    def _smooth_pages(self, values: F32, denoiser: Denoiser | None) -> tuple[F32, NDArray[np.uint8]]:
        """Pages with all covered texels and the ring that filtering reads; and their state."""
        if self._options.denoise and denoiser is not None:
            try:
                values = self._denoised(values, denoiser)
            except MissingDependencyError as error:
                self._progress.say(f"not denoised: {error}")
        values = fill_invalid(values, self._valid, self._texels, self._region)
        pages, state = self._texels.to_pages(values), page_state(self._texels)
        add_rings(pages, state, 1)
        return pages, state

    def _denoised(self, values: F32, denoiser: Denoiser) -> F32:
        """What isn't valid doesn't reach the denoiser."""
        if self._valid.all() and self._region is None:
            return denoiser(values, self._texels)
        region = self._texels.chart if self._region is None else self._region
        kept = replace(
            self._texels,
            pixel=self._texels.pixel[self._valid],
            chart=region[self._valid],
            coverage=self._texels.coverage[self._valid],
            samples=self._texels.samples.take(np.empty(0, np.int64)),  # no denoiser asks for places
        )
        result = values.copy()
        result[self._valid] = denoiser(values[self._valid], kept)
        return result

    def _close_and_fill(
        self, pages: F32, state: NDArray[np.uint8], system: SeamSystem | None, *, lowest: float | None
    ) -> F32:
        from irradia.bake.seams import close_seams

        if system is not None:
            with self._progress.stage("seams"):
                close_seams(system, pages, lowest=lowest)
        if self._options.dilate:
            with self._progress.stage("dilate"):
                add_rings(pages, state, GUTTER_PX - 1)
                fill_rest(pages, state)
        return pages
