"""Environment maps: directions, rotation, and energy that no resampling may change."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PilImage

from irradia.core.errors import InputError
from irradia.formats.exr import write_exr_rgb
from irradia.formats.hdr import write_hdr
from irradia.scene import environment as subject
from irradia.scene.environment import (
    environment_from_color,
    environment_from_pixels,
    load_environment,
    mean_radiance,
    texel_directions,
    texel_solid_angles,
)

WIDTH, HEIGHT = 64, 32


def _map_with_bright_texel(row: int, column: int) -> np.ndarray:
    pixels = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    pixels[row, column] = 100.0
    return pixels


def _mean_direction(radiance: np.ndarray) -> np.ndarray:
    height, width, _ = radiance.shape
    power = radiance.sum(axis=-1) * texel_solid_angles(height, width)
    total = np.einsum("hw,hwk->k", power, texel_directions(height, width))
    return total / np.linalg.norm(total)


@pytest.mark.parametrize(
    ("column", "direction"),
    [(WIDTH // 2, (0, 0, -1)), (3 * WIDTH // 4, (1, 0, 0)), (0, (0, 0, 1)), (WIDTH // 4, (-1, 0, 0))],
)
def test_column_looks_where_the_convention_says(column: int, direction: tuple[int, int, int]) -> None:
    horizon = _map_with_bright_texel(HEIGHT // 2, column)
    assert _mean_direction(horizon) @ direction > np.cos(np.radians(360.0 / WIDTH))


def test_top_row_looks_up() -> None:
    assert _mean_direction(_map_with_bright_texel(0, 5))[1] > 0.99


def test_solid_angles_fill_the_sphere() -> None:
    assert texel_solid_angles(HEIGHT, WIDTH).sum() * WIDTH == pytest.approx(4.0 * np.pi, rel=1e-12)


@pytest.mark.parametrize("rotation_deg", [0.0, 90.0, -37.3, 1.7, 400.0])
def test_rotation_is_right_handed_about_up(rotation_deg: float) -> None:
    pixels = _map_with_bright_texel(HEIGHT // 2, 40)
    before = _mean_direction(pixels)
    after = _mean_direction(environment_from_pixels(pixels, rotation_deg=rotation_deg).radiance)
    angle = np.radians(rotation_deg)
    cos, sin = np.cos(angle), np.sin(angle)
    expected = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]) @ before
    # A linear blend of two columns bends the mean direction by less than a hundredth of a column.
    np.testing.assert_allclose(after, expected, atol=2e-3)


def test_rotation_keeps_the_energy_of_every_row() -> None:
    pixels = np.random.default_rng(1).random((HEIGHT, WIDTH, 3)).astype(np.float32)
    turned = environment_from_pixels(pixels, rotation_deg=12.34).radiance
    np.testing.assert_allclose(turned.sum(axis=1), pixels.sum(axis=1), rtol=1e-5)


def test_strength_scales_radiance() -> None:
    pixels = np.ones((HEIGHT, WIDTH, 3), np.float32)
    assert mean_radiance(environment_from_pixels(pixels, strength=2.5)) == pytest.approx([2.5] * 3)


@pytest.mark.parametrize("width", [128, 100, 66])
def test_downsampling_keeps_the_energy_of_a_sun(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    pixels = np.full((width // 2, width, 3), 0.1, np.float32)
    pixels[width // 8, width // 3] = 50_000.0
    full = environment_from_pixels(pixels)
    monkeypatch.setattr(subject, "MAX_WIDTH_PX", 64)
    small = environment_from_pixels(pixels)
    assert small.radiance.shape == (32, 64, 3)
    np.testing.assert_allclose(mean_radiance(small), mean_radiance(full), rtol=1e-5)
    angle = _mean_direction(small.radiance) @ _mean_direction(full.radiance)
    assert angle > np.cos(np.radians(360.0 / 64))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1.0])
def test_bad_radiance_is_an_input_error_that_names_the_pixel(bad: float) -> None:
    pixels = np.ones((HEIGHT, WIDTH, 3), np.float32)
    pixels[7, 9, 1] = bad
    with pytest.raises(InputError, match="column 9, row 7"):
        environment_from_pixels(pixels)


@pytest.mark.parametrize("shape", [(32, 32, 3), (64, 32, 3), (32, 48, 3)])
def test_wrong_aspect_is_an_input_error(shape: tuple[int, int, int]) -> None:
    with pytest.raises(InputError, match="twice as wide"):
        environment_from_pixels(np.ones(shape, np.float32))


@pytest.mark.parametrize("options", [{"strength": -1.0}, {"strength": np.nan}, {"rotation_deg": np.inf}])
def test_bad_option_is_an_input_error(options: dict[str, float]) -> None:
    with pytest.raises(InputError):
        environment_from_pixels(np.ones((2, 4, 3), np.float32), **options)


def test_constant_colour_comes_from_everywhere() -> None:
    environment = environment_from_color((0.2, 0.5, 3.0))
    height, width, _ = environment.radiance.shape
    assert width == 2 * height
    np.testing.assert_allclose(environment.radiance.reshape(-1, 3), [[0.2, 0.5, 3.0]] * (width * height))


@pytest.mark.parametrize("colour", [(1.0, -0.1, 0.0), (np.nan, 0.0, 0.0), (1.0, 1.0)])
def test_bad_colour_is_an_input_error(colour: tuple[float, ...]) -> None:
    with pytest.raises(InputError):
        environment_from_color(colour)  # type: ignore[arg-type]


def test_srgb_image_is_decoded_to_linear(tmp_path: Path) -> None:
    file = tmp_path / "panorama.png"
    PilImage.fromarray(np.full((4, 8, 3), 188, np.uint8)).save(file)
    assert mean_radiance(load_environment(file)) == pytest.approx([0.5029] * 3, abs=1e-4)


@pytest.mark.parametrize("ending", [".hdr", ".exr"])
def test_float_maps_keep_their_radiance(ending: str, tmp_path: Path) -> None:
    pixels = np.full((4, 8, 3), 2048.0, np.float32)
    file = tmp_path / f"panorama{ending}"
    (write_hdr if ending == ".hdr" else write_exr_rgb)(file, pixels)
    assert mean_radiance(load_environment(file, strength=0.5)) == pytest.approx([1024.0] * 3)


def test_missing_map_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such environment map"):
        load_environment(tmp_path / "absent.hdr")


def test_unknown_and_broken_files_are_input_errors_that_name_them(tmp_path: Path) -> None:
    (tmp_path / "sky.txt").write_text("not a map")
    (tmp_path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\nrubbish")
    for name in ("sky.txt", "broken.png"):
        with pytest.raises(InputError, match=name):
            load_environment(tmp_path / name)
