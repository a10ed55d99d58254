"""Which files the viewer is given, and under which addresses."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.export.container import glb_container
from irradia.export.field_extension import put_field
from irradia.export.web_folder import collect
from irradia.formats.hdr import read_hdr

from .viewing import ROOT, WEIGHTS, glb, write_results


@pytest.fixture
def baked(tmp_path: Path) -> Path:
    return write_results(tmp_path / "out", n_views=2)


def test_a_folder_gives_its_scene_with_weights_and_references(baked: Path) -> None:
    scene = collect([baked]).manifest()["scenes"][0]
    assert (scene["name"], scene["url"]) == ("box", "files/0/scene.baked.glb")
    assert scene["bytes"] == len(glb())
    assert [field["name"] for field in scene["fields"]] == ["field"]
    assert [each["camera"]["name"] for each in scene["references"]] == ["camera 0", "camera 1"]
    assert [(each["width"], each["height"], each["spp"]) for each in scene["references"]] == [(8, 4, 64)] * 2


def test_a_camera_is_written_column_by_column(baked: Path) -> None:
    pose = collect([baked]).manifest()["scenes"][0]["references"][1]["camera"]["worldFromCamera"]
    np.testing.assert_allclose(pose[12:], [1.0, 1.0, 3.0, 1.0])


def test_references_hold_linear_radiance(baked: Path) -> None:
    reference = collect([baked]).scenes[0].references[0]
    np.testing.assert_allclose(read_hdr(reference.file.path), 0.25)


def test_a_baked_scene_by_its_file_is_its_folder(baked: Path) -> None:
    assert collect([baked / "scene.baked.glb"]).manifest() == collect([baked]).manifest()


def test_another_scene_comes_alone(baked: Path) -> None:
    (baked / "chair.glb").write_bytes(glb())
    (scene,) = collect([baked / "chair.glb"]).scenes
    assert (scene.name, scene.fields, scene.references) == ("chair", (), ())


def test_a_folder_without_a_bake_gives_every_scene(tmp_path: Path) -> None:
    for name in ("b", "a"):
        (tmp_path / f"{name}.glb").write_bytes(glb())
    assert [scene.name for scene in collect([tmp_path]).scenes] == ["a", "b"]


def test_weights_go_with_every_scene(baked: Path, tmp_path: Path) -> None:
    (tmp_path / "chair.glb").write_bytes(glb())
    shown = collect([baked, tmp_path / "chair.glb"], [WEIGHTS]).scenes
    assert [[field.name for field in scene.fields] for scene in shown] == [
        ["field", "hash-fp32"],
        ["hash-fp32"],
    ]


def test_an_evaluation_adds_its_references(baked: Path, tmp_path: Path) -> None:
    judged = write_results(tmp_path / "judged")
    (judged / "scene.baked.glb").unlink()
    (judged / "bake.json").rename(judged / "eval.json")
    (scene,) = collect([baked, judged]).scenes
    assert len(scene.references) == 3
    assert [field.name for field in scene.fields] == ["out/field.safetensors", "judged/field.safetensors"]


def test_weights_of_one_name_are_told_apart_by_their_ending(baked: Path) -> None:
    shutil.copyfile(WEIGHTS, baked / "field.safetensors.zst")
    names = [field.name for field in collect([baked]).scenes[0].fields]
    assert names == ["field.safetensors", "field.safetensors.zst"]


def test_only_a_bin_of_weights_is_taken(baked: Path) -> None:
    (baked / "probes.bin").write_bytes(b"PRB1" * 100)
    shutil.copyfile(ROOT / "vectors" / "triplane-bin.bin", baked / "planes.bin")
    names = [field.name for field in collect([baked]).scenes[0].fields]
    assert names == ["field", "planes"]


def test_a_file_has_one_address(baked: Path) -> None:
    collection = collect([baked], [baked / "field.safetensors", WEIGHTS])
    urls = [file.url for file in collection.files()]
    assert len(urls) == len(set(urls)) == 5  # scene, two references, two fields


def test_a_copy_of_the_field_inside_is_not_shown_twice(baked: Path) -> None:
    bare = glb_container(
        {"asset": {"version": "2.0"}, "extensions": {"IRRADIA_lighting": {"version": 1}}}, b""
    )
    (baked / "bare.glb").write_bytes(bare)
    put_field(baked / "bare.glb", WEIGHTS.read_bytes(), baked / "scene.baked.glb")
    shutil.copyfile(ROOT / "vectors" / "hash-fp16.safetensors", baked / "other.safetensors")
    assert [field.name for field in collect([baked]).scenes[0].fields] == ["other"]


def test_addresses_are_safe_whatever_the_name(tmp_path: Path) -> None:
    (tmp_path / "a #1 100%?.glb").write_bytes(glb())
    assert collect([tmp_path]).scenes[0].file.url == "files/0/a%20%231%20100%25%3F.glb"


def test_nothing_makes_a_page_that_waits() -> None:
    assert collect([]).manifest()["scenes"] == []


def test_a_reference_that_has_gone_is_left_out(baked: Path) -> None:
    (baked / "view0.reference.hdr").unlink()
    assert [each.camera.name for each in collect([baked]).scenes[0].references] == ["camera 1"]


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda views: views[0].update(file="../secret.hdr"), "expected a file beside it"),
        (lambda views: views[0].pop("width"), "width"),
        (lambda views: views[0]["camera"].update(world_from_camera=[[1.0]]), "4 × 4"),
        (lambda views: views.insert(0, 3), "reference picture"),
    ],
)
def test_a_record_that_is_wrong_is_refused(baked: Path, edit, message: str) -> None:
    record = json.loads((baked / "bake.json").read_text())
    edit(record["views"])
    (baked / "bake.json").write_text(json.dumps(record))
    with pytest.raises(InputError, match=message):
        collect([baked])


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.txt", b"", "expected a folder, a .glb or weights"),
        ("a.glb", b"{}", "another kind of file"),
        ("a.safetensors", b"", "found no scene"),
        ("absent.glb", None, "no such file"),
    ],
)
def test_what_cannot_be_shown_is_refused(tmp_path: Path, name: str, data: bytes | None, message: str) -> None:
    if data is not None:
        (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match=message):
        collect([tmp_path / name])


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="neither a scene nor weights"):
        collect([tmp_path])
