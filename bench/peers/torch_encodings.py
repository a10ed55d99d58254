"""Encodings in PyTorch, by the definitions of :mod:`irradia.field.encodings`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn


class HashGrid(nn.Module):
    """Multiresolution hash grid (Müller et al. 2022), all levels at once, indices in 32 bits."""

    own_backward = False  # see WeightedRows

    def __init__(
        self,
        parameters: np.ndarray,
        *,
        n_levels: int,
        log2_table_size: int,
        n_features: int,
        base_resolution: int,
        max_resolution: int,
        full_levels: bool,
        hash_all: bool,
        convention: str,
        primes: Sequence[int],
    ) -> None:
        super().__init__()
        if convention != "tiny-cuda-nn":
            raise ValueError(f"expected tiny-cuda-nn's convention, found {convention!r}")
        factors = np.array(primes, np.uint32).view(np.int32).tolist()  # products wrap, as they should
        growth = math.log2(max_resolution / base_resolution) / max(n_levels - 1, 1)
        scales, sizes, strides, hashed = [], [], [], []
        largest = 1 << log2_table_size
        for level in range(n_levels):
            scale = np.float32(2.0 ** (level * growth) * base_resolution - 1.0)
            resolution = math.ceil(scale) + 1
            trimmed = min(-(-(resolution**3) // 8) * 8, largest)
            scales.append(float(scale))
            sizes.append(largest if full_levels else trimmed)
            hashed.append(hash_all or resolution**3 > sizes[-1])
            strides.append(factors if hashed[-1] else (1, resolution, resolution**2))
        offsets = np.cumsum([0, *sizes[:-1]])
        self.n_dense = hashed.index(True) if True in hashed else n_levels
        self.register_buffer("scale", torch.tensor(scales).reshape(-1, 1))
        self.register_buffer("stride", torch.tensor(strides, dtype=torch.int32))
        self.register_buffer("size", torch.tensor(sizes, dtype=torch.int32).reshape(-1, 1))
        self.register_buffer("offset", torch.tensor(offsets, dtype=torch.int32).reshape(-1, 1))
        self.table = nn.Parameter(torch.from_numpy(parameters.copy()).reshape(-1, n_features))

    def forward(self, x: Tensor) -> Tensor:
        """Features (N, n_levels · n_features) of points (N, 3) in the unit cube."""
        place = x[:, None, :] * self.scale + 0.5  # (N, L, 3)
        cell = place.floor()
        index = self._corners(cell.int())  # (N, L, 8)
        weights = _corner_weights(place - cell)
        look_up = WeightedRows.apply if self.own_backward else weighted_rows
        return look_up(self.table, index, weights).reshape(len(x), -1)

    def flat(self, values: Tensor) -> Tensor:
        """Values in the shape of the table, in the order of the task's parameters."""
        return values.reshape(-1)

    def _corners(self, cell: Tensor) -> Tensor:
        """Rows of the table at the eight corners of each cell; the last axis changes fastest along z."""
        low = cell * self.stride
        ends = torch.stack((low, low + self.stride), dim=-1)  # (N, L, 3, 2)
        d = self.n_dense
        x, y, z = (ends[:, :, axis] for axis in range(3))
        dense = x[:, :d, :, None, None] + y[:, :d, None, :, None] + z[:, :d, None, None, :]
        mixed = x[:, d:, :, None, None] ^ y[:, d:, None, :, None] ^ z[:, d:, None, None, :]
        dense = dense.flatten(2) % self.size[:d]
        mixed = mixed.flatten(2) & (self.size[d:] - 1)
        return torch.cat((dense, mixed), dim=1) + self.offset


