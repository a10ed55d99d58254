"""Lightmap UVs: charts for every surface that receives light, and their places on the pages.

validate   is the file's TEXCOORD_1 fit for a lightmap?
unwrap     otherwise cut the primitive into flat charts (xatlas), kept by content hash
islands    what is packed: charts, and rectangles for primitives that stand in several places
pack       place islands on a page (xatlas)
density    how many texels a metre gets
layout     all of the above for a scene
"""

from irradia.scene.lightmap_uv.layout import layout_lightmap
from irradia.scene.lightmap_uv.options import LayoutOptions

__all__ = ["LayoutOptions", "layout_lightmap"]
