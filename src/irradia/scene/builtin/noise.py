"""Noise that repeats without a seam, for procedural textures."""

from __future__ import annotations

import numpy as np

from irradia.core.rng import Seed
from irradia.scene.builtin.mesh import Array


def cloud(size_px: int, name: str, *, slope: float = 1.6, lowest: float = 1.0, stretch: float = 1.0) -> Array:
    """(size, size) noise with amplitude 1 / frequency^slope, uniform in [0, 1], periodic.

    Args:
        size_px: Side of the texture.
        name: Names the random stream.
        slope: Higher is smoother.
        lowest: Frequencies below it (cycles per texture) are damped.
        stretch: Above 1 draws the grain out along the columns (wood, veins).
    """
    white = Seed(1).child(name).numpy().normal(size=(size_px, size_px))
    frequency_y = np.fft.fftfreq(size_px, 1 / size_px)[:, None] * stretch
    frequency_x = np.fft.rfftfreq(size_px, 1 / size_px)[None]
    frequency = np.hypot(frequency_x, frequency_y)
    gain = np.maximum(frequency, lowest) ** -slope
    gain[0, 0] = 0.0
    noise = np.fft.irfft2(np.fft.rfft2(white) * gain, s=white.shape)
    return _ranked(noise)


def veins(size_px: int, name: str, *, sharpness: float = 14.0) -> Array:
    """(size, size) thin branching lines, 1 on a line and falling to 0: marble."""
    lines = np.zeros((size_px, size_px))
    for k, lowest in enumerate((1.0, 2.5, 5.0)):
        field = cloud(size_px, f"{name}-{k}", slope=1.9, lowest=lowest)
        strength = cloud(size_px, f"{name}-mask-{k}", slope=2.0, lowest=1.5)
        lines = np.maximum(lines, np.exp(-sharpness * 2**k * np.abs(field - 0.5)) * strength**1.5)
    return lines


def _ranked(noise: Array) -> Array:
    """Spreads values evenly over [0, 1], so that thresholds mean shares of the area."""
    # Normal noise through its own distribution function; a logistic stands in for the error function.
    return 1.0 / (1.0 + np.exp(-1.702 * noise / noise.std()))
