"""Every field of a sweep from one camera, beside the path-traced reference: the contact sheet."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.progress import Progress

if TYPE_CHECKING:
    from irradia.cli.eval_reference import Reference
    from irradia.cli.lighting import LightOptions
    from irradia.field.field import Field
    from irradia.field.spec import Quantity
    from irradia.transport.gbuffer import SeenPlaces

F32 = NDArray[np.float32]
_PIXELS, _SPP = 320 * 180, 4


@dataclass(frozen=True)
class PictureJob:
    """What is looked at.

    Attributes:
        scene: A file or ``builtin:NAME``.
        camera: As ``--camera`` names it; None for the first.
        light: How it is lit.
        reference_spp: Samples per pixel of the reference.
    """

    scene: str
    camera: str | None
    light: LightOptions
    reference_spp: int = 256


@dataclass(frozen=True)
class Viewpoint:
    """A camera's places, seen once and lit by one field after another.

    Attributes:
        reference: Path-traced.
        bands: Of rows.
    """

    reference: Reference
    bands: list[SeenPlaces] = field(default_factory=list)

    def picture(self, shown: Field) -> F32:
        """(H, W, 3) linear radiance under a field."""
        return np.concatenate([band.lit_by(shown.irradiance) for band in self.bands])


def look_once(job: PictureJob, quantity: Quantity, seed: int, progress: Progress) -> Viewpoint:
    """Renders the reference and finds the places that the camera sees.

    Raises:
        InputError: The scene or the camera is not what it should be.
    """
    from dataclasses import replace

    from irradia.bake.datasets.setting import in_quantity
    from irradia.cli.bake_job import open_scene
    from irradia.cli.bake_views import picture_size
    from irradia.cli.eval_reference import render_reference
    from irradia.scene.framing import camera_from_spec
    from irradia.scene.load import LoadOptions
    from irradia.transport.gbuffer import look
    from irradia.transport.render import RenderOptions

    scene = in_quantity(open_scene(job.scene, LoadOptions(), job.light, progress), quantity)
    camera = camera_from_spec(scene, job.camera)
    width, height = picture_size(camera.aspect, _PIXELS)
    options = RenderOptions(width=width, height=height, spp=_SPP, seed=seed)
    reference = render_reference(scene, camera, replace(options, spp=job.reference_spp), progress)
    return Viewpoint(reference, list(look(scene, camera, options)))


def score_all(
    files: dict[str, Path], view: Viewpoint, progress: Progress, keep: Callable[[str, Any], None]
) -> Iterator[tuple[str, F32]]:
    """Yields the picture of each field by name, and hands its HDR-FLIP to ``keep``."""
    from irradia.field.evaluation import score_picture
    from irradia.field.files import load_field
    from irradia.transport.gbuffer import mostly_scene

    scene = mostly_scene(view.bands)
    with progress.stage("pictures", len(files), "fields") as stage:
        for name, path in files.items():
            picture = view.picture(load_field(path))
            scores = score_picture(picture, view.reference.first, view.reference.second, scene)
            keep(name, scores.flip.value)
            yield name, picture
            stage.advance()
