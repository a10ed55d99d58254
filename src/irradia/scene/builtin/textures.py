"""Procedural textures of the atrium: stone, marble, brick, plaster, tile, wood, cloth, glass.

Each returns (size, size, 3) sRGB and repeats without a seam, save for glass, which is one window.
Each has at most 256 colours, so that its PNG is small. The marbles are cached: leave them unchanged.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from irradia.core.rng import Seed
from irradia.scene.builtin.mesh import Array
from irradia.scene.builtin.noise import cloud, veins
from irradia.scene.types import U8

Colour = tuple[int, int, int]


def plaster(size_px: int = 512) -> U8:
    """Warm lime plaster, clouded, with a fine grain."""
    tone = 0.60 * cloud(size_px, "plaster", slope=1.7) + 0.40 * cloud(size_px, "plaster-grain", slope=0.7)
    return ramp(tone, [(206, 186, 158), (224, 207, 182), (236, 223, 203)])


def limestone(size_px: int = 512) -> U8:
    """Pale dressed stone with soft beds and small pits."""
    beds = cloud(size_px, "beds", slope=1.8, stretch=4.0).T
    tone = 0.5 * beds + 0.5 * cloud(size_px, "limestone", slope=1.0)
    pits = cloud(size_px, "pits", slope=0.6, lowest=12) > 0.985
    return ramp(np.where(pits, 0.35 * tone, tone), [(174, 162, 141), (206, 196, 178), (225, 217, 202)])


def ashlar(size_px: int = 512) -> U8:
    """Courses of cut blocks in running bond, four courses to the texture, each block of its own tone."""
    block, mortar = _bond(size_px, n_rows=4, n_columns=2, joint=0.010)
    tone = 0.30 * cloud(size_px, "ashlar", slope=1.3) + 0.25 * cloud(size_px, "ashlar-grain", slope=0.7)
    tone = np.where(mortar, 0.02, 0.15 + tone + 0.30 * _tones("ashlar-tones", block))
    return ramp(tone, [(128, 114, 94), (190, 174, 148), (210, 197, 173), (226, 216, 196)])


def brick(size_px: int = 512) -> U8:
    """Thin hand-made bricks, 16 courses to the texture, pale mortar."""
    unit, mortar = _bond(size_px, n_rows=16, n_columns=4, joint=0.007)
    tone = 0.35 * cloud(size_px, "brick", slope=0.9) + 0.55 * _tones("brick-tones", unit)
    bricks = ramp(tone, [(138, 88, 70), (172, 118, 96), (192, 142, 116), (206, 166, 140)], levels=128)
    lime = ramp(cloud(size_px, "mortar", slope=0.8), [(192, 178, 154), (214, 202, 180)], levels=64)
    return np.where(mortar[..., None], lime, bricks)


@cache
def white_marble(size_px: int = 512) -> U8:
    """White marble with grey veins."""
    tone = 0.92 - 0.55 * veins(size_px, "white-veins") - 0.22 * cloud(size_px, "white-cloud", slope=1.8)
    return ramp(tone, [(132, 130, 130), (196, 192, 186), (226, 221, 212), (240, 236, 228)])


@cache
def red_marble(size_px: int = 512) -> U8:
    """Deep red marble, clouded, with pale veins."""
    tone = 0.55 * cloud(size_px, "red-cloud", slope=1.4) + 0.75 * veins(size_px, "red-veins", sharpness=26)
    return ramp(tone, [(74, 26, 22), (118, 46, 36), (150, 74, 56), (214, 178, 156)])


@cache
def pink_marble(size_px: int = 512) -> U8:
    """Rose limestone, flecked and clouded."""
    tone = 0.7 * cloud(size_px, "pink-cloud", slope=1.2) + 0.45 * veins(size_px, "pink-veins", sharpness=22)
    return ramp(tone, [(176, 122, 100), (202, 152, 128), (220, 184, 162), (238, 220, 204)])


@cache
def green_marble(size_px: int = 512) -> U8:
    """Dark green marble with light veins."""
    tone = 0.55 * cloud(size_px, "green-cloud", slope=1.4) + 0.7 * veins(size_px, "green-veins", sharpness=24)
    return ramp(tone, [(22, 40, 34), (40, 68, 56), (66, 98, 82), (168, 190, 172)])


def court_floor(size_px: int = 1024) -> U8:
    """One bay of the court's paving: marble star and diamonds in a border, four quarters alike."""
    half = size_px // 2
    row, column = np.mgrid[0:size_px, 0:size_px]
    x, y = np.abs(column + 0.5 - half) / half, np.abs(row + 0.5 - half) / half
    square, diamond = np.maximum(x, y), x + y
    white = white_marble(512)
    layers: list[tuple[NDArray[np.bool_], U8]] = [
        (square > -1, _warm(white)),
        (square > 0.91, _reduced(green_marble())),
        ((diamond > 1.05) & (square < 0.83), _reduced(pink_marble())),
        (diamond < 0.88, _reduced(green_marble())),
        (diamond < 0.82, _warm(white)),
        (_star(x, y), _reduced(red_marble())),
        (np.hypot(x, y) < 0.10, _reduced(green_marble())),
    ]
    floor = np.zeros((size_px, size_px, 3), np.uint8)
    joint = np.zeros((size_px, size_px), bool)
    for inside, stone in layers:
        floor[inside] = np.tile(stone, (2, 2, 1))[inside]
        joint |= _outline(inside)
        joint &= ~(inside & ~_outline(inside))
    joint |= (row % half < 2) | (column % half < 2)
    floor[joint] = (70, 62, 54)
    return floor


