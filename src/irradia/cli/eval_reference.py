"""Path-traced references that are kept on disk, so that the next evaluation starts from them."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia import __version__
from irradia.core.cache import cached_arrays
from irradia.core.progress import Progress
from irradia.core.rng import Seed
from irradia.scene.fingerprint import fingerprint
from irradia.scene.types import Camera, Scene

if TYPE_CHECKING:
    from irradia.transport.render import RenderOptions

F32 = NDArray[np.float32]
_VERSION = 1  # of what is kept; a change of transport that changes pictures must raise it


@dataclass(frozen=True)
class Reference:
    """Two independent halves of a picture, (H, W, 3) linear radiance each."""

    first: F32
    second: F32

    @property
    def mean(self) -> F32:
        """The picture."""
        return 0.5 * (self.first + self.second)


def render_reference(scene: Scene, camera: Camera, options: RenderOptions, progress: Progress) -> Reference:
    """Renders both halves, or takes them from the cache.

    Args:
        scene: With its lights.
        camera: Where from.
        options: ``spp`` is that of both halves together.
        progress: Shows what is rendered.
    """

    def make() -> dict[str, NDArray]:
        return {f"half_{i}": _half(scene, camera, options, i, progress) for i in range(2)}

    kept = cached_arrays("references", reference_key(scene, camera, options), make)
    return Reference(kept["half_0"], kept["half_1"])


def reference_key(scene: Scene, camera: Camera, options: RenderOptions) -> dict[str, Any]:
    """All that decides a reference; names and files don't."""
    return {
        "version": _VERSION,
        "irradia": __version__,
        "scene": fingerprint(scene),
        "camera": [camera.world_from_camera.tolist(), camera.yfov_rad],
        "options": asdict(options),
    }


def _half(scene: Scene, camera: Camera, options: RenderOptions, number: int, progress: Progress) -> F32:
    from irradia.transport.render import render

    seed = Seed(options.seed).child(f"reference-{number}").uint32()
    how = replace(options, spp=max(options.spp // 2, 1), seed=seed)
    return render(scene, camera, how, progress=progress)
