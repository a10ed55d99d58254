"""Random numbers and directions.

Samples come from the two-dimensional Sobol sequence with hash-based Owen scrambling (Burley 2020,
"Practical Hash-based Owen Scrambling"), a fresh scramble per texel and per pair of dimensions.
Neighbouring texels are therefore independent, which the denoiser needs, while the samples of one
texel are stratified in every elementary interval.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from irradia.transport.backend import dr, mi


def hash_u32(value: mi.UInt32) -> mi.UInt32:
    """A full-avalanche 32-bit permutation (constants: Wellons 2018, "lowbias32")."""
    value = mi.UInt32(value)
    value = (value ^ (value >> 16)) * 0x7FEB352D
    value = (value ^ (value >> 15)) * 0x846CA68B
    return value ^ (value >> 16)


def _reverse_bits(v: mi.UInt32) -> mi.UInt32:
    v = ((v >> 1) & 0x55555555) | ((v & 0x55555555) << 1)
    v = ((v >> 2) & 0x33333333) | ((v & 0x33333333) << 2)
    v = ((v >> 4) & 0x0F0F0F0F) | ((v & 0x0F0F0F0F) << 4)
    v = ((v >> 8) & 0x00FF00FF) | ((v & 0x00FF00FF) << 8)
    return (v >> 16) | (v << 16)


def _owen_reversed(v: mi.UInt32, seed: mi.UInt32) -> mi.UInt32:
    """Owen's scramble of bit-reversed digits: every bit depends on the bits below it alone."""
    v = v ^ (v * 0x3D20ADEA)
    v = v + seed
    v = v * ((seed >> 16) | 1)
    v = v ^ (v * 0x05526C56)
    return v ^ (v * 0x53A22864)


def _sobol_second(index: mi.UInt32) -> mi.UInt32:
    """Second Sobol dimension, bit-reversed: Pascal's triangle modulo 2 in five steps."""
    index = index ^ ((index & 0xAAAAAAAA) >> 1)
    index = index ^ ((index & 0xCCCCCCCC) >> 2)
    index = index ^ ((index & 0xF0F0F0F0) >> 4)
    index = index ^ ((index & 0xFF00FF00) >> 8)
    return index ^ (index >> 16)


def _unit(v: mi.UInt32) -> mi.Float:
    """[0, 1) with 24 bits, so that 1 is never reached."""
    return mi.Float(v >> 8) * 2.0**-24


@dataclass
class Sampler:
    """A point of a scrambled Sobol sequence, padded with fresh pairs of dimensions as asked for.

    Attributes:
        index: Which sample of its sequence this lane draws.
        seed: The lane's scramble; changes with every pair.
    """

    index: mi.UInt32
    seed: mi.UInt32

    def next_2d(self) -> mi.Point2f:
        """The next pair: stratified over ``index`` for a fixed seed, independent of other pairs."""
        self.seed = hash_u32(self.seed + 0x9E3779B9)
        shuffled = _reverse_bits(_owen_reversed(_reverse_bits(self.index), self.seed))
        x = _reverse_bits(_owen_reversed(shuffled, self.seed ^ 0xA511E9B3))
        y = _reverse_bits(_owen_reversed(_sobol_second(shuffled), self.seed ^ 0x63D83595))
        return mi.Point2f(_unit(x), _unit(y))

    def next_1d(self) -> mi.Float:
        """One number, without stratification."""
        self.seed = hash_u32(self.seed + 0x9E3779B9)
        return _unit(hash_u32(self.seed ^ (self.index * 0x2545F491)))


def cosine_hemisphere(u: mi.Point2f) -> mi.Vector3f:
    """A direction about +Z with density cos θ / π (Malley's method)."""
    radius = dr.sqrt(u.x)
    sin_phi, cos_phi = dr.sincos(2.0 * math.pi * u.y)
    return mi.Vector3f(radius * cos_phi, radius * sin_phi, dr.sqrt(dr.maximum(1.0 - u.x, 0.0)))


def to_world(normal: mi.Vector3f, local: mi.Vector3f) -> mi.Vector3f:
    """Rotates ``local`` from +Z to ``normal`` (Duff et al. 2017, branch-free basis)."""
    sign = dr.copysign(mi.Float(1.0), normal.z)
    a = -1.0 / (sign + normal.z)
    b = normal.x * normal.y * a
    tangent = mi.Vector3f(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x)
    bitangent = mi.Vector3f(b, sign + normal.y * normal.y * a, -normal.y)
    return tangent * local.x + bitangent * local.y + normal * local.z
