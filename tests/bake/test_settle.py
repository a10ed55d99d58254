"""The iteration that carries light around."""

from __future__ import annotations

from typing import Any

import pytest

from irradia.bake.settle import rays_to_settle, settle


@pytest.mark.parametrize("reflectance", [0.0, 0.5, 0.8, 0.95])
def test_geometric_series_is_summed_in_few_epochs(reflectance: float):
    means: list[float] = []
    found: Any = settle(
        1.0,  # type: ignore[arg-type]
        lambda light, scale: 1.0 + reflectance * light * scale,  # type: ignore[arg-type, operator, return-value]
        lambda light: light,  # type: ignore[arg-type, return-value]
        means.append,
    )
    assert found == pytest.approx(1.0 / (1.0 - reflectance), rel=2e-3)
    assert len(means) <= 6


def test_small_map_settles_on_more_rays_a_texel():
    assert rays_to_settle(1_000, 4096) > rays_to_settle(100_000, 4096) >= 1