def tile(size_px: int = 512) -> U8:
    """Terracotta tiles laid on the diagonal, four to the side, with small dark insets at the corners."""
    row, column = np.mgrid[0:size_px, 0:size_px] / size_px * 4
    index = np.floor(row).astype(int) * 4 + np.floor(column).astype(int)
    x, y = np.abs(column % 1 - 0.5), np.abs(row % 1 - 0.5)
    tone = 0.45 * cloud(size_px, "tile", slope=1.2) + 0.5 * _tones("tile-tones", index)
    clay = ramp(tone, [(146, 92, 68), (178, 118, 90), (200, 144, 114)], levels=160)
    clay[x + y > 0.80] = (88, 84, 78)
    grout = (np.maximum(x, y) > 0.488) & (x + y <= 0.80) | (np.abs(x + y - 0.80) < 0.014)
    clay[grout] = (182, 166, 142)
    return clay


def wood(size_px: int = 512) -> U8:
    """Dark oak boards, four to the texture, the grain along the columns' direction."""
    board = (np.arange(size_px) * 4 // size_px)[None] + np.zeros((size_px, 1), int)
    grain = cloud(size_px, "grain", slope=1.1, stretch=14.0)
    tone = 0.6 * grain + 0.35 * _tones("boards", board)
    gap = (np.arange(size_px) % (size_px // 4) < 4)[None]
    return ramp(np.where(gap, 0.0, 0.08 + tone), [(38, 24, 15), (92, 60, 36), (128, 88, 55), (156, 114, 74)])


def cloth(size_px: int = 512) -> U8:
    """A near-white damask weave that a material's colour tints: stripes of lozenges between bands."""
    row, column = np.mgrid[0:size_px, 0:size_px] / size_px
    lozenge = np.abs(column * 8 % 1 - 0.5) + np.abs(row * 8 % 1 - 0.5)
    figure = (lozenge < 0.40) ^ (lozenge < 0.26) ^ (lozenge < 0.12)
    thread = 0.5 + 0.5 * np.sin(2 * np.pi * 128 * row) * np.sin(2 * np.pi * 128 * column)
    tone = 0.62 + 0.20 * figure + 0.10 * thread + 0.08 * cloud(size_px, "cloth", slope=1.2)
    return ramp(tone, [(0, 0, 0), (255, 255, 255)])


def stained_glass(size_px: int = 512) -> U8:
    """One window: a lattice of jewel-coloured quarries in lead, a border, and a roundel."""
    row, column = np.mgrid[0:size_px, 0:size_px] / size_px
    u, v = (column + row) * 6, (column - row) * 6 + 12
    index = (np.floor(u) * 31 + np.floor(v) * 17).astype(int)
    palette = np.array(
        [(228, 60, 40), (245, 168, 40), (50, 96, 220), (40, 160, 110), (240, 220, 150), (150, 50, 170)]
    )
    colour = palette[(_tones("glass", index % 997) * len(palette)).astype(int)]
    border = np.minimum(np.minimum(column, 1 - column), np.minimum(row, 1 - row))
    colour[border < 0.085] = np.where(np.floor((row + column) * 12)[..., None] % 2, palette[0], palette[2])[
        border < 0.085
    ]
    lead = (np.abs(u % 1 - 0.5) > 0.465) | (np.abs(v % 1 - 0.5) > 0.465)
    lead |= (np.abs(border - 0.085) < 0.008) | (border < 0.012)
    colour[lead] = (16, 16, 18)
    return colour.astype(np.uint8)


def ramp(tone: Array, colours: list[Colour], levels: int = 256) -> U8:
    """Maps [0, 1] through evenly spaced sRGB colours in ``levels`` steps."""
    step = np.round(np.clip(tone, 0, 1) * (levels - 1)).astype(int)
    stops = np.linspace(0, levels - 1, len(colours))
    table = np.stack([np.interp(np.arange(levels), stops, [c[k] for c in colours]) for k in range(3)], axis=1)
    return np.round(table).astype(np.uint8)[step]


def _bond(
    size_px: int, n_rows: int, n_columns: int, joint: float
) -> tuple[NDArray[np.int_], NDArray[np.bool_]]:
    """Running bond: the number of the unit at each texel, and whether the texel is mortar."""
    row, column = np.mgrid[0:size_px, 0:size_px] / size_px
    course = np.floor(row * n_rows).astype(int)
    shifted = column * n_columns + 0.5 * (course % 2)
    unit = course * n_columns + np.floor(shifted).astype(int) % n_columns
    to_bed = np.abs((row * n_rows) % 1 - 0.5)
    to_head = np.abs(shifted % 1 - 0.5)
    mortar = (to_bed > 0.5 - joint * n_rows / 2) | (to_head > 0.5 - joint * n_columns / 2)
    return unit, mortar


def _tones(name: str, index: NDArray[np.int_]) -> Array:
    """A random number in [0, 1) for each index."""
    return Seed(1).child(name).numpy().random(1 + int(index.max()))[index]


def _star(x: Array, y: Array) -> NDArray[np.bool_]:
    """An eight-pointed star around the origin of folded coordinates: a square over a diamond."""
    return (np.maximum(x, y) < 0.29) | (x + y < 0.41)


def _outline(inside: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Texels of a region that touch its edge."""
    grown = np.ones_like(inside)
    for axis in (0, 1):
        for step in (1, -1):
            grown &= np.roll(inside, step, axis)
    return inside & ~grown


def _warm(stone: U8) -> U8:
    return _reduced(np.round(stone * np.array([0.97, 0.92, 0.83])).astype(np.uint8))


def _reduced(stone: U8) -> U8:
    """Every fourth level of each channel, so that several stones share one palette."""
    return (stone // 5 * 5 + 2).astype(np.uint8)
