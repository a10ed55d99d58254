"""Picks one of many local lights by what it may send to a place.

This work is based on: Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree
Splitting", without the splitting. On the way down, each turn goes by the importance of the two
children's bounds (their section 5.2): power · cosines at both ends, as large as they can be · 1/d².

The probability of a source can be asked for again from a ray's hit, which knows where the ray began but
not the surface there. So the receiver's normal counts only where everything below a node is punctual,
for rays meet none of those; in a scene whose lights are all punctual that is everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.light_bounds import LightBounds
from irradia.transport.light_tree_build import INDEX_BITS, LEAF, PUNCTUAL_ONLY, build_light_tree

_NEAREST_SHARE = 0.5  # of a group's radius squared: how near it counts from inside its sphere


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
    def probability(self, source: mi.UInt32, p: mi.Point3f, active: mi.Bool) -> mi.Float:
        """With which probability :meth:`pick` gives a surface, whatever the receiver's normal."""
        trail = dr.gather(mi.UInt32, self._trail, source, active)
        link, probability = mi.UInt32(0), mi.Float(1.0)
        nowhere = mi.Vector3f(0.0)
        going = mi.Bool(active)
        while going:
            turn = self._turn(link & INDEX_BITS, p, nowhere, going)
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
        by_normal = mi.Bool(self._some_punctual)
        if self._some_punctual and self._some_surface:
            by_normal = (links[0] & PUNCTUAL_ONLY) != 0
        left, right = (self._importance(rows[i : i + 3], p, n, by_normal) for i in (0, 3))
        total = left + right
        return Turn(left / dr.maximum(total, 1e-37), total > 0.0, *links)

    def _importance(
        self, rows: list[mi.Vector4f], p: mi.Point3f, n: mi.Vector3f, by_normal: mi.Bool
    ) -> mi.Float:
        """No less than 0 wherever anything in these bounds sends light to ``p``."""
        radius, power, reach = rows[0].w, rows[1].x, rows[2].w
        towards = mi.Vector3f(rows[0].x, rows[0].y, rows[0].z) - p
        distance2, radius2 = dr.squared_norm(towards), dr.square(radius)
        inverse = dr.rsqrt(dr.maximum(distance2, 1e-24))
        direction = towards * inverse
        outside = distance2 > radius2
        # θ_u: the angle in which the bounds are seen
        sin_u = dr.minimum(radius * inverse, 1.0)
        cos_u = dr.safe_sqrt(1.0 - dr.square(sin_u))
        importance = power / dr.maximum(dr.maximum(distance2, _NEAREST_SHARE * radius2), 1e-12)
        importance = dr.select(dr.square(reach + radius) > distance2, importance, 0.0)

        # ---- at the source: θ' = max(θ − θ_o − θ_u, 0) against the directions that it faces ----
        if self._some_face:
            cos_o, cos_e = rows[1].y, rows[1].z
            axis = mi.Vector3f(rows[2].x, rows[2].y, rows[2].z)
            cos_w = -dr.dot(axis, direction)
            cos_f, sin_f = _turned_back(cos_w, _sine(cos_w), cos_o, _sine(cos_o))
            cos_f, _ = _turned_back(cos_f, sin_f, cos_u, sin_u)
            importance *= dr.select(outside, dr.select(cos_f > cos_e, cos_f, 0.0), 1.0)

        # ---- at the receiver ----
        if self._some_punctual:
            cos_i = dr.dot(n, direction)
            cos_r, _ = _turned_back(cos_i, _sine(cos_i), cos_u, sin_u)
            bounded = by_normal & outside & (dr.squared_norm(n) > 0.0)
            importance *= dr.select(bounded, dr.maximum(cos_r, 0.0), 1.0)
        return importance


def _turned_back(
    cos_a: mi.Float, sin_a: mi.Float, cos_b: mi.Float, sin_b: mi.Float
) -> tuple[mi.Float, mi.Float]:
    """Cosine and sine of max(a − b, 0)."""
    within = cos_a > cos_b
    cosine = dr.select(within, 1.0, cos_a * cos_b + sin_a * sin_b)
    return cosine, dr.select(within, 0.0, sin_a * cos_b - cos_a * sin_b)


def _sine(cosine: mi.Float) -> mi.Float:
    return dr.safe_sqrt(1.0 - dr.square(cosine))
