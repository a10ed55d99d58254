"""Bakes that are watched, stopped, resumed and divided."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from irradia.bake import plan
from irradia.bake.lightmap import BakeOptions, LightmapBake, Selection, start_bake
from irradia.bake.shards import Shard, in_order, join, read_shard, write_shard
from irradia.bake.state import load_state, save_state
from irradia.core.errors import InputError
from irradia.core.progress import silent_progress
from irradia.scene.framing import camera_from_spec
from irradia.scene.layout import LightmapLayout
from irradia.scene.types import Scene

from .lit_scenes import laid_out, lit

RESOLUTION = 64
IDENTITY = {"scene": "cornell"}


@pytest.fixture(scope="module")
def cornell() -> tuple[Scene, LightmapLayout]:
    scene = lit("cornell")
    return scene, laid_out(scene, RESOLUTION)


def _start(
    cornell: tuple[Scene, LightmapLayout], selection: Selection | None = None, **options
) -> LightmapBake:
    choices = {"samples": 64, "denoise": False, "seed": 3, **options}
    return start_bake(*cornell, BakeOptions(**choices), selection=selection)


def _values(bake: LightmapBake) -> NDArray[np.float32]:
    return bake.light.to_host(bake.bake.estimate())


def _run(bake: LightmapBake, n_passes: int | None = None) -> NDArray[np.float32]:
    for number, _ in enumerate(bake.passes()):
        if n_passes is not None and number + 1 >= n_passes:
            bake.bake.stop()
    return _values(bake)


@pytest.fixture(scope="module")
def whole(cornell) -> NDArray[np.float32]:
    return _run(_start(cornell))


def test_every_pass_tells_which_texels_have_changed_and_to_what(cornell):
    bake = _start(cornell)
    seen = np.zeros(bake.light.n_texels, bool)
    for done in bake.passes():
        values = done.read()
        assert values.shape == (len(done.texels), 3)
        assert np.isfinite(values).all()
        seen[done.texels] = True
    assert (seen == bake.valid).all()
    np.testing.assert_array_equal(values, _values(bake)[done.texels])


@pytest.mark.parametrize("n_passes", [1, 2, 3, 5])
def test_resumed_bake_has_the_bytes_of_one_that_never_stopped(cornell, whole, tmp_path: Path, n_passes: int):
    broken = _start(cornell)
    _run(broken, n_passes)
    save_state(tmp_path / "state", broken.bake, IDENTITY)
    again = _start(cornell)
    load_state(tmp_path / "state", again.bake, IDENTITY)
    np.testing.assert_array_equal(_run(again), whole)


def test_resumed_adaptive_bake_has_the_bytes_of_one_that_never_stopped(cornell, tmp_path: Path):
    options = {"samples": None, "noise": 0.06}
    expected = _run(_start(cornell, **options))
    broken = _start(cornell, **options)
    _run(broken, 8)
    assert not broken.bake.complete
    save_state(tmp_path / "state", broken.bake, IDENTITY)
    again = _start(cornell, **options)
    load_state(tmp_path / "state", again.bake, IDENTITY)
    np.testing.assert_array_equal(_run(again), expected)


def test_stopped_bake_is_usable(cornell, whole):
    for n_passes in (1, 3):
        values = _run(_start(cornell), n_passes)
        assert np.isfinite(values).all()
        assert 0.05 < values.mean() / whole.mean() < 1.2


def test_state_of_another_bake_is_refused(cornell, tmp_path: Path):
    bake = _start(cornell)
    save_state(tmp_path / "state", bake.bake, IDENTITY)
    with pytest.raises(InputError, match="differs in: scene"):
        load_state(tmp_path / "state", bake.bake, {"scene": "blocks"})


@pytest.mark.parametrize("damage", ["truncated", "text", "missing"])
def test_damaged_state_is_refused(cornell, tmp_path: Path, damage: str):
    path = tmp_path / "state"
    bake = _start(cornell)
    save_state(path, bake.bake, IDENTITY)
    if damage == "truncated":
        path.write_bytes(path.read_bytes()[:1000])
    elif damage == "text":
        path.write_text("not a state")
    else:
        path.unlink()
    with pytest.raises(InputError, match="interrupted bake"):
        load_state(path, bake.bake, IDENTITY)


def _shard(cornell, number: int, count: int) -> Shard:
    bake = _start(cornell, Selection(shard=(number, count)), samples=256)
    bake.bake.keep_slices = []
    _run(bake)
    direct = bake.bake.progression.direct.to_arrays()
    return Shard(number, count, {}, IDENTITY, bake.bake.cache_hash(), direct, tuple(bake.bake.keep_slices))


def test_merged_shards_have_the_bytes_of_an_undivided_bake(
    cornell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(plan, "_SAMPLES_PER_SLICE", 1 << 14)
    expected = _run(_start(cornell, samples=256))
    for number in (1, 2):
        write_shard(tmp_path / str(number), _shard(cornell, number, 2))
    parts = in_order([read_shard(tmp_path / "2"), read_shard(tmp_path / "1")])
    bake = _start(cornell, samples=256)
    join(bake.bake, parts, IDENTITY)
    assert bake.bake.complete
    np.testing.assert_array_equal(_values(bake), expected)


def test_missing_shard_is_named():
    shard = Shard(1, 3, {}, IDENTITY, "", {}, ())
    with pytest.raises(InputError, match="missing 2, 3"):
        in_order([shard])


def test_shards_of_different_bakes_do_not_mix():
    one, other = (Shard(i, 2, {}, {"scene": name}, "", {}, ()) for i, name in ((1, "a"), (2, "b")))
    with pytest.raises(InputError, match="differ in: scene"):
        in_order([one, other])


def test_damaged_shard_is_refused(tmp_path: Path):
    (tmp_path / "shard").write_bytes(b"PK\x03\x04 nonsense")
    with pytest.raises(InputError, match="damaged"):
        read_shard(tmp_path / "shard")


def test_noise_budget_is_met_and_checked_against_the_truth(cornell):
    truth = _run(_start(cornell, samples=4096, seed=99))
    bake = _start(cornell, samples=None, noise=0.05)
    values = _run(bake)
    weights = np.array([0.2126, 0.7152, 0.0722])
    error = np.abs(values @ weights - truth @ weights)[bake.bake.texels]
    relative = error / (truth @ weights + 0.01 * np.median(truth @ weights))[bake.bake.texels]
    assert bake.stats()["noise_p95"] <= 0.05
    assert np.mean(relative**2) ** 0.5 < 0.05  # 95 % of the texels are to have less as their standard error


def test_adaptive_bake_has_the_mean_of_a_uniform_one(cornell):
    uniform, adaptive = _run(_start(cornell, samples=256)), _run(_start(cornell, samples=256, adaptive=True))
    assert adaptive.mean() == pytest.approx(uniform.mean(), rel=3e-3)


def test_time_budget_ends_the_bake(cornell):
    bake = _start(cornell, samples=None, time_s=0.5)
    _run(bake)
    assert bake.bake.progression.spent_s < 1.5
    assert bake.bake.sample_counts()[bake.bake.texels].min() > 0


def test_what_the_camera_sees_comes_first(cornell):
    scene, _ = cornell
    bake = _start(cornell, Selection(view=camera_from_spec(scene, None)), samples=256)
    seen = bake.light.seen_from(camera_from_spec(scene, None)) & bake.valid
    assert 0.05 < seen.mean() < 0.95
    counts = []
    for _ in bake.passes():
        rays = bake.bake.sample_counts()
        counts.append((rays[seen].mean(), rays[~seen & bake.valid].mean()))
    assert max(unseen / max(mine, 1) for mine, unseen in counts[len(counts) // 3 : len(counts) // 2]) < 1.0
    assert counts[-1][1] == pytest.approx(256)


def test_only_the_chosen_instances_get_the_results_rays(cornell):
    scene, _ = cornell
    chosen = np.arange(len(scene.instances)) == 0
    bake = _start(cornell, Selection(instances=chosen))
    _run(bake)
    mine = bake.mesh.instance[bake.texels.triangle] == 0
    rays = bake.bake.sample_counts()
    assert (rays[mine & bake.valid] == 64).all()
    assert (rays[~mine] == 0).all()


def test_ctrl_c_asks_first(monkeypatch: pytest.MonkeyPatch):
    import signal

    from irradia.core.interrupt import asks_first

    asked = []
    with asks_first(lambda: asked.append(True), lambda text: None):
        signal.raise_signal(signal.SIGINT)
        assert asked == [True]
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)


def test_progress_is_silent_when_none_is_given(cornell, capsys: pytest.CaptureFixture[str]):
    _run(_start(cornell, samples=1))
    assert capsys.readouterr().err == ""
    assert silent_progress().stream is None


def test_state_is_saved_without_a_copy_of_everything(cornell, tmp_path: Path):
    import tracemalloc

    bake = _start(cornell, samples=8)
    _run(bake, 2)
    tracemalloc.start()
    save_state(tmp_path / "bake.state", bake.bake, IDENTITY)
    _, highest = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert highest < 0.5 * (tmp_path / "bake.state").stat().st_size
