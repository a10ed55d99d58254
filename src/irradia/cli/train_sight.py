"""Whether points of a scene see each other, for copies of samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irradia.core.progress import Progress

if TYPE_CHECKING:
    from irradia.field.training.jitter import Visibility


def sight_in(scene_spec: str, threads: int | None, progress: Progress) -> Visibility:
    """A test by rays in a scene.

    Args:
        scene_spec: A file or ``builtin:NAME``.
        threads: Of the CPU; None takes all.
        progress: Shows the stages of opening it.
    """
    from irradia.cli.bake_job import open_scene
    from irradia.cli.lighting import LightOptions
    from irradia.scene.load import LoadOptions
    from irradia.scene.merge import merge
    from irradia.transport import use_device

    use_device("auto", threads)
    scene = open_scene(scene_spec, LoadOptions(), LightOptions(), progress)
    from irradia.transport.between import Between

    return Between(merge(scene))
