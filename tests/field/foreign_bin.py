"""A second reader of the Unity project's ``.bin``, as a loader in an engine would be written: it follows a
file's conventions step by step and rearranges nothing.
"""

from __future__ import annotations

import itertools
import math
import struct

import numpy as np

from irradia.core.sh import COSINE_LOBE, irradiance_weights, sh_basis
from irradia.field.bin_conventions import BinConventions
from irradia.formats.field_bin import decode_field_bin


def read_as(data: bytes, how: BinConventions, positions: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """E (N, 3)."""
    kind, a, b, c, low, high, h, layers, *box = struct.unpack_from("<4I2f2I6f", data)
    box = np.array(box, np.float32).reshape(2, 3)
    x = (positions - box[0]) / (box[1] - box[0])
    halves = np.frombuffer(data, "<f2", offset=56).astype(np.float64)
    if kind == 0:
        n_table, features = a * b * c, grid_features(x, halves, a, b, c, low, high, how)
    elif kind == 1:
        n_table, features = 3 * a * a * c, plane_features(x, halves, a, c, how)
    else:
        n_table, features = 0, wave_features(x, a, c, how)
    content = decode_field_bin(data)  # for the sizes alone
    matrices = split(halves[n_table:], content.n_inputs, h, layers, content.n_outputs, how)
    is_sh = content.n_outputs > 4
    normal = normals if how.normal == "signed" else (normals + 1) / 2
    values = features
    if not is_sh:
        if how.inputs == "normal4_features":
            normal = np.pad(normal, ((0, 0), (0, 1)))
        values = np.hstack([features, normal] if how.inputs == "features_normal" else [normal, features])
    values = np.pad(values, ((0, 0), (0, content.n_inputs - values.shape[1])))
    for i, (weight, bias) in enumerate(matrices):
        values = values @ weight.T + bias
        if i < layers:
            values = np.maximum(values, 0)
    if not is_sh:
        return np.exp(values[:, :3])
    return from_coefficients(values[:, :12], normals, how)


def from_coefficients(values: np.ndarray, normals: np.ndarray, how: BinConventions) -> np.ndarray:
    if how.coefficients == "channel_xyz":
        l0, x, y, z = np.moveaxis(values.reshape(-1, 3, 4), 2, 0)
    else:
        l0, y, z, x = np.moveaxis(values.reshape(-1, 4, 3), 1, 0)
    series = np.stack([l0, y, z, x], axis=1)
    weights = irradiance_weights(normals)[:, :4]
    if how.sh_quantity == "irradiance":
        weights = sh_basis(normals)[:, :4]
    assert COSINE_LOBE[0] == math.pi
    return np.maximum(np.einsum("ni,nic->nc", weights, series), 0)


def split(halves: np.ndarray, n_in: int, h: int, layers: int, n_out: int, how: BinConventions) -> list:
    widths = [n_in] + [h] * layers + [n_out]
    weights, biases, at = [], [], 0

    def take(n: int) -> np.ndarray:
        nonlocal at
        at += n
        return halves[at - n : at]

    def matrix(into: int, out: int) -> np.ndarray:
        return (
            take(into * out).reshape(out, into)
            if how.matrix == "out_in"
            else take(into * out).reshape(into, out).T
        )

    for into, out in itertools.pairwise(widths):
        if how.bias == "before":
            biases.append(take(out))
        weights.append(matrix(into, out))
        if how.bias == "after":
            biases.append(take(out))
    if how.bias == "last":
        biases = [take(out) for out in widths[1:]]
    assert at == len(halves)
    return list(zip(weights, biases, strict=True))


def wave_features(x: np.ndarray, n: int, identity: int, how: BinConventions) -> np.ndarray:
    turn = {"pi": math.pi, "one": 1.0, "two_pi": 2 * math.pi}[how.turns]
    sizes = {"axis": range(3), "frequency": range(n), "wave": range(2)}
    names = how.waves.split()
    columns = []
    for places in itertools.product(*(sizes[name] for name in names)):
        at = dict(zip(names, places, strict=True))
        angle = turn * 2.0 ** at["frequency"] * x[:, at["axis"]].astype(np.float64)
        columns.append(np.cos(angle) if at["wave"] else np.sin(angle))
    waves = np.stack(columns, axis=1)
    if not identity:
        return waves
    return np.hstack([waves, x] if how.identity_last else [x, waves])


def plane_features(x: np.ndarray, halves: np.ndarray, n: int, c: int, how: BinConventions) -> np.ndarray:
    columns = []
    for plane, axes in enumerate(how.planes.split()):
        own = halves[plane * n * n * c : (plane + 1) * n * n * c]
        if how.texels == "feature_row_column":
            texels = np.moveaxis(own.reshape(c, n, n), 0, 2)
        else:
            texels = own.reshape(n, n, c)
        u, v = (x[:, "xyz".index(axis)].astype(np.float64) for axis in axes)
        columns.append(bilinear(texels, u, v, how))
    return np.hstack(columns)


def bilinear(texels: np.ndarray, u: np.ndarray, v: np.ndarray, how: BinConventions) -> np.ndarray:
    n = len(texels)
    scale, offset = (n, -0.5) if how.centres == "half" else (n - 1, 0.0)
    s, t = (np.clip(scale * w + offset, 0, n - 1) for w in (u, v))
    i, j = (np.minimum(np.floor(w), n - 2).astype(int) for w in (s, t))
    fs, ft = (s - i)[:, None], (t - j)[:, None]
    top = texels[j, i] * (1 - fs) + texels[j, i + 1] * fs
    below = texels[j + 1, i] * (1 - fs) + texels[j + 1, i + 1] * fs
    return top * (1 - ft) + below * ft


def grid_features(
    x: np.ndarray,
    halves: np.ndarray,
    levels: int,
    n: int,
    c: int,
    low: float,
    high: float,
    how: BinConventions,
) -> np.ndarray:
    columns = []
    growth = (high / low) ** (1 / max(levels - 1, 1))
    for level in range(levels):
        own = halves[level * n * c : (level + 1) * n * c]
        table = own.reshape(c, n).T if how.table == "feature_entry" else own.reshape(n, c)
        if how.levels == "floor":
            scale = math.floor(growth**level * low + 1e-6)
            side, place = scale + 1, x.astype(np.float64) * scale
        else:
            scale = growth**level * low - 1
            side, place = math.ceil(scale - 1e-6) + 1, x.astype(np.float64) * scale + 0.5
        cell = np.floor(place).astype(int)
        share = place - cell
        total = np.zeros((len(x), c))
        for corner in itertools.product((0, 1), repeat=3):
            weight = np.prod([share[:, d] if corner[d] else 1 - share[:, d] for d in range(3)], axis=0)
            total += weight[:, None] * table[index(cell + corner, side, n, how)]
        columns.append(total)
    return np.hstack(columns)


def index(corner: np.ndarray, side: int, n: int, how: BinConventions) -> np.ndarray:
    if side**3 <= n and not how.hash_all:
        return (corner[:, 0] + side * (corner[:, 1] + side * corner[:, 2])) % n
    primes = (1, 2654435761, 805459861)
    px, py, pz = primes if how.primes == "xyz" else primes[::-1]
    products = [corner[:, d] * p % 2**32 for d, p in enumerate((px, py, pz))]
    return (products[0] ^ products[1] ^ products[2]) % n
