"""``--update`` and ``--only``: only what has changed is baked, and it is right."""

from __future__ import annotations

import json
import shutil
from contextlib import contextmanager

import numpy as np
import pytest

from irradia.cli import app
from irradia.cli.bake_update import MEMORY
from irradia.cli.output import INTERRUPTED
from irradia.formats.lightmap import read_lightmap

from .workshop import bake, lamp, node, write_workshop

_RAW = ["--no-denoise", "--no-seams"]


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    """A scene's file and its first bake; copies of the folder are updated."""
    folder = tmp_path_factory.mktemp("update")
    scene = write_workshop(folder / "scene.gltf")
    bake(scene, folder / "baked", "--update", *_RAW)
    return folder


@pytest.fixture
def again(first, tmp_path):
    """Bakes an edited scene over a copy of the first bake."""
    shutil.copytree(first / "baked", tmp_path / "out")

    def run(edit=None, *options):
        scene = write_workshop(tmp_path / "scene.gltf", edit)
        record = bake(scene, tmp_path / "out", *_RAW, *(options or ("--update",)))
        return record["update"], read_lightmap(tmp_path / "out" / "lightmap.exr")

    return run


@pytest.fixture(scope="module")
def before(first):
    return read_lightmap(first / "baked" / "lightmap.exr")


def _move_box(document):
    node(document, "box")["translation"] = [-1.5, 0.0, 0.2]


def _dim(factor):
    def edit(document):
        for name in ("left lamp", "right lamp"):
            lamp(document, name)["intensity"] *= factor

    return edit


def _relative_error(found, expected):
    """Of every texel's mean over its colours; the floor is 1 % of the median."""
    light, true = (m.pages[expected.covered].mean(axis=-1) for m in (found, expected))
    return np.abs(light - true) / (true + 0.01 * np.median(true))


def test_nothing_is_baked_anew_where_nothing_has_changed(again, before):
    update, now = again()
    assert update == {"rebaked_share": 0.0, "stale_share": 0.0}
    np.testing.assert_array_equal(now.pages, before.pages)
    np.testing.assert_array_equal(now.extra["samples"], before.extra["samples"])


def test_a_moved_object_is_right_again_and_what_is_far_away_keeps_its_light(again, before, tmp_path):
    update, now = again(_move_box)
    assert 0.1 < update["rebaked_share"] < 0.9
    bake(tmp_path / "scene.gltf", tmp_path / "whole", "--samples", "512", "--seed", "5", *_RAW)
    whole = read_lightmap(tmp_path / "whole" / "lightmap.exr")
    kept = now.covered & (now.pages == before.pages).all(axis=-1)
    assert kept[now.covered].mean() == pytest.approx(1.0 - update["rebaked_share"], abs=0.02)
    for part in (now.covered & ~kept, kept):
        assert now.pages[part].mean() == pytest.approx(whole.pages[part].mean(), rel=0.01)
    assert np.percentile(_relative_error(now, whole), 98) < 0.1
    assert np.percentile(_relative_error(before, whole), 95) > 0.3


