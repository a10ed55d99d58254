"""The images that @irradia/three unpacks are those that were packed."""

from __future__ import annotations

import base64
import io
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

WIDTH, HEIGHT = 23, 17
FILTERS = range(5)
KINDS = {4: 6, 1: 0}  # PNG's colour types of RGBA and grey


@pytest.fixture(scope="module")
def texels() -> NDArray[np.uint8]:
    """(H, W, 4), with much that predictors get right and much that they don't."""
    noise = np.random.default_rng(3).integers(0, 256, (HEIGHT, WIDTH, 4))
    smooth = np.indices((HEIGHT, WIDTH)).sum(axis=0)[..., None] * 5
    return np.where(np.arange(WIDTH)[None, :, None] < 10, noise, smooth).astype(np.uint8)


def png(texels: NDArray[np.uint8], filters: list[int]) -> bytes:
    """An image whose row y went through ``filters[y]``."""
    rows = texels.reshape(len(texels), -1).astype(np.int64)
    up = np.vstack([np.zeros_like(rows[:1]), rows[:-1]])
    channels = texels.shape[2]
    left, up_left = (np.pad(each, ((0, 0), (channels, 0)))[:, :-channels] for each in (rows, up))
    predictions = [np.zeros_like(rows), left, up, (left + up) // 2, paeth(left, up, up_left)]
    coded = b"".join(
        bytes([f]) + ((rows[y] - predictions[f % 5][y]) % 256).astype(np.uint8).tobytes()
        for y, f in enumerate(filters)
    )
    header = struct.pack(">IIBBBBB", texels.shape[1], texels.shape[0], 8, KINDS[channels], 0, 0, 0)
    packed = zlib.compress(coded)
    parts = (b"IHDR", header), (b"IDAT", packed[:40]), (b"IDAT", packed[40:]), (b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunk(*part) for part in parts)


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def paeth(left: NDArray, up: NDArray, up_left: NDArray) -> NDArray:
    distances = np.abs(np.stack([up - up_left, left - up_left, left + up - 2 * up_left]))
    return np.choose(distances.argmin(axis=0), [left, up, up_left])


def read(web_check, folder: Path, *images: bytes, channels: int = 4) -> list[dict[str, str]]:
    paths = [folder / f"{i}.png" for i in range(len(images))]
    for path, image in zip(paths, images, strict=True):
        path.write_bytes(image)
    return web_check("read-png", str(WIDTH), str(HEIGHT), str(channels), *paths)


@pytest.mark.parametrize("channels", KINDS)
def test_rows_come_back_through_every_filter(web_check, tmp_path, texels, channels: int) -> None:
    texels = texels[..., :channels]
    kinds = [[f] * HEIGHT for f in FILTERS] + [[y % 5 for y in range(HEIGHT)]]
    saved = io.BytesIO()
    Image.fromarray(texels.squeeze()).save(saved, "PNG", optimize=True)
    images = [png(texels, kind) for kind in kinds] + [saved.getvalue()]
    for found in read(web_check, tmp_path, *images, channels=channels):
        np.testing.assert_array_equal(
            np.frombuffer(base64.b64decode(found["texels"]), np.uint8), texels.ravel()
        )


def test_what_is_wrong_is_refused(web_check, tmp_path, texels) -> None:
    whole = png(texels, [0] * HEIGHT)
    wrong = {
        "expected a PNG image": whole[1:],
        "cut short": whole[: len(whole) - 40],
        "expected 23 × 17 pixels, found 23 × 16": png(texels[:16], [0] * 16),
        "expected RGBA of 8 bits": whole.replace(b"\x08\x06\x00", b"\x08\x02\x00", 1),
        "expected a filter from 0 to 4, found 5": png(texels, [5] * HEIGHT),
        "bytes unpacked, found 0": whole.replace(b"IDAT", b"iDAT"),
    }
    (grey,) = read(web_check, tmp_path, whole, channels=1)
    assert "expected grey of 8 bits" in grey["refusal"]
    wrong["holds more than its size says"] = png(
        np.concatenate([texels, texels]), [0] * (2 * HEIGHT)
    ).replace(struct.pack(">II", WIDTH, 2 * HEIGHT), struct.pack(">II", WIDTH, HEIGHT))
    for finding, found in zip(wrong, read(web_check, tmp_path, *wrong.values()), strict=True):
        assert finding in found.get("refusal", "")
