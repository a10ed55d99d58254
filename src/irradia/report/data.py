"""What a report is made from: arrays and plain values, whoever made them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class Comparison:
    """One camera's view of the bake beside the path-traced references.

    Attributes:
        name: The camera's name.
        baked, reference: (H, W, 3) linear radiance, diffuse transport both.
        full: The same view with full materials, shown unscored; None where it wasn't rendered.
        flip: (H, W) HDR-FLIP error in [0, 1].
        scores: Metric by name, as :mod:`irradia.metrics` gives them.
        reference_spp, full_spp: Samples per pixel of the references.
        label: What ``baked`` is called on the page.
        under_noise: Names of scores that the reference's own noise hides.
        exposure_ev: Stops; None for automatic exposure of the reference.
    """

    name: str
    baked: F32
    reference: F32
    full: F32 | None
    flip: F32
    scores: Mapping[str, float]
    reference_spp: int
    full_spp: int = 0
    label: str = "Baked"
    under_noise: frozenset[str] = frozenset()
    exposure_ev: float | None = None


@dataclass(frozen=True)
class MapPicture:
    """A map that goes with the lightmap.

    Attributes:
        name: What it shows, for people.
        pixels: (H, W, 3) its first page, as 8-bit sRGB pixels.
    """

    name: str
    pixels: NDArray[np.uint8]


@dataclass(frozen=True)
class LightmapSummary:
    """The finished pages.

    Attributes:
        pages: (P, H, W, 3) E/π, dilated.
        coverage: (P, H, W) share of each texel that charts cover.
        texels_per_metre: Median density.
        n_invalid: Texels that lie inside geometry.
        companions: Maps beside the plain one.
        facts: Label and value of what else was baked, in reading order.
    """

    pages: F32
    coverage: F32
    texels_per_metre: float
    n_invalid: int = 0
    companions: tuple[MapPicture, ...] = ()
    facts: tuple[tuple[str, str], ...] = ()

    @property
    def n_texels(self) -> int:
        """Covered texels."""
        return int(np.count_nonzero(self.coverage))

    @property
    def utilisation(self) -> float:
        """Covered texels over all texels."""
        return self.n_texels / max(self.coverage.size, 1)


@dataclass(frozen=True)
class Performance:
    """What the bake cost.

    Attributes:
        stage_s: Wall seconds by stage, in order.
        bake_s: What of it made the bake; the rest went into its references.
        samples_per_second: Gather rays with their share of next-event rays, over all epochs.
        rays_per_second: Rays of either kind; None where they weren't counted.
        peak_memory_bytes: Highest resident size of the process; None where the system doesn't tell.
        counts: Anything else that was counted, by label (epochs, launches per pass …).
    """

    stage_s: Mapping[str, float]
    bake_s: float
    samples_per_second: float
    rays_per_second: float | None = None
    peak_memory_bytes: int | None = None
    counts: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Convergence:
    """How the estimate's mean nears the reference's as samples are added.

    Attributes:
        samples: (N,) samples per texel.
        mean_ratio: (N,) mean of the bake over mean of ``against``.
        against: What the ratio is taken to.
    """

    samples: tuple[int, ...]
    mean_ratio: tuple[float, ...]
    against: str = "final mean"


@dataclass(frozen=True)
class Rival:
    """One way to store a scene's light, and how far it is from the truth.

    Attributes:
        name: For people.
        n_bytes: As shipped.
        flip: Mean HDR-FLIP over the views; None where it has no pictures.
        relmse: Likewise, the reference's noise removed.
        mse: Mean squared error at places in space; None where it knows only surfaces.
        under_noise: Whether ``flip`` is no more than the reference's own noise.
    """

    name: str
    n_bytes: int
    flip: float | None = None
    relmse: float | None = None
    mse: float | None = None
    under_noise: bool = False


@dataclass(frozen=True)
class FieldSummary:
    """A neural field, judged.

    Attributes:
        facts: Label and value of what it is and what it costs, in reading order.
        comparisons: Views; may be empty.
        rivals: The field first, then what it is compared with.
    """

    facts: tuple[tuple[str, str], ...]
    comparisons: tuple[Comparison, ...]
    rivals: tuple[Rival, ...]


@dataclass(frozen=True)
class EvaluationData:
    """Everything in the report of one field.

    Attributes:
        title: The scene's name.
        stage_s: Wall seconds by stage.
        provenance: :meth:`irradia.core.provenance.Provenance.to_dict`.
        notes: What the user should know.
    """

    title: str
    field: FieldSummary
    stage_s: Mapping[str, float]
    provenance: Mapping[str, Any]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class LiveView:
    """The viewer with what was baked, as a file beside the report.

    Attributes:
        file: Its name.
        n_bytes: What opening it loads.
    """

    file: str
    n_bytes: int


@dataclass(frozen=True)
class ReportData:
    """Everything in one report.

    Attributes:
        title: The scene's name.
        facts: Label and value of what was in the scene, in reading order.
        comparisons: Views; may be empty.
        notes: What the user should know: defaults taken, things unsupported.
        provenance: :meth:`irradia.core.provenance.Provenance.to_dict`.
        neural_field: Where one was trained from the bake.
        live_view: Where there is one.
    """

    title: str
    facts: tuple[tuple[str, str], ...]
    comparisons: tuple[Comparison, ...]
    lightmap: LightmapSummary
    performance: Performance
    provenance: Mapping[str, Any]
    convergence: Convergence | None = None
    notes: tuple[str, ...] = ()
    neural_field: FieldSummary | None = None
    live_view: LiveView | None = None
