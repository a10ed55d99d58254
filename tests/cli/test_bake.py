"""``irradia bake``, end to end on a small room."""

from __future__ import annotations

import json
import math
import os
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from irradia.cli import app
from irradia.cli.bake_job import PRODUCTS, BakeJob, run_bake
from irradia.cli.bake_report import convergence
from irradia.cli.bake_views import ViewOptions, picture_size
from irradia.core.progress import silent_progress
from irradia.export import web_viewer
from irradia.export.web_folder import collect
from irradia.formats.hdr import read_hdr
from irradia.formats.lightmap import read_lightmap
from irradia.scene.lightmap_uv.options import LayoutOptions

from .viewing import write_viewer

SMALL = ["--resolution", "48", "--samples", "8"]


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    return BakeJob(
        scene="builtin:cornell",
        out=tmp_path_factory.mktemp("bake") / "cornell",
        layout=LayoutOptions(resolution=128),
        views=ViewOptions(reference_spp=256, n_pixels=64 * 64, full_spp=4, baked_spp=128),
    )


@pytest.fixture(scope="module")
def summary(job, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(web_viewer, "PLACES", (write_viewer(tmp_path_factory.mktemp("viewer")),))
        return run_bake(job, silent_progress())


def test_everything_is_in_one_folder(job, summary):
    assert set(summary.files) == {
        "bake.json",
        "lightmap.exr",
        "preview.png",
        "report.html",
        "scene.baked.glb",
        "view.html",
        "view.png",
        "view0.reference.hdr",
    }
    assert sorted(summary.files) == sorted(path.name for path in job.out.iterdir())
    assert [path.name for path in job.out.parent.iterdir()] == [job.out.name]


def test_the_reference_is_kept_with_its_camera(job, summary):
    (view,) = summary.record["views"]
    assert (view["width"], view["height"], view["spp"]) == (64, 64, 256)
    picture = read_hdr(job.out / view["file"])
    assert picture.shape == (64, 64, 3)
    assert picture.mean() > 0.01
    assert collect([job.out]).scenes[0].references[0].camera.yfov_rad == pytest.approx(
        math.radians(view["camera"]["yfov_deg"])
    )


def test_the_report_leads_to_a_live_view_of_all_that_was_baked(job, summary):
    assert 'data-live="view.html"' in (job.out / "report.html").read_text()
    page = (job.out / "view.html").read_text()
    for name in ("scene.baked.glb", "view0.reference.hdr"):
        assert re.search(rf'data-irradia-file="files/\d/{re.escape(name)}"', page)


def test_every_product_is_one_that_a_later_bake_replaces(summary):
    from fnmatch import fnmatch

    assert all(any(fnmatch(name, pattern) for pattern in PRODUCTS) for name in summary.files)


def test_the_record_is_what_the_command_says(job, summary):
    assert json.loads((job.out / "bake.json").read_text()) == json.loads(json.dumps(summary.record))


def test_the_record_holds_what_scripts_ask_for(summary):
    record = summary.record
    assert record["samples_per_second"] > 0
    assert record["launches_per_pass"] >= 1
    assert record["lightmap"]["quantity"] == "irradiance_over_pi"
    assert 0 < record["lightmap"]["utilisation"] <= 1
    assert record["stage_s"]["files"] >= 0
    assert record["against_reference"]["camera"] == "camera"


def test_the_provenance_can_make_it_again(summary):
    origin = summary.record["provenance"]
    assert origin["seed"] == 0
    assert origin["config"]["bake"]["samples"] == 64
    assert origin["config"]["layout"]["resolution"] == 128
    assert re.fullmatch(r"[0-9a-f]{64}", origin["inputs"]["builtin:cornell"])
    assert origin["device"]["kind"] in ("cpu", "cuda")


def test_the_bake_looks_like_its_reference(summary):
    found = summary.record["against_reference"]
    assert found["mean_ratio"] == pytest.approx(1.0, abs=0.01)
    assert found["relmse_noise_free"] < 0.005


def test_the_map_is_the_one_that_was_measured(job, summary):
    lightmap = read_lightmap(job.out / "lightmap.exr")
    assert int(lightmap.covered.sum()) == summary.record["lightmap"]["n_texels"]
    origin = summary.record["provenance"]
    assert lightmap.provenance["inputs"] == origin["inputs"]
    assert lightmap.provenance["libraries"] == origin["libraries"]
    assert np.isfinite(lightmap.pages).all()
    assert lightmap.pages[lightmap.covered].mean() > 0.01


def test_the_report_shows_the_records_numbers(job, summary):
    html = (job.out / "report.html").read_text(encoding="utf-8")
    assert f"{summary.record['against_reference']['mean_ratio']:.4g}" in html
    assert "<h1>cornell</h1>" in html


def test_json_reports_rate_and_launches(tmp_path, capfd):
    arguments = ["bake", "builtin:cornell", "-o", str(tmp_path / "out"), "--no-report", "--json", *SMALL]
    assert app.run(arguments) == 0
    said = json.loads(capfd.readouterr().out)
    assert said["ok"] is True
    assert said["samples_per_second"] > 0
    assert said["launches_per_pass"] >= 1
    assert said["against_reference"] is None
    assert "report.html" not in said["files"]


def test_the_same_command_gives_the_same_bytes(tmp_path):
    for name in ("first", "second"):
        assert app.run(["bake", "builtin:cornell", "-o", str(tmp_path / name), "--no-report", *SMALL]) == 0
    for name in ("lightmap.exr", "preview.png", "scene.baked.glb"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes(), name


def _interrupt(out: Path, after: str) -> tuple[int, str]:
    """Sends Ctrl-C to a very long bake once a stage is done: exit code and what it said then."""
    command = ["bake", "builtin:cornell", "-o", str(out), "--samples", "1000000", "--resolution", "64"]
    # Where tests run in the background, shells have them ignore SIGINT, and children inherit that.
    program = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "from irradia.cli import main; main()"
    )
    running = subprocess.Popen([sys.executable, "-c", program, *command], stderr=subprocess.PIPE, text=True)
    assert running.stderr is not None
    watchdog = threading.Timer(120.0, running.kill)
    watchdog.start()
    while after not in (line := running.stderr.readline()):
        assert line, "it ended before it traced"
    running.send_signal(signal.SIGINT)
    said = running.communicate()[1]
    watchdog.cancel()
    return running.returncode, said


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT as POSIX terminals do")
def test_ctrl_c_before_the_first_ray_leaves_nothing(tmp_path):
    code, said = _interrupt(tmp_path / "out", after="ray tracing set-up")
    assert code == app.INTERRUPTED
    assert "run again to go on" in said
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT as POSIX terminals do")
def test_ctrl_c_during_the_gather_leaves_usable_results_and_a_way_to_go_on(tmp_path):
    out = tmp_path / "out"
    code, said = _interrupt(out, after="light bounces")
    assert code == app.INTERRUPTED
    assert "--resume goes on" in said
    assert {"lightmap.exr", "scene.baked.glb", "bake.json", "bake.state"} <= {p.name for p in out.iterdir()}
    record = json.loads((out / "bake.json").read_text())
    assert record["stats"]["complete"] is False


def test_people_get_three_lines(tmp_path, capfd):
    arguments = ["bake", "builtin:cornell", "-o", str(tmp_path / "out"), "--no-report", *SMALL]
    assert app.run(arguments) == 0
    shown = capfd.readouterr()
    assert len(shown.out.strip().splitlines()) == 3
    assert "texels" in shown.out
    assert "gather" in shown.err


def test_a_second_bake_replaces_the_first(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    for name in ("lightmap.7.exr", "report.html", "mine.txt"):
        (out / name).write_text("old")
    assert app.run(["bake", "builtin:cornell", "-o", str(out), "--no-report", *SMALL]) == 0
    names = {path.name for path in out.iterdir()}
    assert "lightmap.7.exr" not in names
    assert "report.html" not in names
    assert "mine.txt" in names


def test_a_failure_late_in_the_bake_leaves_nothing(tmp_path, monkeypatch):
    def full_disk(*arguments, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("irradia.formats.png.write_png", full_disk)
    assert app.run(["bake", "builtin:cornell", "-o", str(tmp_path / "a" / "b"), "--no-report", *SMALL]) != 0
    assert list(tmp_path.iterdir()) == []


def test_convergence_is_relative_to_the_last_epoch_by_rays_spent():
    found = convergence([{"rays": 1, "mean": 0.5}, {"rays": 2, "mean": 0.9}, {"rays": 4, "mean": 1.0}])
    assert found is not None
    assert found.samples == (1, 3, 7)
    assert found.mean_ratio == (0.5, 0.9, 1.0)


@pytest.mark.parametrize("epochs", [[], [{"rays": 64, "mean": 1.0}], [{"rays": 1, "mean": 0.0}] * 2])
def test_one_epoch_or_a_black_map_has_no_curve(epochs):
    assert convergence(epochs) is None


@pytest.mark.parametrize(("aspect", "size"), [(1.0, (720, 720)), (16 / 9, (960, 540)), (0.5, (510, 1018))])
def test_pictures_have_the_cameras_shape(aspect, size):
    assert picture_size(aspect, 960 * 540) == size
