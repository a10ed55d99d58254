"""OpenEXR in and out, and files that are not whole."""

from __future__ import annotations

import contextlib
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.exr import read_exr, read_exr_image, read_exr_metadata, write_exr, write_exr_rgb


@pytest.fixture
def pixels() -> np.ndarray:
    return np.random.default_rng(1).normal(size=(37, 23, 3)).astype(np.float32)


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
def test_colour_comes_back_in_the_precision_it_had(tmp_path: Path, pixels: np.ndarray, dtype: type) -> None:
    write_exr_rgb(tmp_path / "a.exr", pixels.astype(dtype))
    image = read_exr_image(tmp_path / "a.exr")
    assert image.channels["G"].dtype == dtype
    np.testing.assert_array_equal(read_exr(tmp_path / "a.exr"), pixels.astype(dtype).astype(np.float32))


def test_channels_of_any_name_and_type_and_attributes_come_back(tmp_path: Path, pixels: np.ndarray) -> None:
    ids = np.arange(37 * 23, dtype=np.uint32).reshape(37, 23)
    channels = {"coverage": pixels[..., 0].astype(np.float16), "id": ids, "layer.Z": pixels[..., 1]}
    write_exr(tmp_path / "a.exr", channels, {"quantity": "radiance", "scale": 0.25, "page": 3})
    image = read_exr_image(tmp_path / "a.exr")
    for name, plane in channels.items():
        assert image.channels[name].dtype == plane.dtype
        np.testing.assert_array_equal(image.channels[name], plane)
    wanted = {"quantity": "radiance", "scale": 0.25, "page": 3}
    assert {k: image.metadata[k] for k in wanted} == wanted
    assert {k: read_exr_metadata(tmp_path / "a.exr")[k] for k in wanted} == wanted


def test_layered_colour_and_luminance_are_found(tmp_path: Path, pixels: np.ndarray) -> None:
    layered = {f"view.Combined.{c}": pixels[..., i] for i, c in enumerate("RGB")}
    write_exr(tmp_path / "a.exr", layered)
    np.testing.assert_array_equal(read_exr(tmp_path / "a.exr"), pixels)
    write_exr(tmp_path / "y.exr", {"Y": pixels[..., 0]})
    np.testing.assert_array_equal(read_exr(tmp_path / "y.exr")[..., 2], pixels[..., 0])


def test_channels_without_colour_are_an_input_error(tmp_path: Path, pixels: np.ndarray) -> None:
    write_exr(tmp_path / "a.exr", {"Z": pixels[..., 0]})
    with pytest.raises(InputError, match="channels R, G and B or Y, found Z"):
        read_exr(tmp_path / "a.exr")


def test_same_pixels_are_the_same_bytes(tmp_path: Path, pixels: np.ndarray) -> None:
    for name in ("a.exr", "b.exr"):
        write_exr_rgb(tmp_path / name, pixels, {"scale": 2.0})
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()


@pytest.mark.parametrize("share", [0.0, 0.001, 0.05, 0.2, 0.5, 0.99])
def test_truncated_files_are_input_errors(
    tmp_path: Path, pixels: np.ndarray, share: float, capsys: pytest.CaptureFixture[str]
) -> None:
    write_exr_rgb(tmp_path / "a.exr", pixels)
    data = (tmp_path / "a.exr").read_bytes()
    (tmp_path / "cut.exr").write_bytes(data[: int(len(data) * share)])
    with pytest.raises(InputError, match=r"cut\.exr"):
        read_exr(tmp_path / "cut.exr")
    assert capsys.readouterr().out == ""  # stdout belongs to --json


def test_flipped_bytes_never_give_another_error(tmp_path: Path, pixels: np.ndarray) -> None:
    write_exr_rgb(tmp_path / "a.exr", pixels[:9, :7])
    data = (tmp_path / "a.exr").read_bytes()
    rng = np.random.default_rng(2)
    for _ in range(200):
        bad = bytearray(data)
        for at in rng.integers(len(bad), size=3):
            bad[at] = rng.integers(256)
        (tmp_path / "bad.exr").write_bytes(bad)
        with contextlib.suppress(InputError):
            assert read_exr(tmp_path / "bad.exr").ndim == 3


def test_absurd_size_is_refused_before_memory_is_asked_for(tmp_path: Path) -> None:
    write_exr_rgb(tmp_path / "a.exr", np.zeros((2, 2, 3), np.float32))
    data = (tmp_path / "a.exr").read_bytes()
    for window in (b"dataWindow", b"displayWindow"):
        at = data.index(window + b"\0box2i\0") + len(window) + 7 + 4 + 8
        data = data[:at] + (300_000).to_bytes(4, "little") * 2 + data[at + 8 :]
    (tmp_path / "huge.exr").write_bytes(data)
    with pytest.raises(InputError, match=r"300001|expected an OpenEXR image"):
        read_exr(tmp_path / "huge.exr")


def test_missing_file_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_exr(tmp_path / "none.exr")
