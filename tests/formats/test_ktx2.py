"""KTX2: what we write, we and an independent parser read; damage is refused."""

from __future__ import annotations

import contextlib
import struct
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.bc6h import decode_bc6h, encode_bc6h
from irradia.formats.ktx2 import decode_ktx2, encode_ktx2
from irradia.formats.ktx2_texels import Encoding, half_size, level_bytes
from irradia.formats.rgb9e5 import pack_rgb9e5


@pytest.fixture
def pages() -> np.ndarray:
    return np.exp(np.random.default_rng(11).normal(0, 2, (3, 13, 7, 3))).astype(np.float32)


@pytest.mark.parametrize("supercompress", [True, False])
@pytest.mark.parametrize(("encoding", "tolerance"), [("half", 2.0**-11), ("rgb9e5", 2.0**-9)])
def test_pages_come_back(
    pages: np.ndarray, encoding: Encoding, tolerance: float, supercompress: bool
) -> None:
    data = encode_ktx2(pages, encoding, {"irradia:scale": "4"}, supercompress=supercompress)
    texture = decode_ktx2(data)
    assert texture.encoding == encoding
    error = np.abs(texture.pages - pages).max(axis=-1)
    assert np.all(error <= tolerance * pages.max(axis=-1))
    assert texture.metadata == {"KTXorientation": "rd", "KTXwriter": "irradia", "irradia:scale": "4"}


def test_values_out_of_range_are_clamped_and_stay_finite() -> None:
    for encoding in ("half", "rgb9e5"):
        texture = decode_ktx2(encode_ktx2(np.full((1, 1, 1, 3), 1e6), encoding))
        assert 65000 < texture.pages.min() <= texture.pages.max() < 65536


def test_bc6h_pages_come_back_as_blocks(pages: np.ndarray) -> None:
    texture = decode_ktx2(encode_ktx2(pages, "bc6h"))
    for page, found in zip(pages, texture.pages, strict=True):
        np.testing.assert_array_equal(found, decode_bc6h(encode_bc6h(page), 13, 7))


@pytest.mark.parametrize(
    ("encoding", "vk_format", "type_bytes", "block", "n_samples"),
    [
        ("half", 97, 2, (1, 0, 8), 4),
        ("rgb9e5", 123, 4, (1, 0, 4), 6),
        ("bc6h", 143, 1, (133, 3, 16), 1),
    ],
)
def test_golden_header_and_descriptor(
    encoding: Encoding, vk_format: int, type_bytes: int, block: tuple[int, int, int], n_samples: int
) -> None:
    model, block_side_less_1, block_bytes = block
    data = encode_ktx2(np.ones((2, 4, 5, 3)), encoding)
    assert data[:12] == b"\xabKTX 20\xbb\r\n\x1a\n"
    assert struct.unpack_from("<9I", data, 12) == (vk_format, type_bytes, 5, 4, 0, 2, 1, 1, 2)
    at, length = struct.unpack_from("<2I", data, 48)
    assert at == 104
    assert length == 4 + 24 + 16 * n_samples
    assert struct.unpack_from("<IIHH4B4B8B", data, at) == (
        *(length, 0, 2, length - 4),
        *(model, 1, 1, 0),
        *(block_side_less_1, block_side_less_1, 0, 0),
        *(block_bytes, 0, 0, 0, 0, 0, 0, 0),
    )
    n_blocks = 2 * 2 if encoding == "bc6h" else 2 * 4 * 5
    assert struct.unpack_from("<3Q", data, 80)[2] == n_blocks * block_bytes


def test_golden_bc6h_sample() -> None:
    """One sample of 128 bits, unsigned float, from 0 to 1."""
    data = encode_ktx2(np.ones((1, 4, 4, 3)), "bc6h")
    assert struct.unpack_from("<HBBIII", data, 104 + 28) == (0, 127, 0x80, 0, 0, 0x3F800000)


def test_golden_shared_exponent_samples() -> None:
    data = encode_ktx2(np.ones((1, 1, 1, 3)), "rgb9e5")
    samples = [struct.unpack_from("<HBBIII", data, 104 + 28 + 16 * i) for i in range(6)]
    assert samples[::2] == [(9 * i, 8, i, 0, 0, 8448) for i in range(3)]
    assert samples[1::2] == [(27, 4, 0x20 | i, 0, 15, 31) for i in range(3)]


def test_single_page_is_no_array(pages: np.ndarray) -> None:
    assert struct.unpack_from("<I", encode_ktx2(pages[:1]), 32)[0] == 0