def test_a_changed_colour_is_followed_by_its_reflection(again, before):
    def turn_green(document):
        document["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = [0.1, 0.7, 0.1, 1.0]

    update, now = again(turn_green)
    assert 0.05 < update["rebaked_share"] < 0.9
    assert 0.0 < update["stale_share"] < 0.9
    changed = now.covered & (now.pages != before.pages).any(axis=-1)
    lost, won = (now.pages - before.pages)[changed].mean(axis=0)[:2]
    assert lost < 0.0 < won


def test_what_has_moved_a_little_is_marked_and_many_edits_add_up(again):
    update, now = again(_dim(1.007))
    assert update["rebaked_share"] == 0.0
    assert update["stale_share"] > 0.95
    assert (now.extra["stale"][now.covered] > 0).mean() == pytest.approx(update["stale_share"], abs=0.01)
    update, now = again(_dim(1.014))
    assert update["rebaked_share"] > 0.95
    assert (now.extra["stale"] == 0).all()


def test_other_settings_start_over(again, capfd):
    update, _ = again(None, "--update", "--samples", "32")
    assert update is None
    assert "nothing of the last bake can be kept" in capfd.readouterr().err


def test_a_damaged_memory_is_bad_input(again, tmp_path, capfd):
    memory = tmp_path / "out" / MEMORY
    memory.write_bytes(memory.read_bytes()[:2000])
    scene = write_workshop(tmp_path / "scene.gltf")
    arguments = ["bake", str(scene), "-o", str(tmp_path / "out"), "--update", "--no-report", "--json"]
    assert app.run([*arguments, "--resolution", "32"]) == 2
    assert json.loads(capfd.readouterr().out)["error"]["where"] == str(memory)


def test_only_bakes_the_chosen_object_and_leaves_the_others_as_they_were(again, before):
    update, now = again(_dim(2.0), "--only", "bo*")
    anew = now.covered & (now.pages != before.pages).any(axis=-1)
    assert 0.01 < anew[now.covered].mean() <= update["rebaked_share"] < 0.2
    ratio = now.pages[anew].mean() / before.pages[anew].mean()
    assert ratio == pytest.approx(2.0, rel=0.02)
    assert (now.extra["stale"][now.covered & ~anew] > 0).mean() > 0.95


def test_what_only_left_out_is_found_by_the_next_update(again):
    again(_dim(2.0), "--only", "bo*")
    update, now = again(_dim(2.0))
    assert 0.5 < update["rebaked_share"] < 0.99
    assert (now.extra["stale"] == 0).all()


def test_an_object_that_only_left_out_counts_as_changed_until_it_is_baked(again, capfd):
    def nudge(document):  # too little for the light to tell
        node(document, "box")["translation"][0] += 1e-4

    again(nudge, "--only", "wall")
    capfd.readouterr()
    again(nudge)
    assert "Changed: box." in capfd.readouterr().err
    again(nudge)
    assert "Changed: nothing." in capfd.readouterr().err


def test_an_update_that_was_stopped_goes_on_to_the_same_bytes(first, again, tmp_path, monkeypatch):
    @contextmanager
    def stop_at_once(stop, say):
        stop()
        yield

    scene = write_workshop(tmp_path / "scene.gltf", _move_box)
    shutil.copytree(first / "baked", tmp_path / "through")
    bake(scene, tmp_path / "through", "--update", *_RAW)
    with monkeypatch.context() as patch:
        patch.setattr("irradia.cli.bake_trace.asks_first", stop_at_once)
        arguments = ["bake", str(scene), "-o", str(tmp_path / "out"), "--update", "--no-report", *_RAW]
        assert app.run([*arguments, "--resolution", "32"]) == INTERRUPTED
    update, _ = again(_move_box, "--update", "--resume")
    assert 0.1 < update["rebaked_share"] < 0.9
    stopped, through = (read_lightmap(tmp_path / name / "lightmap.exr") for name in ("out", "through"))
    np.testing.assert_array_equal(stopped.pages, through.pages)
    np.testing.assert_array_equal(stopped.extra["stale"], through.extra["stale"])
    assert (tmp_path / "out" / MEMORY).read_bytes() == (tmp_path / "through" / MEMORY).read_bytes()


def test_directional_maps_keep_their_directions(tmp_path):
    scene = write_workshop(tmp_path / "scene.gltf")
    name = "lightmap_sh_x.exr"
    options = ["--update", "--directional", "sh", "--samples", "16", *_RAW]
    bake(scene, tmp_path / "out", *options)
    before = (read_lightmap(tmp_path / "out" / name)).pages
    assert bake(scene, tmp_path / "out", *options)["update"]["rebaked_share"] == 0.0
    np.testing.assert_array_equal(read_lightmap(tmp_path / "out" / name).pages, before)
