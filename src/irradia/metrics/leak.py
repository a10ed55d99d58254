"""How much light gets to where none can."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def leak(values: NDArray, inside: NDArray[np.bool_], outside: NDArray[np.bool_]) -> float:
    """The brightest value in a closed place over the mean of the light outside.

    Args:
        values: (N, C) linear light.
        inside: (N,) places that no light can reach.
        outside: (N,) places that light does reach.

    Returns:
        0 where all is black inside; infinity where it isn't, but is outside.

    Raises:
        ValueError: Nothing lies inside, or nothing outside: there is nothing to measure.
    """
    if not inside.any() or not outside.any():
        raise ValueError("leak needs places inside and outside")
    brightest = float(np.abs(values[inside]).max())
    mean = float(np.abs(values[outside]).mean(dtype=np.float64))
    if mean == 0.0:
        return float("inf") if brightest > 0.0 else 0.0
    return brightest / mean
