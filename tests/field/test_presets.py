"""Presets keep what their names promise."""

from __future__ import annotations

import re

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.field.field import Field
from irradia.field.files import save_field
from irradia.field.init import new_parameters
from irradia.field.presets import PRESETS, preset
from irradia.field.quantise import round_tables
from irradia.field.spec import FieldFrame

UNITS = {"kB": 1_000, "MB": 1_000_000}


def _promised_bytes(name: str) -> int:
    number, unit = re.fullmatch(r"[a-z]+-(\d+)(kB|MB)", name).groups()
    return int(number) * UNITS[unit]


@pytest.mark.parametrize("name", PRESETS)
def test_a_file_has_about_the_size_that_its_name_says(name, tmp_path):
    """With tables as they are after training: about normal, which packs less than its bits."""
    found = PRESETS[name]
    parameters = new_parameters(found.spec, Seed(1))
    if "position" in parameters:
        rng = np.random.default_rng(2)
        parameters["position"] = rng.normal(0.0, 0.1, parameters["position"].shape).astype(np.float32)
    field = Field(found.spec, FieldFrame(np.float32([[0, 0, 0], [1, 1, 1]])), parameters)
    saved = field if found.bits is None else round_tables(field, found.bits)
    n_bytes = save_field(tmp_path / "field.safetensors.zst", saved)
    assert 0.8 * _promised_bytes(name) < n_bytes < 1.05 * _promised_bytes(name)


def test_a_name_misspelt_is_refused_with_the_nearest():
    with pytest.raises(InputError, match="no preset") as error:
        preset("hash-20kB")
    assert "hash-200kB" in (error.value.fix or "")


def test_a_preset_trains_for_as_long_as_it_is_told():
    options = preset("hash-50kB").training(12.0, seed=3)
    assert (options.steps, options.time_s, options.seed) == (None, 12.0, 3)
