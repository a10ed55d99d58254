"""BC6H: the decoder against Pillow and a GPU driver's, the encoder against what the format can hold."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from irradia.core.errors import InputError
from irradia.formats.bc6h import blocks_from_bytes, decode_bc6h, encode_bc6h
from irradia.formats.bc6h_decode import half_bits_from_blocks
from irradia.formats.bc6h_tables import BIT_POSITIONS, INDEX_AT, INDEX_WIDTH, MODES, PARTITION_AT, WHOLE
from irradia.formats.ktx2 import encode_ktx2

N_MODES = len(MODES)
RESERVED = (0b10011, 0b10111, 0b11011, 0b11111)


def random_blocks(code: int, n_blocks: int, seed: int) -> np.ndarray:
    """(N, 16) random bytes behind the code of a mode."""
    blocks = np.random.default_rng(seed).integers(0, 256, (n_blocks, 16), np.uint8)
    code_bits = 2 if code < 2 else 5
    blocks[:, 0] = (blocks[:, 0] >> code_bits << code_bits) | code
    return blocks


def lightmap_like(height: int = 64, width: int = 64) -> np.ndarray:
    """Soft gradients, a hard shadow, two coloured lights and half a percent of noise."""
    y, x = np.mgrid[0:height, 0:width] / 32.0
    warm = np.array([1.0, 0.7, 0.4]) * (0.9 / (0.3 + (x - 0.5) ** 2 + y**2))[..., None]
    cold = np.array([0.1, 0.3, 1.0]) * (0.5 + 0.5 * np.sin(3 * x + y))[..., None] * (x + y > 1.7)[..., None]
    noise = np.random.default_rng(31).normal(1.0, 0.005, (height, width, 3))
    return ((0.02 + warm + cold) * noise).astype(np.float32)


def rmse_stops(test: np.ndarray, reference: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(np.log2((test + 1e-6) / (reference + 1e-6))))))


@pytest.mark.parametrize("mode", range(N_MODES))
def test_every_bit_of_a_block_has_one_meaning(mode: int) -> None:
    n_regions = MODES[mode].n_regions
    row = WHOLE if n_regions == 1 else 13
    indices = [at + bit for at, n in zip(INDEX_AT[row], INDEX_WIDTH[row], strict=True) for bit in range(n)]
    partition = [] if n_regions == 1 else list(range(PARTITION_AT, PARTITION_AT + 5))
    endpoints = BIT_POSITIONS[mode][BIT_POSITIONS[mode] >= 0].tolist()
    assert sorted([*range(MODES[mode].code_bits), *endpoints, *partition, *indices]) == list(range(128))


@pytest.mark.parametrize("code", [*(mode.code for mode in MODES), *RESERVED])
def test_pillow_decodes_random_blocks_to_the_same(tmp_path: Path, code: int) -> None:
    """Pillow gives 8 bits of what lies between 0 and 1."""
    blocks = random_blocks(code, 64 * 64, seed=code)
    (tmp_path / "a.dds").write_bytes(dds_header(256, 256) + blocks.tobytes())
    with Image.open(tmp_path / "a.dds") as image:
        theirs = np.asarray(image.convert("RGB"))
    ours = decode_bc6h(blocks.reshape(64, 64, 16), 256, 256)
    difference = np.abs((np.minimum(ours, 1.0) * 255.0).astype(np.uint8) - theirs.astype(np.int64))
    assert difference.max() <= 1
    assert np.mean(difference) < 3e-3  # theirs rounds on the way
    if code not in RESERVED:
        assert np.mean((theirs > 8) & (theirs < 255)) > 0.03  # so that something was compared


def dds_header(width: int, height: int) -> bytes:
    """DDS with the DX10 header of BC6H_UF16."""
    pixel_format = struct.pack("<2I4s5I", 32, 4, b"DX10", 0, 0, 0, 0, 0)
    head = struct.pack("<7I44x", 124, 0x1007, height, width, 0, 0, 0)
    return (
        b"DDS "
        + head
        + pixel_format
        + struct.pack("<5I", 0x1000, 0, 0, 0, 0)
        + struct.pack("<5I", 95, 3, 0, 1, 0)
    )


def test_webgl_decodes_random_blocks_of_all_modes_to_the_same(
    web_check, chromium: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The driver behind WebGL, in full floats."""
    codes = [*(mode.code for mode in MODES), *RESERVED]
    blocks = np.stack([random_blocks(code, 16, seed=100 + code) for code in codes])
    monkeypatch.setattr("irradia.formats.ktx2.encode_level", lambda *_: blocks.tobytes())
    height, width = 4 * len(codes), 4 * 16
    (tmp_path / "a.ktx2").write_bytes(encode_ktx2(np.zeros((1, height, width, 3)), "bc6h"))
    [found] = web_check("sample-ktx2", chromium, tmp_path / "a.ktx2")
    theirs = np.array(found["pixels"]).reshape(height, width, 4)[..., :3]
    np.testing.assert_array_equal(decode_bc6h(blocks, height, width), theirs)


