"""Directional maps stay consistent through filling, denoising and dilation."""

from __future__ import annotations

import sys
from functools import cache

import numpy as np
import pytest

from irradia.bake.directional import denoise_directional, finish_directional, texel_normals
from irradia.bake.directional_modes import MODES, SurfaceFrame
from irradia.bake.finish import Finisher, FinishOptions
from irradia.bake.rasterise import rasterise
from irradia.bake.texels import TexelSet
from irradia.core.progress import Progress, silent_progress
from irradia.transport.subsample_set import SubsampleSet

from .light_fields import AXES, BITANGENT, NORMAL, TANGENT, both, lamp, sky

SIZE = 64
SURFACE = SurfaceFrame(NORMAL, TANGENT, BITANGENT)


def two_charts() -> TexelSet:
    page = np.full((SIZE, SIZE), -1, np.int64)
    page[2:60, 2:30], page[2:60, 33:62] = 0, 1
    pixel = np.flatnonzero(page.ravel() >= 0)
    n = len(pixel)
    return TexelSet(
        n_pages=1,
        height_px=SIZE,
        width_px=SIZE,
        pixel=pixel.astype(np.uint32),
        triangle=np.zeros(n, np.uint32),
        samples=SubsampleSet.none(),
        coverage=np.ones(n, np.float32),
        chart=page.ravel()[pixel].astype(np.uint32),
    )


@cache
def lit(kind: str, n_rays: int | None):
    """A lamp that moves across the page, under a sky: E/π and moments, exact or of a few rays."""
    texels = two_charts()
    rng = np.random.default_rng(8)
    x = texels.pixel % SIZE / SIZE
    under_sky = sky(n=500)
    plain, moments = [], []
    for place in x:
        field = both(lamp((np.sin(5 * place), 0.3, 0.6)), under_sky)
        if n_rays is not None:
            # The lamp is sampled each time, the sky at random: so next-event estimation does it.
            drawn = np.append(0, rng.integers(1, len(field.directions), n_rays))
            weight = np.append(1.0, np.full(n_rays, (len(field.directions) - 1) / n_rays))
            field = type(field)(field.directions[drawn], field.light[drawn] * weight[:, None])
        plain.append(field.over_pi(NORMAL))
        moments.append(field.moments(kind))
    return np.float32(plain), np.float32(moments)


@pytest.fixture(scope="module")
def texels() -> TexelSet:
    return two_charts()


def finished(mode, texels, n_rays, *, valid=None, clean=True):
    plain, moments = lit(MODES[mode].moments, n_rays)
    normals = np.tile(np.float32(NORMAL), (len(plain), 1))
    valid = np.ones(len(plain), bool) if valid is None else valid
    progress = silent_progress()
    finisher = Finisher(texels, valid, FinishOptions(denoise=clean), progress)
    pages = finisher.irradiance(plain)
    maps = finish_directional(mode, texels, pages, moments, normals, valid, denoise=clean, progress=progress)
    return pages, maps


@pytest.mark.parametrize("mode", MODES)
def test_denoised_maps_give_the_denoised_plain_map_and_nothing_negative(mode, texels):
    pages, maps = finished(mode, texels, n_rays=8)
    assert tuple(maps.pages) == MODES[mode].maps
    decode = MODES[mode].irradiance_over_pi
    own = decode(pages, maps.pages, NORMAL, SURFACE)
    np.testing.assert_allclose(own, pages, rtol=1e-4, atol=1e-6)
    rng = np.random.default_rng(3)
    for normal in rng.normal(size=(200, 3)):
        value = decode(pages, maps.pages, normal / np.linalg.norm(normal), SURFACE)
        assert np.isfinite(value).all()
        assert (value >= 0.0).all()


@pytest.mark.parametrize("mode", MODES)
def test_denoising_brings_light_for_a_bent_normal_nearer_to_the_truth(mode, texels):
    bent = np.array([0.5, -0.2, 0.8]) @ AXES
    bent /= np.linalg.norm(bent)

    def relit(n_rays, clean):
        pages, maps = finished(mode, texels, n_rays, clean=clean)
        return MODES[mode].irradiance_over_pi(pages, maps.pages, bent, SURFACE).reshape(-1, 3)[texels.pixel]

    truth = relit(None, False)
    noisy, clean = (np.mean((relit(8, c) - truth) ** 2) for c in (False, True))
    assert clean < 0.35 * noisy


@pytest.mark.parametrize("mode", ["sh", "mono-sh", "rnm"])
def test_denoising_keeps_the_mean_of_signed_moments(mode, texels):
    _, moments = lit(MODES[mode].moments, n_rays=8)
    clean = denoise_directional(mode, moments, texels, silent_progress())
    for chart in (0, 1):
        own = texels.chart == chart
        before, after = (m[own].mean(axis=0, dtype=np.float64) for m in (moments, clean))
        np.testing.assert_allclose(after, before, atol=1e-4 * np.abs(before).max())


@pytest.mark.parametrize("mode", MODES)
def test_invalid_texels_take_light_from_their_chart(mode, texels):
    valid = texels.pixel % SIZE != 10
    pages, maps = finished(mode, texels, None, valid=valid, clean=False)
    assert len(pages) == 1
    for page in maps.pages.values():
        row = page[0, 20]
        between = 0.5 * (row[9] + row[11])
        np.testing.assert_allclose(row[10], between, rtol=0.05, atol=0.02)


@pytest.mark.parametrize("mode", MODES)
def test_dilated_texels_continue_the_charts(mode, texels):
    pages, maps = finished(mode, texels, None, clean=False)
    own = MODES[mode].irradiance_over_pi(pages, maps.pages, NORMAL, SURFACE)
    assert (own[0, 10, 30:33] > 0.3 * own[0, 10, 29]).all()


def test_without_the_denoiser_maps_are_still_made_and_it_is_said(texels, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    said: list[str] = []
    progress = silent_progress()
    monkeypatch.setattr(Progress, "say", lambda _self, text: said.append(text))
    plain, moments = lit("sh", 4)
    normals = np.tile(np.float32(NORMAL), (len(plain), 1))
    finisher = Finisher(texels, np.ones(len(plain), bool), FinishOptions(), progress)
    pages = finisher.irradiance(plain)
    said.clear()
    maps = finish_directional(
        "sh", texels, pages, moments, normals, np.ones(len(plain), bool), denoise=True, progress=progress
    )
    assert len(maps.pages) == 4
    assert "not denoised" in said[0]


def test_texel_normals_are_the_mean_over_the_footprint(page_mesh):
    mesh, layout = page_mesh([[[0, 0], [8, 0], [0, 8]]], 8)
    mesh.normals[:] = [[1, 0, 0], [0, 0, 1], [0, 0, 1]]
    texels = rasterise(mesh, layout)
    normals = texel_normals(mesh, texels)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-6)
    at = {tuple(np.divmod(p, 8)): n for p, n in zip(texels.pixel, normals, strict=True)}
    assert at[0, 0] @ [1, 0, 0] > 0.9
    assert at[0, 6] @ [0, 0, 1] > 0.9
