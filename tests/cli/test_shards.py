"""Shards on the command line: divided and joined, a bake has the bytes of one that wasn't divided."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from irradia.bake import plan
from irradia.bake.occlusion import OcclusionOptions
from irradia.bake.options import BakeOptions
from irradia.bake.probes.options import ProbeOptions
from irradia.cli import app
from irradia.cli.bake_job import BakeJob
from irradia.cli.bake_views import ViewOptions
from irradia.cli.job_json import job_from_json, job_to_json
from irradia.cli.lighting import LightOptions
from irradia.core.errors import InputError
from irradia.scene.lightmap_uv.options import LayoutOptions
from irradia.scene.load import LoadOptions

from .workshop import bake, write_workshop

_OPTIONS = ["--samples", "64", "--directional", "mono-sh", "--format", "exr,hdr", "--probes", "random:5"]


@pytest.fixture(scope="module", autouse=True)
def small_slices():
    """Divides small bakes too."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plan, "_SAMPLES_PER_SLICE", 1 << 10)
        yield


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The scene's file, both shards of its bake, and the bake undivided."""
    folder = tmp_path_factory.mktemp("shards")
    scene = write_workshop(folder / "scene.gltf")
    bake(scene, folder / "whole", *_OPTIONS)
    for number in (1, 2):
        arguments = ["--resolution", "32", "--no-report", *_OPTIONS, "--shard", f"{number}/2"]
        assert app.run(["bake", str(scene), "-o", str(folder / "parts"), *arguments]) == 0
    return folder


def _merge(folder: Path, out: Path, *numbers: int) -> int:
    parts = [str(folder / "parts" / f"shard-{number}-of-2.npz") for number in numbers]
    return app.run(["merge", *parts, "-o", str(out)])


def test_merged_shards_have_the_bytes_of_the_whole_in_any_order(folder, tmp_path):
    assert _merge(folder, tmp_path / "out", 2, 1) == 0
    names = {path.name for path in (folder / "whole").iterdir()}
    assert {path.name for path in (tmp_path / "out").iterdir()} == names
    for name in sorted(names - {"bake.json"}):
        assert (tmp_path / "out" / name).read_bytes() == (folder / "whole" / name).read_bytes(), name


def test_merging_tells_what_the_machines_took_together(folder, tmp_path):
    assert _merge(folder, tmp_path / "out", 1, 2) == 0
    record = json.loads((tmp_path / "out" / "bake.json").read_text())
    assert record["ended_by"] == "samples"
    assert record["stats"]["samples_per_texel"] == 64
    assert 0.0 < record["samples_per_second"] < 1e10


@pytest.mark.parametrize(("numbers", "said"), [((1,), "missing 2"), ((1, 1), "missing 2")])
def test_missing_shards_are_named(numbers, said, folder, tmp_path, capfd):
    assert _merge(folder, tmp_path / "out", *numbers) == 2
    assert said in capfd.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_shards_of_a_scene_that_has_changed_are_refused(folder, tmp_path, capfd):
    def edit(document):
        document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = [0.5, 0.5, 0.5, 1.0]

    other = write_workshop(tmp_path / "scene.gltf", edit)
    parts = [str(path) for path in sorted((folder / "parts").iterdir())]
    assert app.run(["merge", *parts, "--scene", str(other), "-o", str(tmp_path / "out")]) == 2
    assert "scene" in capfd.readouterr().err


def test_more_shards_than_a_bake_can_be_divided_into_are_refused(tmp_path, capfd):
    scene = write_workshop(tmp_path / "scene.gltf")
    arguments = ["--resolution", "32", "--samples", "8", "--shard", "1/99"]
    assert app.run(["bake", str(scene), "-o", str(tmp_path / "out"), *arguments]) == 2
    assert "--shard" in capfd.readouterr().err


def _full_job() -> BakeJob:
    return BakeJob(
        scene="scene.gltf",
        out=Path("here"),
        load=LoadOptions(pose_time=1.0, variant="night"),
        light=LightOptions(env_color=(1.0, 0.5, 0.0), default_light=False),
        layout=LayoutOptions(resolution=64),
        bake=BakeOptions(samples=8, mode="indirect", directional="rnm", indirect_clamp=2.0),
        views=ViewOptions(reference_spp=4),
        only=("box", "wall*"),
        overrides=("red:albedo=1",),
        ies=("lamp=a.ies",),
        probes=ProbeOptions("random", count=3),
        formats=("hdr", "exr"),
        occlusion=OcclusionOptions(samples=4, distance_m=2.0),
        shard=(1, 2),
        threads=2,
    )


@pytest.mark.parametrize(
    "job",
    [
        _full_job(),
        BakeJob("builtin:cornell", Path("here")),
        replace(
            _full_job(), light=LightOptions(env=Path("sky.hdr")), views=None, probes=None, occlusion=None
        ),
    ],
)
def test_a_job_comes_back_from_json_as_it_was(job):
    plain = json.loads(json.dumps(job_to_json(job)))
    assert job_from_json(plain, job.out) == job
    assert job_from_json(plain, Path("there"), "other.gltf") == replace(
        job, out=Path("there"), scene="other.gltf"
    )


@pytest.mark.parametrize("damage", [{"bake": {"colour": 1}}, {"formats": None}, {"unheard": 1}])
def test_a_job_of_another_version_is_refused(damage):
    plain = job_to_json(_full_job()) | damage
    with pytest.raises(InputError, match="another version"):
        job_from_json(plain, Path("here"))


def test_a_job_with_something_missing_is_refused():
    plain = job_to_json(_full_job())
    del plain["layout"]
    with pytest.raises(InputError, match="another version"):
        job_from_json(plain, Path("here"))
