"""What surfaces look like as texels of a lightmap see them: textures averaged over part of a texel.

A texture is often a hundred times denser than the lightmap, and a few of its pixels don't tell what a
texel reflects. The filtered copy of the textures is made for one sweep over the texels and dropped.
"""

from __future__ import annotations

from irradia.transport.backend import dr, mi
from irradia.transport.materials import FILTERS, Appearance, MaterialTable
from irradia.transport.textures import Footprint, TextureTable
from irradia.transport.world import World


class TexelAppearance:
    """Looks of mapped surfaces, each lookup standing for an equal part of a texel.

    Where alpha lets light through, what is seen there and what isn't may not be mixed: such materials
    are looked up in single points.

    Args:
        world: The scene.
        parts: Lookups a texel.
    """

    def __init__(self, world: World, parts: int) -> None:
        self._world, self._parts = world, parts
        textures = TextureTable(world.scene.images, mip_levels=True)
        self._materials = MaterialTable(world.scene.materials, textures)
        textures.freeze()

    def at(self, triangle: mi.UInt32, bary: mi.Point2f, active: mi.Bool) -> Appearance:
        """Mean looks around a point."""
        geometry = self._world.geometry
        uv0, uv1, colour = geometry.texcoords(triangle, bary, active)
        material = geometry.vertices(triangle, active).w
        filters = (self._materials.flags_of(material, active) & FILTERS) != 0
        texels = self._world.page_area_px(triangle, active) * float(self._parts)
        areas = geometry.uv_areas(triangle, active)
        footprint = Footprint(*[dr.select(filters, 0.0, a / dr.maximum(texels, 1e-12)) for a in areas])
        return self._materials.appearance(material, uv0, uv1, colour, active, footprint)
