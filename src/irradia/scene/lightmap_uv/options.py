"""What the user may choose about the lightmap's size."""

from __future__ import annotations

import math
from dataclasses import dataclass

from irradia.core.errors import InputError

MIN_PAGE_PX = 16
MAX_PAGE_PX = 16_384
MAX_TOTAL_TEXELS = 1 << 28


@dataclass(frozen=True)
class LayoutOptions:
    """At most one of ``texels_per_metre`` and ``resolution``; neither means about a million texels.

    Attributes:
        texels_per_metre: Density in world space; pages are as many as that needs.
        resolution: Edge of the one page that is filled.
        max_page_px: Largest page where the density decides.
        default_texels: Texels of the pages together where nothing is chosen.
        padding_px: Free texels between charts: two, so that each side has one for bilinear filtering.
        use_cache: Whether unwraps are kept between runs.
    """

    texels_per_metre: float | None = None
    resolution: int | None = None
    max_page_px: int = 2048
    default_texels: int = 1 << 20
    padding_px: int = 2
    use_cache: bool = True

    def __post_init__(self) -> None:
        if self.resolution is not None and self.texels_per_metre is not None:
            raise InputError(
                "both --resolution and --texels-per-metre were given", fix="Choose one of the two."
            )
        if self.resolution is not None and not MIN_PAGE_PX <= self.resolution <= MAX_PAGE_PX:
            raise InputError(
                f"expected {MIN_PAGE_PX} to {MAX_PAGE_PX} texels, found {self.resolution}",
                where="--resolution",
                fix="Pages of 512 to 4096 suit most scenes.",
            )
        density = self.texels_per_metre
        if density is not None and not (math.isfinite(density) and density > 0):
            raise InputError(
                f"expected a positive number, found {density}",
                where="--texels-per-metre",
                fix="10 to 100 suit most rooms.",
            )
