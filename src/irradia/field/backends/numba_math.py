"""Exponential, logarithm and sine of eight floats at once, which Numba would call lane by lane.

Arguments are brought into a short range, where a polynomial does: each was fitted at Chebyshev nodes and is
nearer to the truth than a float can say. What is left is rounding, two or three units in the last place.
NaN comes out where NaN goes in.
"""

from __future__ import annotations

from irradia.field.backends.numba_compile import inner
from irradia.field.backends.numba_vector import bits8, of_bits8, real8, select

_LOG2_E = 1.4426950408889634
# ln 2 and π/2 in parts with few enough bits that whole multiples of the first ones are exact.
_LN2_HIGH, _LN2_LOW = 0.693359375, -2.12194440e-4
_HALF_PI_HIGH, _HALF_PI_MIDDLE, _HALF_PI_LOW = 1.5703125, 4.837512969970703e-4, 7.54978942e-8
_TWO_OVER_PI = 0.6366197723675814
_BITS_OF_1, _BITS_OF_ROOT = 0x3F800000, 0x3F3504F3  # of 1 and of √½
_WHOLE = 12582912.0  # 1.5 · 2^23: floats around it are whole numbers, whose last bits count them
_EXP_LIMIT = 87.0  # e^±87 are still normal floats


@inner
def exp8(x):
    """e^x for |x| up to 87; beyond, e^±87."""
    x = select(x > _EXP_LIMIT, _EXP_LIMIT, select(x < -_EXP_LIMIT, -_EXP_LIMIT, x))
    shifted = x * _LOG2_E + _WHOLE
    power = shifted - _WHOLE
    r = (x - power * _LN2_HIGH) - power * _LN2_LOW  # in ±ln(2)/2
    p = r * 0.001394857882 + 0.008375128891
    p = p * r + 0.041666218274
    p = p * r + 0.166664154772
    p = p * r + 0.500000010775
    p = p * r + 1.000000037727
    p = p * r + 1.0
    return p * of_bits8((bits8(shifted) + 127) << 23)  # 2^power


@inner
def log8(x):
    """The natural logarithm of normal floats above 0; NaN for infinity."""
    # x = 2^power · m with m in [√½, √2): shifted by the bits of √½, the exponent turns over there.
    shifted = bits8(x) + (_BITS_OF_1 - _BITS_OF_ROOT)
    power = real8(shifted >> 23) - 127.0
    r = of_bits8((shifted & 0x007FFFFF) + _BITS_OF_ROOT) - 1.0
    p = r * -0.07638592451 + 0.12914170324
    p = p * r - 0.13240842694
    p = p * r + 0.14180078719
    p = p * r - 0.16609126505
    p = p * r + 0.20002071675
    p = p * r - 0.25001585123
    p = p * r + 0.33333324024
    p = p * r - 0.49999988294
    p = p * r + 1.0
    return power * _LN2_HIGH + (power * _LN2_LOW + p * r) + (x - x)


@inner
def sin_cos8(x):
    """Sine and cosine, exact to 1e-7 for |x| up to some thousands."""
    shifted = x * _TWO_OVER_PI + _WHOLE
    quarters = shifted - _WHOLE
    r = x - quarters * _HALF_PI_HIGH - quarters * _HALF_PI_MIDDLE - quarters * _HALF_PI_LOW
    return sin_cos_of_quadrant(r, bits8(shifted))


@inner
def sin_cos_of_quadrant(r, quadrant):
    """Sine and cosine of r + quadrant · π/2, for r within ±π/4; of the quadrant two bits count."""
    r2 = r * r
    sine = r2 * 2.71658692e-6 - 1.98391195e-4
    sine = sine * r2 + 8.33332851e-3
    sine = sine * r2 - 1.66666666e-1
    sine = sine * r2 * r + r
    cosine = r2 * 2.43715124e-5 - 1.38865274e-3
    cosine = cosine * r2 + 4.16666137e-2
    cosine = cosine * r2 - 0.5
    cosine = cosine * r2 + 1.0
    odd = (quadrant & 1) == 1
    # Sines are below 0 in quadrants 2 and 3, cosines in 1 and 2.
    sign_of_sine = (quadrant & 2) << 30
    sign_of_cosine = ((quadrant + 1) & 2) << 30
    return (
        of_bits8(bits8(select(odd, cosine, sine)) ^ sign_of_sine),
        of_bits8(bits8(select(odd, sine, cosine)) ^ sign_of_cosine),
    )
