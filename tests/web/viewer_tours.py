"""Browsers that were driven through the viewer, and the pictures that they brought back."""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

SOURCES = ["lightmap", "directional", "field", "probes", "three-probes"]
Found = dict[str, Any]


def pixels(picture: str) -> NDArray[np.float64]:
    """(H, W, 3) coded values, 0 to 255, of a PNG in base64."""
    with Image.open(io.BytesIO(base64.b64decode(picture))) as image:
        return np.asarray(image.convert("RGB"), np.float64)


def steps_apart(one: NDArray, other: NDArray) -> float:
    """By how much pictures differ, in 255ths, a few pixels at edges aside."""
    return float(np.percentile(np.abs(one - other), 99.0))
