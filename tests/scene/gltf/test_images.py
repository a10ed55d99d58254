"""Images are decoded as they are stored, and absurd ones not at all."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image as PillowImage

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene
from irradia.scene.gltf.images import decode_image

RAMP = np.arange(16 * 16 * 4, dtype=np.uint32).reshape(16, 16, 4).astype(np.uint8)


def encode(pixels, kind: str, mode: str | None = None, **options) -> bytes:
    stream = io.BytesIO()
    picture = PillowImage.fromarray(pixels)
    (picture.convert(mode) if mode else picture).save(stream, kind, **options)
    return stream.getvalue()


def decoded(data: bytes):
    return decode_image(data, "image", "/images/0").pixels


def test_png_with_alpha_is_exact():
    np.testing.assert_array_equal(decoded(encode(RAMP, "PNG")), RAMP)


def test_png_without_alpha_is_opaque():
    pixels = decoded(encode(RAMP[..., :3], "PNG"))
    np.testing.assert_array_equal(pixels[..., :3], RAMP[..., :3])
    assert (pixels[..., 3] == 255).all()


def test_lossless_webp_is_exact():
    opaque = np.dstack([RAMP[..., :3], np.full((16, 16), 255, np.uint8)])
    np.testing.assert_array_equal(decoded(encode(opaque, "WEBP", lossless=True)), opaque)


def test_jpeg_is_close():
    smooth = np.zeros((16, 16, 3), np.uint8)
    smooth[:] = (200, 100, 50)
    pixels = decoded(encode(smooth, "JPEG", quality=95)).astype(int)
    np.testing.assert_allclose(pixels, np.broadcast_to((200, 100, 50, 255), (16, 16, 4)), atol=3)


def test_palette_and_grey_become_rgba():
    grey = RAMP[..., 0]
    np.testing.assert_array_equal(decoded(encode(grey, "PNG"))[..., 2], grey)
    assert decoded(encode(RAMP, "PNG", "P")).shape == (16, 16, 4)


def test_sixteen_bit_grey_is_scaled_not_clipped():
    grey = np.array([[0, 257, 128, 129, 32896, 65535]], np.uint16)
    expected = np.rint(grey / 257).astype(np.uint8)
    np.testing.assert_array_equal(decoded(encode(grey, "PNG"))[..., 0], expected)


def png_header(width: int, height: int) -> bytes:
    """A PNG that says how large it is, and holds next to nothing."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(b"\0"))
        + chunk(b"IEND", b"")
    )


@pytest.mark.parametrize("size", [(16384, 4), (4, 16384), (16384, 16384), (2**31 - 1, 2**31 - 1)])
def test_texture_of_16k_is_refused_before_it_is_decoded(size):
    with pytest.raises(InputError, match=r"/images/0: expected an image below 16384 .*\n.*resize"):
        decoded(png_header(*size))


def test_large_texture_below_the_limit_is_judged_by_its_data():
    with pytest.raises(InputError, match="/images/0: this image is damaged"):
        decoded(png_header(12000, 12000))


@pytest.mark.parametrize(
    "data", [b"", b"\0" * 64, b"\xabKTX 20\xbb\r\n\x1a\n" + b"\0" * 64, b"GIF89a" + b"\0" * 64]
)
def test_other_formats_are_input_errors(data):
    with pytest.raises(InputError, match="expected a PNG, JPEG or WebP"):
        decoded(data)


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_image_cut_anywhere_is_an_input_error(kind):
    noise = np.random.default_rng(1).integers(0, 256, (32, 32, 3), dtype=np.uint8)
    whole = encode(noise, kind)
    for length in range(0, len(whole) - 16, 41):
        with pytest.raises(InputError, match="/images/0"):
            decoded(whole[:length])


def webp_document(gltf, **texture):
    red = np.zeros((2, 2, 3), np.uint8)
    red[..., 0] = 255
    gltf.add("images", {"bufferView": gltf.view(encode(red * 0, "PNG"))})
    gltf.add("images", {"bufferView": gltf.view(encode(red, "WEBP", lossless=True))})
    gltf.add("textures", {**texture, "extensions": {"EXT_texture_webp": {"source": 1}}})
    gltf.use("EXT_texture_webp", required="source" not in texture)
    gltf.add("materials", {"emissiveTexture": {"index": 0}})
    texcoords = [[0, 0], [1, 0], [0, 1]]
    positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    gltf.node(mesh=gltf.mesh({"POSITION": positions, "TEXCOORD_0": texcoords}, material=0))
    return document_to_scene(gltf.document())


@pytest.mark.parametrize("texture", [{}, {"source": 0}])
def test_webp_extension_is_preferred_over_its_fallback(gltf, texture):
    scene = webp_document(gltf, **texture)
    assert scene.images[0].pixels[0, 0].tolist() == [255, 0, 0, 255]


def test_damaged_image_in_a_scene_names_it(gltf):
    gltf.add("images", {"bufferView": gltf.view(b"nonsense")})
    gltf.add("textures", {"source": 0})
    gltf.add("materials", {"emissiveTexture": {"index": 0}})
    gltf.node(mesh=gltf.mesh(material=0))
    with pytest.raises(InputError, match="/images/0"):
        document_to_scene(gltf.document())
