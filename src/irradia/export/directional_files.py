"""Directional maps as files beside the lightmap: ``lightmap_sh_x.exr`` and so on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.bake.directional import DirectionalMaps
from irradia.bake.directional_modes import MODES
from irradia.export.map_files import DEFAULT_FORMATS, write_maps
from irradia.formats.lightmap import LightmapFile, make_lightmap


def directional_lightmaps(
    maps: DirectionalMaps, coverage: NDArray[np.float32], provenance: Mapping[str, Any] | None = None
) -> dict[str, LightmapFile]:
    """Each map as a lightmap file's content, by map name, which is also its quantity.

    Maps that hold numbers of [−1, 1] as x/2 + 1/2 have the scale 1 and no exposure.

    Args:
        maps: Finished.
        coverage: (P, H, W) of the plain map.
        provenance: As the plain map's.
    """
    files = {}
    for name, pages in maps.pages.items():
        file = replace(make_lightmap(pages, coverage, provenance), quantity=name)
        is_light = name in MODES[maps.mode].light_maps
        files[name] = file if is_light else replace(file, scale=1.0, exposure_ev=0.0)
    return files


def write_directional_files(
    folder: Path | str,
    maps: DirectionalMaps,
    coverage: NDArray[np.float32],
    formats: Sequence[str] = DEFAULT_FORMATS,
    provenance: Mapping[str, Any] | None = None,
) -> list[Path]:
    """Writes all maps in every format, as ``write_maps`` does the plain one, and returns the files."""
    return [
        path
        for name, file in directional_lightmaps(maps, coverage, provenance).items()
        for path in write_maps(folder, file, formats, name=f"lightmap_{name}")
    ]
