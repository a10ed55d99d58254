"""``--probes`` says where probes stand."""

from __future__ import annotations

import pytest

from irradia.bake.probes.options import ProbeOptions
from irradia.core.errors import InputError


def test_forms_are_read():
    grid = ProbeOptions.parse("grid:0.5", samples=64, seed=3)
    assert (grid.placement, grid.spacing_m, grid.samples, grid.seed) == ("grid", 0.5, 64, 3)
    random = ProbeOptions.parse("random:200")
    assert (random.placement, random.count) == ("random", 200)
    assert ProbeOptions.parse("auto").placement == "auto"


@pytest.mark.parametrize(
    "text",
    ["", "grid", "grid:", "grid:0", "grid:-1", "grid:nan", "grid:inf", "grid:x", "random", "random:0",
     "random:1.5", "random:1e9", "auto:3", "octree", "Grid:1"],
)  # fmt: skip
def test_what_is_no_placement_is_refused(text):
    with pytest.raises(InputError, match="expected"):
        ProbeOptions.parse(text)


def test_samples_are_bounded():
    with pytest.raises(InputError, match="--probe-samples"):
        ProbeOptions.parse("auto", samples=0)