@pytest.mark.parametrize("supercompress", [True, False])
@pytest.mark.parametrize("encoding", ["half", "rgb9e5", "bc6h"])
def test_levels_lie_aligned_smallest_first(
    pages: np.ndarray, encoding: Encoding, supercompress: bool
) -> None:
    data = encode_ktx2(pages, encoding, n_levels=99, supercompress=supercompress)
    n_levels = struct.unpack_from("<I", data, 40)[0]
    assert n_levels == 4  # 13 × 7, 6 × 3, 3 × 1, 1 × 1
    entries = [struct.unpack_from("<3Q", data, 80 + 24 * level) for level in range(n_levels)]
    alignment = 1 if supercompress else {"half": 8, "rgb9e5": 4, "bc6h": 16}[encoding]
    assert [offset % alignment for offset, _, _ in entries] == [0] * n_levels
    assert [size for _, _, size in entries] == [
        level_bytes(encoding, 3, h, w) for h, w in ((13, 7), (6, 3), (3, 1), (1, 1))
    ]
    end = len(data)
    for offset, length, _ in entries:
        assert end - 16 < offset + length <= end
        end = offset


def test_smaller_levels_are_means_of_what_is_covered(pages: np.ndarray) -> None:
    coverage = (np.random.default_rng(15).random(pages.shape[:3]) > 0.4).astype(np.float32)
    data = encode_ktx2(pages, "half", coverage=coverage, n_levels=4)
    texture = decode_ktx2(data)
    assert [level.shape[1:3] for level in texture.smaller] == [(6, 3), (3, 1), (1, 1)]
    mean = (pages * coverage[..., None]).sum(axis=(1, 2)) / coverage.sum(axis=(1, 2))[..., None]
    np.testing.assert_allclose(texture.smaller[-1][:, 0, 0], mean, rtol=3e-3)


