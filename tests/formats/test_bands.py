"""Bands: all rows once, in order, whatever the number of cores."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.formats.bands import map_bands
from irradia.formats.bc6h import encode_bc6h
from irradia.formats.ktx2 import encode_ktx2
from irradia.formats.png import encode_png


@pytest.mark.parametrize("n_cores", [None, 1, 2, 7])
@pytest.mark.parametrize(("n_rows", "band_rows"), [(0, 4), (1, 4), (4, 4), (9, 4), (100, 1)])
def test_every_row_is_worked_on_once_and_in_order(
    monkeypatch: pytest.MonkeyPatch, n_cores: int | None, n_rows: int, band_rows: int
) -> None:
    monkeypatch.setattr("os.cpu_count", lambda: n_cores)
    bands = map_bands(lambda band: list(range(band.start, band.stop)), n_rows, band_rows)
    assert [row for rows in bands for row in rows] == list(range(n_rows))
    assert all(0 < len(rows) <= band_rows for rows in bands)


def test_errors_come_out_of_their_band() -> None:
    with pytest.raises(ZeroDivisionError):
        map_bands(lambda band: 1 // (band.start - 2), 4, 1)


def test_files_have_the_same_bytes_on_any_number_of_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    """Large enough for several bands, and for several of zstd's jobs."""
    rng = np.random.default_rng(61)
    rgb = rng.random((1400, 1024, 3), np.float32)
    png = rng.integers(0, 256, (1400, 1024, 4), np.uint8)
    found = []
    for n_cores in (1, 3):
        monkeypatch.setattr("os.cpu_count", lambda n=n_cores: n)
        found.append((encode_ktx2(rgb[None], "half"), encode_png(png), encode_bc6h(rgb[:300]).tobytes()))
    assert found[0] == found[1]
