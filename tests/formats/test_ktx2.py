"""KTX2: what we write, we and an independent parser read; damage is refused."""

from __future__ import annotations

import contextlib
import struct
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.ktx2 import Encoding, decode_ktx2, encode_ktx2
from irradia.formats.rgb9e5 import pack_rgb9e5


@pytest.fixture
def pages() -> np.ndarray:
    return np.exp(np.random.default_rng(11).normal(0, 2, (3, 13, 7, 3))).astype(np.float32)


@pytest.mark.parametrize(("encoding", "tolerance"), [("half", 2.0**-11), ("rgb9e5", 2.0**-9)])
def test_pages_come_back(pages: np.ndarray, encoding: Encoding, tolerance: float) -> None:
    texture = decode_ktx2(encode_ktx2(pages, encoding, {"irradia:scale": "4"}))
    assert texture.encoding == encoding
    error = np.abs(texture.pages - pages).max(axis=-1)
    assert np.all(error <= tolerance * pages.max(axis=-1))
    assert texture.metadata == {"KTXorientation": "rd", "KTXwriter": "irradia", "irradia:scale": "4"}


def test_values_out_of_range_are_clamped_and_stay_finite() -> None:
    for encoding in ("half", "rgb9e5"):
        texture = decode_ktx2(encode_ktx2(np.full((1, 1, 1, 3), 1e6), encoding))
        assert 65000 < texture.pages.min() <= texture.pages.max() < 65536


@pytest.mark.parametrize(
    ("encoding", "vk_format", "type_bytes", "texel_bytes", "n_samples"),
    [("half", 97, 2, 8, 4), ("rgb9e5", 123, 4, 4, 6)],
)
def test_golden_header_and_descriptor(
    encoding: Encoding, vk_format: int, type_bytes: int, texel_bytes: int, n_samples: int
) -> None:
    data = encode_ktx2(np.ones((2, 4, 5, 3)), encoding)
    assert data[:12] == b"\xabKTX 20\xbb\r\n\x1a\n"
    assert struct.unpack_from("<9I", data, 12) == (vk_format, type_bytes, 5, 4, 0, 2, 1, 1, 2)
    at, length = struct.unpack_from("<2I", data, 48)
    assert at == 104
    assert length == 4 + 24 + 16 * n_samples
    assert struct.unpack_from("<IIHH4B4B8B", data, at) == (
        *(length, 0, 2, length - 4),
        *(1, 1, 1, 0),
        *(0, 0, 0, 0),
        *(texel_bytes, 0, 0, 0, 0, 0, 0, 0),
    )
    assert struct.unpack_from("<3Q", data, 80)[2] == 2 * 4 * 5 * texel_bytes


def test_golden_shared_exponent_samples() -> None:
    data = encode_ktx2(np.ones((1, 1, 1, 3)), "rgb9e5")
    samples = [struct.unpack_from("<HBBIII", data, 104 + 28 + 16 * i) for i in range(6)]
    assert samples[::2] == [(9 * i, 8, i, 0, 0, 8448) for i in range(3)]
    assert samples[1::2] == [(27, 4, 0x20 | i, 0, 15, 31) for i in range(3)]


def test_single_page_is_no_array(pages: np.ndarray) -> None:
    assert struct.unpack_from("<I", encode_ktx2(pages[:1]), 32)[0] == 0


def test_every_truncation_is_an_input_error(pages: np.ndarray) -> None:
    data = encode_ktx2(pages)
    for keep in range(len(data)):
        with pytest.raises(InputError):
            decode_ktx2(data[:keep])


def test_flipped_bytes_never_give_another_error(pages: np.ndarray) -> None:
    data = encode_ktx2(pages)
    rng = np.random.default_rng(12)
    for _ in range(2000):
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


def test_data_that_inflates_to_more_than_the_header_says_is_refused(pages: np.ndarray) -> None:
    data = bytearray(encode_ktx2(pages))
    data[24:28] = (12).to_bytes(4, "little")
    data[96:104] = (3 * 12 * 7 * 4).to_bytes(8, "little")
    with pytest.raises(InputError, match="bytes of texels"):
        decode_ktx2(bytes(data))


@pytest.mark.parametrize("encoding", ["half", "rgb9e5"])
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
    assert (descriptor["colorModel"], descriptor["colorPrimaries"], descriptor["transferFunction"]) == (
        1,
        1,
        1,
    )
    texels = (tmp_path / "texels.bin").read_bytes()
    if encoding == "half":
        found = np.frombuffer(texels, "<f2").reshape(*pages.shape[:3], 4)[..., :3].astype(np.float32)
        np.testing.assert_array_equal(found, pages.astype(np.float16))
    else:
        np.testing.assert_array_equal(
            np.frombuffer(texels, "<u4").reshape(pages.shape[:3]), pack_rgb9e5(pages)
        )
