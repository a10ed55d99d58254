"""Light from infinitely far away: equirectangular maps read from a file, or one colour."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from irradia.core.errors import InputError
from irradia.formats.image import read_image
from irradia.scene.types import F32, F64, Environment, Rgb

MAX_WIDTH_PX = 4096
ASPECT_TOLERANCE = 0.01  # stitched panoramas are often a pixel or two off 2:1
CONSTANT_SIZE_PX = (8, 16)  # height, width of the map that holds one colour


def load_environment(path: Path | str, *, rotation_deg: float = 0.0, strength: float = 1.0) -> Environment:
    """Reads an equirectangular map.

    Args:
        path: A 2:1 ``.hdr``, ``.exr`` (linear Rec.709 radiance), ``.png`` or ``.jpg`` (sRGB).
        rotation_deg: Turns the surroundings about +Y, counter-clockwise seen from above: the
            right-handed rotation that a glTF node would apply.
        strength: Factor on the radiance.

    Raises:
        InputError: The file can't be read, is not 2:1, or holds NaN, infinite or negative values.
    """
    file = Path(path)
    if not file.is_file():
        raise InputError("there is no such environment map", where=str(file))
    return environment_from_pixels(
        read_image(file), rotation_deg=rotation_deg, strength=strength, name=file.name
    )


def environment_from_pixels(
    pixels: F32, *, rotation_deg: float = 0.0, strength: float = 1.0, name: str = "environment"
) -> Environment:
    """Makes an environment from (height, width, ≥3) linear radiance, laid out as its type says.

    Maps wider than 4096 are averaged down over solid angle, so that a sun keeps its energy.
    """
    _check(pixels, name)
    if not math.isfinite(strength) or strength < 0.0:
        raise InputError(f"strength must be finite and not negative, found {strength}", where=name)
    if not math.isfinite(rotation_deg):
        raise InputError(f"rotation must be a finite angle, found {rotation_deg}", where=name)
    radiance = _limit_size(np.asarray(pixels[..., :3], np.float32))
    return Environment(_rotate(radiance, rotation_deg) * np.float32(strength), name)


def environment_from_color(rgb: Rgb) -> Environment:
    """The same linear radiance from everywhere."""
    colour = np.asarray(rgb, np.float32)
    if colour.shape != (3,) or not np.all(np.isfinite(colour)) or np.any(colour < 0.0):
        raise InputError(
            f"an environment colour is three finite linear values of at least 0, found {rgb}",
            where="environment colour",
            fix="Give it as R,G,B, for example 0.8,0.9,1.",
        )
    return Environment(np.broadcast_to(colour, (*CONSTANT_SIZE_PX, 3)).copy(), "constant colour")


def texel_directions(height: int, width: int) -> F64:
    """(height, width, 3) unit world directions of the texel centres; see ``Environment``."""
    phi = 2.0 * np.pi * ((np.arange(width) + 0.5) / width - 0.5)
    theta = np.pi * (np.arange(height) + 0.5) / height
    sin_theta, cos_theta = np.sin(theta)[:, None], np.cos(theta)[:, None]
    x, y, z = np.broadcast_arrays(np.sin(phi) * sin_theta, cos_theta, -np.cos(phi) * sin_theta)
    return np.stack([x, y, z], axis=-1)


def texel_solid_angles(height: int, width: int) -> F64:
    """(height, 1) exact solid angle in steradians of one texel of each row."""
    cosines = np.cos(np.pi * np.arange(height + 1) / height)
    return ((cosines[:-1] - cosines[1:]) * (2.0 * np.pi / width))[:, None]


def mean_radiance(environment: Environment) -> F64:
    """(3,) radiance averaged over the whole sphere."""
    height, width, _ = environment.radiance.shape
    weights = texel_solid_angles(height, width)[:, 0]
    return np.einsum("h,hwc->c", weights, environment.radiance.astype(np.float64)) / (4.0 * np.pi)


def _check(pixels: F32, where: str) -> None:
    if pixels.ndim != 3 or pixels.shape[2] < 3 or min(pixels.shape) < 1:
        raise InputError(
            f"an environment map has red, green and blue, found shape {pixels.shape}", where=where
        )
    height, width = pixels.shape[:2]
    if abs(width - 2 * height) > ASPECT_TOLERANCE * width:
        raise InputError(
            f"an equirectangular map is twice as wide as high, found {width} × {height}",
            where=where,
            fix="Cube maps and light probes must be converted to an equirectangular map first.",
        )
    bad = ~(np.isfinite(pixels[..., :3]) & (pixels[..., :3] >= 0.0)).all(axis=-1)
    if bad.any():
        row, column = np.unravel_index(int(np.argmax(bad)), bad.shape)
        raise InputError(
            f"radiance must be finite and not negative, found {pixels[row, column, :3].tolist()} at"
            f" column {column}, row {row} ({int(bad.sum())} such pixels)",
            where=where,
            fix="Mend the pixels in an image editor; a sun above 65504 needs a 32-bit float file.",
        )


def _limit_size(radiance: F32) -> F32:
    """Area average to at most 4096 columns: ∫ L dω over every region of whole texels stays."""
    height, width, _ = radiance.shape
    if width <= MAX_WIDTH_PX:
        return radiance
    new_height, new_width = MAX_WIDTH_PX // 2, MAX_WIDTH_PX
    rows = _box_average(radiance, _cos_edges(height), _cos_edges(new_height))
    columns = _box_average(
        rows.swapaxes(0, 1), np.linspace(0, 1, width + 1), np.linspace(0, 1, new_width + 1)
    )
    return np.ascontiguousarray(columns.swapaxes(0, 1))


def _cos_edges(height: int) -> F64:
    """Edges of the rows in 1 − cos θ, in which equal lengths are equal solid angles."""
    return 1.0 - np.cos(np.pi * np.arange(height + 1) / height)


def _box_average(values: F32, edges: F64, new_edges: F64) -> F32:
    """Averages (n, …) cells onto coarser ones along the first axis by their overlap."""
    result = np.empty((len(new_edges) - 1, *values.shape[1:]), np.float32)
    first = np.clip(np.searchsorted(edges, new_edges[:-1], side="right") - 1, 0, len(values) - 1)
    last = np.clip(np.searchsorted(edges, new_edges[1:], side="left"), 1, len(values))
    for cell, (lo, hi) in enumerate(zip(first, last, strict=True)):
        clipped = np.clip(edges[lo : hi + 1], new_edges[cell], new_edges[cell + 1])
        overlap = np.diff(clipped)
        result[cell] = np.tensordot(overlap / overlap.sum(), values[lo:hi], axes=1)
    return result


def _rotate(radiance: F32, rotation_deg: float) -> F32:
    """Rolls by whole columns and blends neighbours for the rest; row sums stay as they were."""
    width = radiance.shape[1]
    shift = -rotation_deg / 360.0 * width
    whole = math.floor(shift)
    fraction = shift - whole
    rolled = np.roll(radiance, whole, axis=1)
    if fraction == 0.0:
        return rolled
    blended = (1.0 - fraction) * rolled + fraction * np.roll(rolled, 1, axis=1)
    return blended.astype(np.float32, copy=False)
