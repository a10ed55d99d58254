"""Picks one of many local lights by what it may send to a place.

This work is based on: Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree
Splitting", without the splitting. On the way down, each turn goes by the importance of the two
children's bounds: power · cosines at both ends · 1/d². Where theirs (section 5.2) takes the largest
cosines that angles of bounding cones allow, ours takes heights over planes, raised by the bounds'
radius: 0 for the same places, smoother elsewhere, and without a square root for each cosine.

The probability of a source can be asked for again from a ray's hit, which knows where the ray began but
not the surface there. So the receiver's normal counts only where everything below a node is punctual,
for rays meet none of those; in a scene whose lights are all punctual that is everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.light_bounds import UNBOUNDED_M, LightBounds
from irradia.transport.light_tree_build import ALL_ROUND, INDEX_BITS, LEAF, PUNCTUAL_ONLY, build_light_tree

# How near a group counts from inside its sphere, of its radius squared. The mean of 1/d² in a ball's
# middle asks for 1/3, but misses the places beside one of the lamps: their error was half as large again.
_NEARNESS = 0.05
_LEAST_LIT = 0.05  # of a group's radius, added to the width of its cones: no group counts for nothing


@dataclass
class Turn:
    """What one node says.

    Attributes:
        p_left: Probability of its left child.
        lit: Whether either child may send anything.
        left, right: Links to the children.
    """

    p_left: mi.Float
    lit: mi.Bool
    left: mi.UInt32
    right: mi.UInt32


@dataclass
class TreePick:
    """A source picked.

    Attributes:
        source: Its number.
        probability: Of this pick; 0 where no source may send anything.
        u: What is left of the random number, in [0, 1).
    """

    source: mi.UInt32
    probability: mi.Float
    u: mi.Float


class LightTree:
    """A tree over two or more local sources on the device.

    Args:
        sources: Bounds of each.
        is_surface: (N,) which of them rays can meet.
    """

    def __init__(self, sources: LightBounds, is_surface: NDArray[np.bool_]) -> None:
        table = build_light_tree(sources, is_surface)
        self._nodes = mi.Float(table.nodes.ravel())
        self._trail = mi.UInt32(table.trail)
        self._some_punctual = not is_surface.all()
        self._some_surface = bool(is_surface.any())
        self._some_face = bool((sources.spread < np.pi).any())
        self._some_end = bool((sources.reach < UNBOUNDED_M).any())
        self.depth = table.depth

    @dr.syntax
    def pick(self, p: mi.Point3f, n: mi.Vector3f, u: mi.Float, active: mi.Bool) -> TreePick:
        """Goes down by chance.

        Args:
            p: The receiver.
            n: Its unit normal, or 0 where light from every side counts.
            u: Random number.
            active: Lanes that pick.
        """
        link, probability, rest = mi.UInt32(0), mi.Float(1.0), mi.Float(u)
        going = mi.Bool(active)
        while going:
            turn = self._turn(link & INDEX_BITS, p, n, going)
            goes_left = rest < turn.p_left
            chance = dr.select(goes_left, turn.p_left, 1.0 - turn.p_left)
            rest = dr.select(goes_left, rest, rest - turn.p_left) / dr.maximum(chance, 1e-20)
            rest = dr.clip(rest, 0.0, 1.0 - 2.0**-24)
            probability = dr.select(turn.lit, probability * chance, 0.0)
            link = dr.select(goes_left, turn.left, turn.right)
            going &= turn.lit & ((link & LEAF) == 0)
        probability = dr.select(active, probability, 0.0)
        return TreePick(link & INDEX_BITS, probability, rest)

    @dr.syntax
    def probability(self, source: mi.UInt32, p: mi.Point3f, n: mi.Vector3f, active: mi.Bool) -> mi.Float:
        """With which probability :meth:`pick` gives a source; that of a surface doesn't depend on ``n``."""
        trail = dr.gather(mi.UInt32, self._trail, source, active)
        link, probability = mi.UInt32(0), mi.Float(1.0)
        going = mi.Bool(active)
        while going:
            turn = self._turn(link & INDEX_BITS, p, n, going)
            goes_left = (trail & 1) == 0
            chance = dr.select(goes_left, turn.p_left, 1.0 - turn.p_left)
            probability = dr.select(turn.lit, probability * chance, 0.0)
            link = dr.select(goes_left, turn.left, turn.right)
            trail = trail >> 1
            going &= turn.lit & ((link & LEAF) == 0)
        return dr.select(active, probability, 0.0)

    def _turn(self, node: mi.UInt32, p: mi.Point3f, n: mi.Vector3f, active: mi.Bool) -> Turn:
        rows = [dr.gather(mi.Vector4f, self._nodes, node * 6 + i, active) for i in range(6)]
        links = [dr.reinterpret_array(mi.UInt32, rows[i].w) for i in (1, 4)]
        by_normal = dr.squared_norm(n) > 0.0
        if self._some_punctual and self._some_surface:
            by_normal &= (links[0] & PUNCTUAL_ONLY) != 0
        left, right = (self._importance(rows[i : i + 3], p, n, by_normal) for i in (0, 3))
        total = left + right
        return Turn(left / dr.maximum(total, 1e-37), total > 0.0, *links)

    def _importance(
        self, rows: list[mi.Vector4f], p: mi.Point3f, n: mi.Vector3f, by_normal: mi.Bool
    ) -> mi.Float:
        """Above 0 wherever anything in these bounds sends light to ``p``."""
        radius, power, reach = rows[0].w, rows[1].x, rows[2].w
        towards = mi.Vector3f(rows[0].x, rows[0].y, rows[0].z) - p
        distance2, radius2 = dr.squared_norm(towards), dr.square(radius)
        inverse = dr.rsqrt(distance2 + _NEARNESS * radius2 + 1e-12)
        importance = power * dr.square(inverse)
        if self._some_end:
            importance = dr.select(dr.square(reach + radius) > distance2, importance, 0.0)
        if self._some_face:
            along = -dr.dot(mi.Vector3f(rows[2].x, rows[2].y, rows[2].z), towards)
            importance *= _facing(rows[1].y, rows[1].z, along, distance2, radius, inverse)
        if self._some_punctual:
            above = dr.clip((dr.dot(n, towards) + radius) * inverse, 0.0, 1.0)
            importance *= dr.select(by_normal, above, 1.0)
        return importance


def _facing(
    u: mi.Float, v: mi.Float, along: mi.Float, distance2: mi.Float, radius: mi.Float, inverse: mi.Float
) -> mi.Float:
    """How far sources turn towards the receiver, at best.

    In the plane through their axis and the receiver, (``along``, ``across``), lie the directions that
    they face, a cone of half-angle θ. Surfaces shine into the half-space before them: (u, v) = (cos θ,
    sin θ), and the receiver's height over the nearest such plane counts as the cosine does. Spots
    shine into the cone alone: (u, v) = (sin θ, −cos θ), and the depth below the cone's surface counts
    against that on the axis, times the share of the group's cones that may hold one place, if they are
    narrower than the group. The bounds' radius is added to either, so that 0 means dark.
    """
    across = dr.safe_sqrt(distance2 - dr.square(along))
    width = u * dr.sqrt(distance2)
    depth = u * along + v * across + radius
    surface = dr.select(along >= width, 1.0, dr.clip(depth * inverse, 0.0, 1.0))
    within = dr.rcp(width + radius + 1e-20)
    spot = dr.clip(depth * within, 0.0, 1.0) * dr.square((width + _LEAST_LIT * radius) * within)
    return dr.select(u > ALL_ROUND * 0.5, 1.0, dr.select(v < 0.0, spot, surface))
