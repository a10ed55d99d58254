"""Atlases are destroyed late, and not hoarded."""

from __future__ import annotations

import time

from irradia.scene.lightmap_uv import atlas as module


def test_atlas_outlives_its_block_until_its_workers_sleep(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    module._resting.clear()

    def one():
        with module.new_atlas() as atlas:
            assert atlas.mesh_count == 0

    one()
    assert len(module._resting) == 1
    now[0] += 0.5 * module.REST_S
    one()
    assert len(module._resting) == 2
    now[0] += 0.6 * module.REST_S
    one()
    assert len(module._resting) == 2  # the first has rested long enough


def test_resting_atlases_are_given_up_in_the_end(monkeypatch):
    monkeypatch.setattr(module, "REST_S", 0.0)
    for _ in range(3):
        with module.new_atlas():
            time.sleep(0.01)
    assert len(module._resting) == 1