def test_halving_keeps_the_mean_of_odd_and_even_sides() -> None:
    rng = np.random.default_rng(16)
    for height, width in ((1, 2), (2, 5), (8, 8), (7, 9), (1, 1)):
        pages = rng.random((2, height, width, 3)).astype(np.float32)
        small, weights = half_size(pages, np.full((2, height, width), 0.5))
        assert small.shape == (2, max(height // 2, 1), max(width // 2, 1), 3)
        np.testing.assert_allclose(small.mean(axis=(1, 2)), pages.mean(axis=(1, 2)), rtol=1e-5)
        np.testing.assert_allclose(weights, 0.5, rtol=1e-6)


def test_texels_that_nothing_covers_take_the_plain_mean() -> None:
    pages = np.random.default_rng(17).random((1, 4, 4, 3)).astype(np.float32)
    coverage = np.zeros((1, 4, 4))
    coverage[0, 0, 0] = 1.0
    small, _ = half_size(pages, coverage)
    np.testing.assert_allclose(small[0, 0, 0], pages[0, 0, 0], rtol=1e-6)
    np.testing.assert_allclose(small[0, 1, 1], pages[0, 2:, 2:].mean(axis=(0, 1)), rtol=1e-6)


@pytest.mark.parametrize("encoding", ["rgb9e5", "bc6h"])
def test_every_truncation_is_an_input_error(pages: np.ndarray, encoding: Encoding) -> None:
    data = encode_ktx2(pages, encoding)
    for keep in range(len(data)):
        with pytest.raises(InputError):
            decode_ktx2(data[:keep])


@pytest.mark.parametrize(
    ("encoding", "supercompress"), [("rgb9e5", True), ("half", False), ("bc6h", True), ("bc6h", False)]
)
def test_flipped_bytes_never_give_another_error(
    pages: np.ndarray, encoding: Encoding, supercompress: bool
) -> None:
    data = encode_ktx2(pages, encoding, n_levels=2, supercompress=supercompress)
    rng = np.random.default_rng(12)
    for _ in range(400):
        bad = bytearray(data)
        for at in rng.integers(len(bad), size=2):
            bad[at] = rng.integers(256)
        with contextlib.suppress(InputError):
            assert decode_ktx2(bytes(bad)).pages.ndim == 4


@pytest.mark.parametrize(
    ("at", "value"),
    [
        (12, 37),  # another format
        (20, 1 << 30),  # absurd width
        (24, 0),  # no height
        (28, 2),  # a volume
        (32, 1 << 20),  # absurd number of layers
        (36, 6),  # a cube
        (40, 3),  # mip levels
        (44, 1),  # Basis
        (96, 1 << 31),  # inflates to more than the header says
    ],
)
def test_other_textures_are_refused(pages: np.ndarray, at: int, value: int) -> None:
    data = bytearray(encode_ktx2(pages))
    data[at : at + 4] = value.to_bytes(4, "little")
    with pytest.raises(InputError):
        decode_ktx2(bytes(data))


def test_promise_of_gigabytes_takes_no_memory() -> None:
    """A header of 16,384² texels before a few bytes."""
    import tracemalloc

    data = bytearray(encode_ktx2(np.ones((1, 4, 4, 3)), "half"))
    data[20:28] = (16384).to_bytes(4, "little") * 2
    data[96:104] = (16384 * 16384 * 8).to_bytes(8, "little")
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match="bytes of texels"):
            decode_ktx2(bytes(data))
        assert tracemalloc.get_traced_memory()[1] < 1 << 25
    finally:
        tracemalloc.stop()


def test_golden_key_values() -> None:
    """Sorted by code points, each ended by NUL and padded to 4 bytes; nothing of the machine."""
    data = encode_ktx2(np.ones((1, 4, 4, 3)), metadata={"a": "ρ"}, supercompress=False)
    at, length = struct.unpack_from("<2I", data, 56)
    assert data[at : at + length] == (
        b"\x12\0\0\0KTXorientation\0rd\0\0\0\x12\0\0\0KTXwriter\0irradia\0\0\0\x05\0\0\0a\0\xcf\x81\0\0\0\0"
    )


def test_data_that_inflates_to_more_than_the_header_says_is_refused(pages: np.ndarray) -> None:
    data = bytearray(encode_ktx2(pages))
    data[24:28] = (12).to_bytes(4, "little")
    data[96:104] = (3 * 12 * 7 * 4).to_bytes(8, "little")
    with pytest.raises(InputError, match="bytes of texels"):
        decode_ktx2(bytes(data))


@pytest.mark.parametrize("encoding", ["half", "rgb9e5", "bc6h"])
def test_ktx_parse_and_zstddec_read_the_same(
    web_check, tmp_path: Path, pages: np.ndarray, encoding: Encoding
) -> None:
    """Two libraries that aren't ours, in node."""
    (tmp_path / "a.ktx2").write_bytes(encode_ktx2(pages, encoding, {"irradia:scale": "4"}))
    fields = web_check("read-ktx2", tmp_path / "a.ktx2", tmp_path / "texels.bin")
    height, width = pages.shape[1:3]
    assert (fields["pixelWidth"], fields["pixelHeight"], fields["layerCount"]) == (width, height, 3)
    assert (fields["faceCount"], fields["nLevels"], fields["supercompressionScheme"]) == (1, 1, 2)
    assert fields["keyValue"]["KTXorientation"] == "rd"
    assert fields["keyValue"]["irradia:scale"] == "4"
    descriptor = fields["dataFormatDescriptor"][0]
    model = 133 if encoding == "bc6h" else 1
    assert (descriptor["colorModel"], descriptor["colorPrimaries"]) == (model, 1)
    assert descriptor["transferFunction"] == 1
    texels = (tmp_path / "texels.bin").read_bytes()
    if encoding == "bc6h":
        assert texels == b"".join(encode_bc6h(page).tobytes() for page in pages)
    elif encoding == "half":
        found = np.frombuffer(texels, "<f2").reshape(*pages.shape[:3], 4)[..., :3].astype(np.float32)
        np.testing.assert_array_equal(found, pages.astype(np.float16))
    else:
        np.testing.assert_array_equal(
            np.frombuffer(texels, "<u4").reshape(pages.shape[:3]), pack_rgb9e5(pages)
        )


def test_three_js_and_webgl_see_the_same(web_check, chromium: str, tmp_path: Path, pages: np.ndarray) -> None:
    """three.js' own loader for what it knows; for BC6H ktx-parse, then the driver's decoder."""
    stored = {}
    for encoding, height, width in (("half", 13, 7), ("rgb9e5", 13, 7), ("bc6h", 12, 4)):
        for supercompress in (True, False):
            file = tmp_path / f"{encoding}-{supercompress}.ktx2"
            page = pages[:1, :height, :width]
            stored[file] = encode_ktx2(page, encoding, n_levels=2, supercompress=supercompress)
            file.write_bytes(stored[file])
    for (file, data), found in zip(stored.items(), web_check("sample-ktx2", chromium, *stored), strict=True):
        assert found["parser"] == ("ktx-parse" if file.name.startswith("bc6h") else "KTX2Loader")
        theirs = np.array(found["pixels"]).reshape(found["height"], found["width"], 4)[..., :3]
        np.testing.assert_array_equal(theirs, decode_ktx2(data).pages[0])