def test_golden_block_of_one_colour() -> None:
    """Mode 11, code 00011: endpoints (1023, 512, 0) twice over, all indices 0."""
    value = 0b00011 | 1023 << 5 | 512 << 15 | 1023 << 35 | 512 << 45
    texels = half_bits_from_blocks(np.frombuffer(value.to_bytes(16, "little"), np.uint8)[None])
    middle = (((512 << 16) + 0x8000) >> 10) * 31 >> 6
    np.testing.assert_array_equal(texels[0], np.tile([0x7BFF, middle, 0], (16, 1)))


@pytest.mark.parametrize("value", [0.0, 2.0**-12, 0.18, 1.0, 777.0, 65504.0])
def test_one_colour_keeps_eleven_bits(value: float) -> None:
    rgb = np.tile(np.array([value, value / 2, value / 4], np.float32), (8, 8, 1))
    np.testing.assert_allclose(decode_bc6h(encode_bc6h(rgb), 8, 8), rgb, rtol=2.0**-10, atol=2.0**-24)


def test_two_flat_colours_in_any_partition_are_kept_apart() -> None:
    """A hard shadow's edge: with one region both colours would have to share a line of 16 steps."""
    from irradia.formats.bc6h_tables import REGION

    near, far = np.array([0.5, 0.25, 0.125]), np.array([0.55, 0.2, 0.16])
    rgb = np.where(REGION[:32].reshape(32, 4, 4, 1) == 0, near, far).swapaxes(0, 1).reshape(4, 128, 3)
    back = decode_bc6h(encode_bc6h(rgb), 4, 128)
    np.testing.assert_allclose(back, rgb, rtol=0.005)


def test_encoded_lightmap_is_within_one_percent() -> None:
    rgb = lightmap_like()
    back = decode_bc6h(encode_bc6h(rgb), 64, 64)
    assert rmse_stops(back, rgb) < 0.015
    assert abs(float(back.mean() / rgb.mean()) - 1.0) < 1e-3


def test_more_partitions_never_make_it_worse() -> None:
    rgb = lightmap_like()
    errors = [
        rmse_stops(decode_bc6h(encode_bc6h(rgb, n_partitions=n, dark=1e-6), 64, 64), rgb) for n in (0, 4, 32)
    ]
    assert errors[0] > errors[1] * 1.05
    assert errors[1] >= errors[2]


def test_texels_without_weight_cost_the_others_nothing() -> None:
    """The rim of a chart: black beyond it."""
    rgb = lightmap_like(16, 16)
    weights = np.ones((16, 16), np.float32)
    weights[:, 2:4] = weights[6:7] = 0.0
    rgb[weights == 0.0] = 0.0
    shown = weights > 0.0
    blind = decode_bc6h(encode_bc6h(rgb), 16, 16)
    weighed = decode_bc6h(encode_bc6h(rgb, weights), 16, 16)
    assert rmse_stops(weighed[shown], rgb[shown]) < 0.5 * rmse_stops(blind[shown], rgb[shown])


def test_black_that_counts_stays_dark_beside_light() -> None:
    rgb = lightmap_like(16, 16)
    rgb[:, ::3] = 0.0
    back = decode_bc6h(encode_bc6h(rgb), 16, 16)
    assert back[:, ::3].max() < 0.01 * rgb.max()


def test_noise_in_the_dark_takes_little_from_the_light_beside_it() -> None:
    """Purely logarithmic errors would spend a block on telling 2⁻¹⁴ from 2⁻¹¹."""
    rgb = lightmap_like(16, 16)
    dark = np.zeros((16, 16), np.bool_)
    dark[:, ::4] = dark[1::4] = True
    rgb[dark] = np.random.default_rng(32).uniform(2.0**-14, 2.0**-11, rgb[dark].shape)
    errors = []
    for threshold in (2.0**-8, 1e-9):
        back = decode_bc6h(encode_bc6h(rgb, dark=threshold), 16, 16)
        assert back[dark].max() < 2.0**-9
        errors.append(rmse_stops(back[~dark], rgb[~dark]))
    assert errors[0] < 0.1  # and 0.14 without least squares
    assert errors[0] < 0.6 * errors[1]


@pytest.mark.parametrize("size", [(1, 1), (4, 5), (7, 3), (13, 18)])
def test_sides_need_not_be_multiples_of_four(size: tuple[int, int]) -> None:
    rgb = lightmap_like(*size)
    blocks = encode_bc6h(rgb)
    assert blocks.shape == (-(-size[0] // 4), -(-size[1] // 4), 16)
    assert rmse_stops(decode_bc6h(blocks, *size), rgb) < 0.03


def test_values_out_of_range_become_the_nearest_that_fit() -> None:
    rgb = np.zeros((4, 12, 3), np.float32)
    rgb[:, :4], rgb[:, 4:8], rgb[:, 8:] = 1e9, -1.0, np.nan
    back = decode_bc6h(encode_bc6h(rgb), 4, 12)
    assert back[:, :4].min() == 65504.0
    assert back[:, 4:].max() == 0.0


def test_same_pixels_are_the_same_blocks() -> None:
    rgb = lightmap_like()
    np.testing.assert_array_equal(encode_bc6h(rgb), encode_bc6h(rgb.copy()))


def test_wrong_number_of_bytes_is_an_input_error() -> None:
    with pytest.raises(InputError, match="BC6H"):
        blocks_from_bytes(bytes(31), 4, 8)