class TriPlane(nn.Module):
    """Three axis-aligned feature planes, bilinear, concatenated.

    Planes stand channels-last, as the native kernel likes them: 65,536 lookups with their gradients took one
    thread 41 ms, 48 ms with channels first, and 77 ms as :func:`weighted_rows`.
    """

    def __init__(
        self, parameters: np.ndarray, *, resolution: int, n_features: int, align_corners: bool = False
    ) -> None:
        super().__init__()
        self.align_corners = align_corners
        planes = torch.from_numpy(parameters.copy()).reshape(3, resolution, resolution, n_features)
        self.planes = nn.Parameter(planes.permute(0, 3, 1, 2))

    def forward(self, x: Tensor) -> Tensor:
        """Features (N, 3 · n_features) of points (N, 3) in the unit cube."""
        place = 2.0 * x - 1.0
        grid = torch.stack((place[:, [0, 1]], place[:, [0, 2]], place[:, [1, 2]]))[:, None]  # (3, 1, N, 2)
        features = nn.functional.grid_sample(
            self.planes, grid, padding_mode="border", align_corners=self.align_corners
        )
        return features[:, :, 0].permute(2, 0, 1).reshape(len(x), -1)

    def flat(self, values: Tensor) -> Tensor:
        """Values in the shape of the planes, in the order of the task's parameters."""
        return values.permute(0, 2, 3, 1).reshape(-1)


class Frequency(nn.Module):
    """Sines and cosines of 2ᵏ π x, dimension-major, then frequency, then (sin, cos)."""

    def __init__(self, _: None, *, n_frequencies: int, include_identity: bool = False) -> None:
        super().__init__()
        self.include_identity = include_identity
        self.register_buffer("angular", torch.pi * 2.0 ** torch.arange(n_frequencies, dtype=torch.float32))

    def forward(self, x: Tensor) -> Tensor:
        """Features (N, 6 · n_frequencies), the points before them where asked for."""
        angles = x[:, :, None] * self.angular
        waves = torch.stack((angles.sin(), angles.cos()), dim=-1).flatten(1)
        return torch.cat((x, waves), dim=1) if self.include_identity else waves


class Identity(nn.Module):
    """The input itself."""

    def __init__(self, _: None) -> None:
        super().__init__()

    def forward(self, x: Tensor) -> Tensor:
        """As it comes."""
        return x


def weighted_rows(table: Tensor, index: Tensor, weights: Tensor) -> Tensor:
    """Sums of rows (…, F) of a table (E, F) at ``index`` (…, K), times ``weights`` (…, K).

    Forward this takes 60 % of the time of ``embedding`` or ``index_select`` followed by a product and a sum,
    and 80 to 90 % with the gradient.
    """
    k = index.shape[-1]
    rows = nn.functional.embedding_bag(
        index.reshape(-1, k), table, per_sample_weights=weights.reshape(-1, k), mode="sum"
    )
    return rows.reshape(*index.shape[:-1], -1)


class WeightedRows(torch.autograd.Function):
    """:func:`weighted_rows` with a gradient written for it: PyTorch's sorts all indices.

    For 8.4 M rows one thread took 330 ms feature by feature, as here; 370 ms with ``bincount``, 660 ms row by
    row with ``index_add`` or ``scatter_add``, 950 ms with ``index_put``, and 2,000 ms PyTorch's way.
    """

    @staticmethod
    def forward(ctx: Any, table: Tensor, index: Tensor, weights: Tensor) -> Tensor:
        """As the function."""
        ctx.save_for_backward(index, weights)
        ctx.n_rows = len(table)
        return weighted_rows(table, index, weights)

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor, None, None]:
        """Of the table alone."""
        index, weights = ctx.saved_tensors
        flat = index.reshape(-1).long()
        columns = [
            weights.new_zeros(ctx.n_rows).scatter_add_(0, flat, (feature[..., None] * weights).reshape(-1))
            for feature in gradients[0].unbind(-1)
        ]
        return torch.stack(columns, dim=1), None, None


def _corner_weights(fraction: Tensor) -> Tensor:
    """Trilinear weights (N, L, 8) in the order of :meth:`HashGrid._corners`."""
    ends = torch.stack((1.0 - fraction, fraction), dim=-1)
    x, y, z = ends.unbind(dim=-2)
    return (x[..., :, None, None] * y[..., None, :, None] * z[..., None, None, :]).flatten(2)


ENCODINGS = {"hash": HashGrid, "triplane": TriPlane, "frequency": Frequency, "identity": Identity}
