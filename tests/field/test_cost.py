"""Costs of a query, by hand."""

from __future__ import annotations

from irradia.field.cost import FORMULAS, query_cost
from irradia.field.encodings import Frequency, HashGrid, SphericalHarmonics, TriPlane
from irradia.field.registry import ENCODINGS
from irradia.field.spec import FieldSpec


def test_every_encoding_has_its_formula():
    assert set(FORMULAS) == set(ENCODINGS)


def test_a_hash_grid_reads_eight_entries_a_level():
    spec = FieldSpec(HashGrid(n_levels=8, n_features=2), SphericalHarmonics(degree=4), width=32)
    cost = query_cost(spec)
    assert cost.encoding_values == 8 * 8 * 2
    assert cost.encoding_bytes(16) == 256
    assert cost.encoding_bytes(4) == 64


def test_planes_are_read_at_twelve_texels():
    spec = FieldSpec(TriPlane(resolution=64, n_features=8), mode="sh1", head="linear")
    assert query_cost(spec).encoding_values == 12 * 8


def test_a_network_multiplies_and_adds_once_for_each_weight():
    spec = FieldSpec(Frequency(n_frequencies=2), width=8, n_hidden_layers=1, mode="sh1", head="linear")
    cost = query_cost(spec)
    assert cost.network_values == 12 * 8 + 8 + 8 * 12 + 12
    assert cost.network_flops == 2 * 12 * 8 + 8 + 2 * 8 * 12 + 12 + 8
    assert cost.encoding_values == 0
    assert cost.flops == cost.network_flops + cost.encoding_flops
