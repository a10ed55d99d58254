"""three.js' LightProbeGrid: texel for texel where its shader looks for them."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.probes import ProbeGrid
from irradia.formats.probes_three import pack_atlas, read_three_grid, unpack_atlas, write_three_grid

from .test_probes import made

SHAPE = (2, 3, 4)


def numbered() -> np.ndarray:
    """Coefficient of probe p, order i, channel c: p + (3 i + c) / 32, exact in half."""
    p, i, c = np.meshgrid(np.arange(24), np.arange(9), np.arange(3), indexing="ij")
    return (p + (3 * i + c) / 32).astype(np.float32)


def shader_reads(atlas: np.ndarray, x: int, y: int, z: int) -> list[tuple[float, ...]]:
    """The nine coefficients as lightprobes_pars_fragment.glsl takes them from its texture."""
    nz = atlas.shape[0] // 7 - 2
    s = [atlas[t * (nz + 2) + 1 + z, y, x].astype(float) for t in range(7)]
    flat = np.concatenate(s)
    return [tuple(flat[3 * i : 3 * i + 3]) for i in range(9)]


def test_every_coefficient_lies_where_the_shader_reads_it():
    atlas = pack_atlas(numbered(), SHAPE)
    assert atlas.shape == (7 * (4 + 2), 3, 2, 4)
    for x, y, z in np.ndindex(SHAPE):
        probe = x + 2 * (y + 3 * z)
        assert shader_reads(atlas, x, y, z) == [tuple(row) for row in numbered()[probe].astype(float)]


def test_padding_repeats_the_outer_slices():
    atlas = pack_atlas(numbered(), SHAPE)
    for volume in range(7):
        own = atlas[6 * volume : 6 * volume + 6]
        np.testing.assert_array_equal(own[0], own[1])
        np.testing.assert_array_equal(own[5], own[4])


def test_atlas_comes_back():
    np.testing.assert_array_equal(unpack_atlas(pack_atlas(numbered(), SHAPE)), numbered())


def test_brightest_light_stays_finite():
    assert np.isfinite(pack_atlas(np.full((24, 9, 3), 1e6, np.float32), SHAPE)).all()


@pytest.fixture
def written(tmp_path: Path) -> Path:
    path = tmp_path / "probes.three.json"
    write_three_grid(path, made(coefficients=numbered()[:12]))
    return path


def test_file_is_golden(written: Path):
    """Box half a spacing larger than the probes; first texel: red, green, blue of L0, red of L1y."""
    document = json.loads(written.read_text())
    texture = document.pop("texture")
    data = base64.b64decode(texture.pop("data"))
    assert texture == {"width": 2, "height": 3, "depth": 28, "format": "rgba16f"}
    assert document == {
        "version": 1,
        "type": "LightProbeGrid",
        "width": 1.0,
        "height": 1.5,
        "depth": 0.5,
        "resolution": [2, 3, 2],
        "position": [1.25, 2.5, 3.125],
        "light": "indirect",
    }
    assert len(data) == 8 * 2 * 3 * 28
    assert data[:8].hex() == "0000002800" + "2c002e"


def test_grid_comes_back(written: Path):
    found = read_three_grid(written)
    grid = made().structure
    assert isinstance(grid, ProbeGrid)
    assert found.grid.shape == grid.shape
    np.testing.assert_allclose(found.grid.origin, grid.origin)
    np.testing.assert_allclose(found.grid.spacing, grid.spacing)
    np.testing.assert_array_equal(found.coefficients, numbered()[:12])
    assert found.light == "indirect"


def test_only_grids_can_be_written(tmp_path: Path):
    with pytest.raises(InputError, match="grid:SPACING"):
        write_three_grid(tmp_path / "x.json", made(structure=None))


@pytest.mark.parametrize(
    ("key", "value"),
    [("type", "Mesh"), ("version", 2), ("resolution", [2, 3]), ("resolution", [2, 3, 3]),
     ("resolution", [0, 3, 2]), ("resolution", [1 << 20, 1 << 20, 1 << 20]), ("width", "x"),
     ("position", [1.0]), ("light", "none"), ("texture", {"data": "@@@"}), ("texture", {})],
)  # fmt: skip
def test_damage_is_refused(written: Path, key, value):
    document = json.loads(written.read_text())
    written.write_text(json.dumps(document | {key: value}))
    with pytest.raises(InputError):
        read_three_grid(written)


def test_file_cut_short_is_refused(written: Path):
    text = written.read_text()
    written.write_text(text[: len(text) // 2])
    with pytest.raises(InputError):
        read_three_grid(written)
