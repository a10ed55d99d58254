"""relMSE with noise taken out, from independent estimates of the same truth.

If r₁ and r₂ are independent estimates with mean μ, and x depends on neither, then
E[(x − r₁)(x − r₂)] = E[(x − μ)²]: the product, unlike the square, holds nothing of the references'
variance. Single values may be negative; only the mean means something.

The denominator is the mean of both references, as noise would otherwise have to be known: with a
relative bias b and a reference variance v of that mean, the result is b² + 4bv + 6v² to this order, so
it is never flattering. At v = 1e-4 and b = 0.03 that is 1.3 % too much. Blurring the denominator would
change what is measured at shadow edges; taking it from the test would forgive its fireflies.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.metrics.pixelwise import EPSILON, reference_mean


def relmse_without_reference_noise(test: NDArray, reference_a: NDArray, reference_b: NDArray) -> float:
    """:func:`~irradia.metrics.pixelwise.relmse` of ``test`` against the truth behind two references.

    Args:
        test: Linear values.
        reference_a: One estimate of the truth.
        reference_b: Another of equal quality, independent of the first: a different seed.
    """
    return relmse_between_means((test, test), (reference_a, reference_b))


def relmse_between_means(tests: tuple[NDArray, NDArray], references: tuple[NDArray, NDArray]) -> float:
    """The relMSE between the truths behind two pairs: what is left when both sides' noise is gone: the bias.

    Args:
        tests: Two independent estimates by the method in question.
        references: Two independent estimates by the reference.
    """
    x_a, x_b = (np.asarray(x, np.float64) for x in tests)
    r_a, r_b = (np.asarray(r, np.float64) for r in references)
    mean_image = 0.5 * (r_a + r_b)
    floor = EPSILON * reference_mean(mean_image) ** 2
    return float(np.mean((x_a - r_a) * (x_b - r_b) / (mean_image**2 + floor)))
