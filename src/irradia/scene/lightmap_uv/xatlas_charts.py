"""Charts as xatlas grows them: least stretch and few seams, at a cost that rises faster than the mesh."""

from __future__ import annotations

import numpy as np

from irradia.scene.lightmap_uv.atlas import new_atlas
from irradia.scene.lightmap_uv.charts import Charts, collapse_strays, triangle_areas, without_area
from irradia.scene.types import F32, F64, U32

# xatlas packs what it cut on a page of about this edge. It rounds a chart's extent to whole texels of
# that page, so a coarse one would stretch small charts.
_PAGE_PX = 2048
_MAX_COST = 16.0  # xatlas stops growing a chart here; its own 2 gives a quarter more charts
SETTINGS = f"{_PAGE_PX} {_MAX_COST}"  # what else decides on the charts


def xatlas_charts(positions: F64, normals: F32, indices: U32) -> Charts:
    """Runs xatlas on a mesh scaled so that its smallest numbers stay clear of xatlas's epsilons."""
    import xatlas

    areas = triangle_areas(positions, indices)
    mean = float(areas.mean()) if len(areas) else 0.0
    if mean <= 0.0:
        return without_area(indices)
    to_unit = 1.0 / np.sqrt(mean)
    centred = positions - 0.5 * (positions.min(axis=0) + positions.max(axis=0))

    options = xatlas.ChartOptions()
    options.max_cost = _MAX_COST
    packing = xatlas.PackOptions()
    packing.texels_per_unit = _PAGE_PX / np.sqrt(1.4 * len(indices))
    packing.rotate_charts = False
    points = np.ascontiguousarray(centred * to_unit, np.float32)
    triangles = np.ascontiguousarray(indices, np.uint32)
    with new_atlas() as atlas:
        atlas.add_mesh(points, triangles, normals)
        atlas.generate(options, packing)
        source, new_indices, uv = atlas.get_mesh(0)
        _, vertex_chart = atlas.get_mesh_vertex_assignment(0)
        if atlas.chart_count == 0:
            return without_area(indices)
        unit_uv = uv * np.array([atlas.width, atlas.height]) / packing.texels_per_unit
    return collapse_strays(
        positions, source, new_indices, (unit_uv / to_unit).astype(np.float32), vertex_chart
    )
