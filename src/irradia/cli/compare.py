"""``irradia compare``: metrics between two images or lightmaps."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from irradia.cli import options
from irradia.cli.output import finish

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from irradia.export.map_files import MapPage
    from irradia.metrics import Comparison

_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@click.command("compare")
@click.argument("test", type=_FILE)
@click.argument("reference", type=_FILE)
@options.json_option
def command(test: Path, reference: Path, as_json: bool) -> None:
    """Metrics between two images or lightmaps.

    TEST is judged against REFERENCE; .exr, .hdr, .png and .jpg are read, and lightmap pages in all
    formats of `irradia bake --format`. Where a lightmap's file tells coverage, as .exr does, only texels
    count that charts cover in both.
    """
    from irradia.metrics import compare

    found = compare(*load_pair(test, reference))
    finish(as_json, found.to_json(), describe(found))


def load_pair(
    test: Path, reference: Path
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_] | None]:
    """Both files as linear arrays, with the mask of what counts."""
    from irradia.formats.lightmap import is_lightmap, read_lightmap

    if all(file.suffix.lower() == ".exr" and is_lightmap(file) for file in (test, reference)):
        whole = read_lightmap(test), read_lightmap(reference)
        return whole[0].pages, whole[1].pages, _counted([each.coverage for each in whole])
    first, second = _read_one(test), _read_one(reference)
    return first.rgb, second.rgb, _counted([first.coverage, second.coverage])


def _read_one(file: Path) -> MapPage:
    from irradia.export.map_files import MapPage, is_map, read_map_page
    from irradia.formats.image import read_image

    return read_map_page(file) if is_map(file) else MapPage(read_image(file), None)


def _counted(coverages: list[NDArray[np.float32] | None]) -> NDArray[np.bool_] | None:
    """Where all that tell it are covered; None where none tells, or sizes differ, which is found later."""
    covered = [coverage > 0.0 for coverage in coverages if coverage is not None]
    if not covered or covered[0].shape != covered[-1].shape:
        return None
    return covered[0] & covered[-1]


def describe(found: Comparison) -> str:
    """The metrics as an aligned list."""
    rows = (
        ("HDR-FLIP", f"{found.flip:.4f}", f"mean, {found.flip_start_ev:+d} to {found.flip_stop_ev:+d} EV"),
        ("PSNR", f"{found.psnr_db:.2f} dB", "of display values"),
        ("relMSE", f"{found.relmse:.3e}", ""),
        ("SMAPE", f"{found.smape:.4f}", ""),
        ("mean ratio", f"{found.mean_ratio:.5f}", "test over reference"),
        ("95th percentile", f"{found.relative_error_p95:.4f}", "of the relative error"),
        ("compared", f"{found.n_pixels}", "pixels or covered texels"),
    )
    return "\n".join(f"{name:<16} {value:>12}  {note}".rstrip() for name, value, note in rows)
