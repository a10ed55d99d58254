"""What a bake writes beside its plain map: directions, shadows, probes, other formats."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
from PIL import Image

from irradia.bake.options import BakeOptions
from irradia.cli import app
from irradia.cli.bake_job import PRODUCTS, BakeJob, run_bake
from irradia.cli.bake_views import ViewOptions
from irradia.core.progress import silent_progress
from irradia.export.map_files import FORMATS, read_map
from irradia.formats.ies import IesTable, encode_ies
from irradia.formats.lightmap import read_lightmap
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.read import read_document
from irradia.scene.lightmap_uv.options import LayoutOptions

from .workshop import bake, node, write_workshop

_PARTS = ("", "_direct", "_sh_l0", "_sh_x", "_sh_y", "_sh_z")
_PROBES = ("probes.npz", "probes.bin", "probes.three.json")


def _mix_left_lamp(document):
    node(document, "left lamp")["extras"] = {"irradia": {"mode": "mixed"}}


@pytest.fixture(scope="module")
def everything(tmp_path_factory):
    """One bake with all maps: its folder and record."""
    folder = tmp_path_factory.mktemp("maps")
    scene = write_workshop(folder / "scene.gltf", _mix_left_lamp)
    options = ["--samples", "8", "--directional", "sh", "--direct-map", "--format", "all", "--no-denoise"]
    record = bake(scene, folder / "out", *options, "--probes", "grid:1.5", "--probe-samples", "32")
    return folder / "out", record


def test_every_map_is_there_in_every_format(everything):
    out, _ = everything
    maps = {f"lightmap{part}{chosen.ending}" for part in _PARTS for chosen in FORMATS.values()}
    rest = {"bake.json", "preview.png", "scene.baked.glb", "shadow_mask.png", *_PROBES}
    assert {path.name for path in out.iterdir()} == maps | rest


def test_every_file_is_one_that_a_later_bake_replaces(everything):
    from fnmatch import fnmatch

    out, _ = everything
    assert all(any(fnmatch(path.name, pattern) for pattern in PRODUCTS) for path in out.iterdir())


def test_formats_agree_on_the_light(everything):
    out, _ = everything
    expected = read_lightmap(out / "lightmap.exr")
    lit = expected.covered[0]
    for chosen in FORMATS.values():
        found = read_map(out / f"lightmap{chosen.ending}")
        assert found[lit].mean() == pytest.approx(expected.pages[0][lit].mean(), rel=0.02), chosen.name


def test_a_mixed_light_has_its_shadow_in_the_mask_and_stays_on_its_node(everything):
    out, record = everything
    assert record["shadow_mask"] == {"left lamp": 0}
    with Image.open(out / "shadow_mask.png") as image:
        seen = np.asarray(image)[..., 0]
    covered = read_lightmap(out / "lightmap.exr").covered[0]
    assert (seen[covered] == 255).mean() > 0.5
    assert (seen[covered] == 0).mean() > 0.01
    document = read_document(out / "scene.baked.glb").json
    assert "KHR_lights_punctual" in node(document, "left lamp")["extensions"]
    assert "bakedLight" in node(document, "right lamp")["extensions"]["IRRADIA_lighting"]


def test_the_baked_scene_holds_what_the_files_hold(everything):
    out, _ = everything
    lighting = read_document(out / "scene.baked.glb").json["extensions"]["IRRADIA_lighting"]
    assert {"lightmap", "direct", "directional", "shadowMask", "validity", "probes"} <= set(lighting)


def test_validity_inside_is_that_of_the_files(everything):
    out, _ = everything
    document = read_document(out / "scene.baked.glb")
    (page,) = document.json["extensions"]["IRRADIA_lighting"]["validity"]["pages"]
    with Image.open(io.BytesIO(bytes(Accessors(document).read_view(page["bufferView"])))) as image:
        codes = np.asarray(image)
    lightmap = read_lightmap(out / "lightmap.exr")
    validity = lightmap.extra["validity"][0]
    assert ((codes == 0) | (codes == 1 + np.round(254.0 * validity))).all()
    assert (codes[lightmap.covered[0]] > 0).all()
    assert 0.2 < (codes == 255).mean() < 0.95


def test_info_lists_the_light_inside(everything, capfd):
    out, record = everything
    assert app.run(["info", str(out / "scene.baked.glb"), "--json"]) == 0
    parts = {part["name"]: part for part in json.loads(capfd.readouterr().out)["baked"]}
    assert list(parts) == ["lightmap", "direct", "directional", "shadowMask", "validity", "probes"]
    assert "1 page of 32 × 32, rgb9e5" in parts["lightmap"]["text"]
    assert "sh, 4 maps" in parts["directional"]["text"]
    assert f"{record['probes']['count']}, grid" in parts["probes"]["text"]
    inside = sum(part["n_bytes"] for part in parts.values())
    assert 1000 < inside < (out / "scene.baked.glb").stat().st_size
    assert app.run(["info", str(out / "scene.baked.glb")]) == 0
    said = capfd.readouterr().out
    assert "baked light inside:" in said
    assert f"{parts['probes']['n_bytes']:,} bytes" in said


def test_info_says_nothing_of_light_where_none_is_inside(everything, capfd):
    scene = everything[0].parent / "scene.gltf"
    assert app.run(["info", str(scene), "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["baked"] == []


def test_the_direct_map_is_a_part_of_the_light(everything):
    out, record = everything
    full, direct = (read_lightmap(out / f"lightmap{part}.exr") for part in ("", "_direct"))
    np.testing.assert_array_equal(direct.coverage, full.coverage)
    assert direct.quantity == full.quantity
    share = direct.pages[full.covered].mean() / full.pages[full.covered].mean()
    assert 0.3 < share < 1.0
    assert record["direct_map"]["share"] == pytest.approx(share, rel=1e-4)


def test_the_record_counts_probes(everything):
    out, record = everything
    with np.load(out / "probes.npz") as probes:
        assert record["probes"]["count"] == len(probes["positions"])


def test_the_report_shows_maps_that_go_with_the_plain_one(everything, tmp_path):
    job = BakeJob(
        scene=str(everything[0].parent / "scene.gltf"),
        out=tmp_path,
        layout=LayoutOptions(resolution=32),
        bake=BakeOptions(samples=96, adaptive=True, directional="mono-sh", direct_map=True, denoise=False),
        views=ViewOptions(reference_spp=2, n_pixels=32 * 32, full_spp=2, baked_spp=2),
    )
    run_bake(job, silent_progress())
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    for name in (
        "Shadow mask: left lamp in red",
        "Samples per texel, dark 64",
        "Directional map sh_direction",
        "Direct map",
    ):
        assert f'alt="{name}' in html
    assert "Noise, 95th percentile" in html


def test_a_measured_lamp_shines_as_it_was_measured_and_is_in_the_provenance(tmp_path):
    def leave_only_the_left_lamp(document):
        node(document, "right lamp")["extras"] = {"irradia": {"mode": "off"}}

    scene = write_workshop(tmp_path / "scene.gltf", leave_only_the_left_lamp)
    isotropic = IesTable("C", np.array([0.0, 180.0]), np.array([0.0]), np.full((1, 2), 8.0), 2002, {})
    (tmp_path / "lamp.ies").write_bytes(encode_ies(isotropic))
    options = ["--mode", "direct", "--samples", "8", "--no-denoise"]
    bake(scene, tmp_path / "plain", *options)
    record = bake(scene, tmp_path / "measured", *options, "--ies", f"left lamp={tmp_path / 'lamp.ies'}")
    plain, measured = (
        read_lightmap(tmp_path / name / "lightmap.exr").pages for name in ("plain", "measured")
    )
    np.testing.assert_allclose(measured, 2.0 * plain, rtol=1e-3, atol=1e-6)  # the file's lamp has 4 cd
    assert set(record["provenance"]["inputs"]) == {"scene.gltf", "lamp.ies"}


def test_an_override_changes_what_the_light_is_reflected_by(tmp_path):
    scene = write_workshop(tmp_path / "scene.gltf")
    options = ["--mode", "indirect", "--samples", "16", "--no-denoise"]
    means = []
    for name, more in (("plain", []), ("black", ["--material-override", "*:albedo=0,0,0"])):
        bake(scene, tmp_path / name, *options, *more)
        lightmap = read_lightmap(tmp_path / name / "lightmap.exr")
        means.append(lightmap.pages[lightmap.covered].mean())
    assert means[0] > 0.01
    assert means[1] < 1e-6
