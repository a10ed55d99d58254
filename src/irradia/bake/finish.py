"""From gathered texels to pages that can be filtered: fill, denoise, dilate."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.bake.denoise import denoise as remove_noise
from irradia.bake.dilate import dilate, fill_invalid
from irradia.bake.texels import TexelSet
from irradia.core.errors import MissingDependencyError
from irradia.core.progress import Progress
from irradia.scene.types import F32


def finish(
    texels: TexelSet,
    irradiance_over_pi: F32,
    valid: NDArray[np.bool_],
    *,
    denoise: bool,
    progress: Progress,
) -> F32:
    """Makes lightmap pages of a bake's result.

    Args:
        texels: The covered texels.
        irradiance_over_pi: (N, 3) linear.
        valid: (N,) False where most rays met back faces; such texels take light from their chart.
        denoise: Whether to remove noise; where the denoiser is missing this is said and left out.
        progress: Shows the stages "denoise" and "dilate".

    Returns:
        (pages, height, width, 3) float32, no texel empty.
    """
    values = fill_invalid(np.ascontiguousarray(irradiance_over_pi, np.float32), valid, texels)
    if denoise:
        try:
            values = remove_noise(values, texels, progress)
        except MissingDependencyError as error:
            progress.say(f"not denoised: {error}")
    with progress.stage("dilate"):
        return dilate(values, texels)
