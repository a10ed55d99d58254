"""Directional maps as files say what they hold."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.directional import DirectionalMaps
from irradia.bake.directional_modes import MODES
from irradia.export.directional_files import write_directional_files
from irradia.export.map_files import read_map
from irradia.formats.lightmap import read_lightmap


@pytest.mark.parametrize("mode", MODES)
def test_each_map_is_a_file_of_its_own_with_its_name_as_quantity(mode, tmp_path):
    rng = np.random.default_rng(6)
    maps = DirectionalMaps(
        mode, {name: rng.random((2, 8, 12, 3)).astype(np.float32) for name in MODES[mode].maps}
    )
    coverage = np.ones((2, 8, 12), np.float32)
    paths = write_directional_files(tmp_path, maps, coverage, provenance={"seed": 3})
    assert len(paths) == 2 * len(maps.pages)
    for name, pages in maps.pages.items():
        file = read_lightmap(tmp_path / f"lightmap_{name}.exr")
        assert file.quantity == name
        assert file.provenance == {"seed": 3}
        np.testing.assert_array_equal(file.pages, pages)
        if name not in MODES[mode].light_maps:
            assert (file.scale, file.exposure_ev) == (1.0, 0.0)


def test_other_formats_hold_them_too(tmp_path):
    pages = np.random.default_rng(1).random((1, 8, 8, 3)).astype(np.float32)
    maps = DirectionalMaps("dominant", {"direction": pages})
    (path,) = write_directional_files(tmp_path, maps, np.ones((1, 8, 8), np.float32), ("ktx2-half",))
    assert path.name == "lightmap_direction.half.ktx2"
    np.testing.assert_allclose(read_map(path), pages[0], atol=5e-4)
