"""A bake that a field is made from, as in the demo."""

from __future__ import annotations

import json

import numpy as np
import pytest

from irradia.bake.lightmap import BakeOptions
from irradia.cli.bake_job import BakeJob, run_bake
from irradia.cli.bake_views import ViewOptions
from irradia.cli.field_job import FILE, FieldOptions
from irradia.core.progress import silent_progress
from irradia.export.field_extension import baked_field_bytes
from irradia.field.files import read_field
from irradia.scene.gltf import read_document
from irradia.scene.lightmap_uv.options import LayoutOptions

pytestmark = pytest.mark.usefixtures("cpu_device")


@pytest.fixture(scope="module")
def baked(tmp_path_factory):
    """The folder of a small bake with a field."""
    out = tmp_path_factory.mktemp("field")
    job = BakeJob(
        scene="builtin:cornell",
        out=out,
        layout=LayoutOptions(resolution=64),
        bake=BakeOptions(samples=16),
        views=ViewOptions(reference_spp=16, n_pixels=48 * 48, full_spp=1, baked_spp=2),
        neural_field=FieldOptions("hash-50kB", "full", n_samples=20_000, rays=16, train_s=3.0),
    )
    run_bake(job, silent_progress())
    return out


def test_the_field_stands_beside_the_lightmap_with_its_tables_in_codes(baked):
    stored = read_field(baked / FILE)
    assert {tensor.bits for tensor in stored.tensors.values()} == {8}
    assert stored.n_bytes < 60_000


def test_the_baked_scene_holds_the_same_file(baked):
    assert baked_field_bytes(read_document(baked / "scene.baked.glb")) == (baked / FILE).read_bytes()


def test_it_holds_the_light_of_the_room(baked):
    field = read_field(baked / FILE).field
    up, down = np.float32([[0, 1, 0]]), np.float32([[0, -1, 0]])
    middle = field.frame.aabb.mean(axis=0, keepdims=True)
    assert field.irradiance(middle, up).mean() > 1.2 * field.irradiance(middle, down).mean()


def test_the_record_and_the_report_tell_of_it(baked):
    record = json.loads((baked / "bake.json").read_text())["neural_field"]
    assert record["n_bytes"] == (baked / FILE).stat().st_size
    assert record["views"][0]["mean_ratio"]["value"] == pytest.approx(1.0, abs=0.1)
    html = (baked / "report.html").read_text(encoding="utf-8")
    assert html.count('class="comparison"') == 2
    assert "Neural field against the reference" in html
    assert "lightmap, 64 × 64, as KTX2" in html
