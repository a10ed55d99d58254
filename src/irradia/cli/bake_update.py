"""``--update`` and ``--only``: what a bake takes over from the one before it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from irradia.bake.lightmap import LightmapBake
from irradia.bake.rebake import (
    Memory,
    Update,
    plan_update,
    read_memory,
    reason_to_start_over,
)
from irradia.core.errors import InputError
from irradia.core.progress import Progress
from irradia.scene.fingerprint import fingerprint, instance_names
from irradia.scene.types import F32, U32, Scene

if TYPE_CHECKING:
    from irradia.cli.bake_job import BakeJob

MEMORY = "bake.memory"  # in the folder of the results


@dataclass
class Revision:
    """A bake that may build on an earlier one.

    Attributes:
        update: What the edit asks for; known once the coarse pass is done, None for a whole bake.
    """

    _job: BakeJob
    _bake: LightmapBake
    _fingerprint: dict[str, Any]
    _settings: dict[str, Any]
    _before: Memory | None
    _coarse: F32 | None = None
    _estimate: F32 | None = None
    update: Update | None = None

    @staticmethod
    def begin(job: BakeJob, scene: Scene, bake: LightmapBake, progress: Progress) -> Revision:
        """Finds the earlier bake, and sees to it that only what has changed gets the result's rays.

        Raises:
            InputError: ``--update`` can't be had together with what else was asked for.
        """
        settings = {"seed": job.bake.seed, "samples": job.bake.planned_samples, "mode": job.bake.mode}
        revision = Revision(job, bake, fingerprint(scene), settings, None)
        if not (job.update or job.only):
            return revision
        if job.update and (job.resume or job.shard or job.bake.watches_noise or not job.bake.cached):
            raise InputError(
                "expected --update without --resume, --shard, --noise, --adaptive and --integrator path",
                where="--update",
            )
        before = read_memory(job.out / MEMORY)
        reason = None if before is None else reason_to_start_over(before, bake.texels.pixel, settings)
        if before is None or reason is not None:
            what = "nothing to build on: bake with --update first" if before is None else reason
            progress.say(f"note: all texels are new ({what})")
            before = None
        revision._before = before
        if job.update:
            bake.bake.before_the_last_epoch = lambda: revision._choose(scene, progress)
        return revision

    def _choose(self, scene: Scene, progress: Progress) -> U32 | None:
        """Texels that get the last epoch's rays; None for all."""
        self._coarse = self._bake.light.to_host(self._bake.bake.coarse())
        if self._before is None:
            return None
        instance = self._bake.mesh.instance[self._bake.texels.triangle]
        own = {name: instance == index for index, name in enumerate(instance_names(scene))}
        update = plan_update(self._before, self._fingerprint, self._coarse, self._bake.texels, own)
        self.update = update
        changes = update.changes
        names = [*changes.instances.changed, *changes.instances.added, *changes.lights.changed]
        progress.say(
            f"Changed: {', '.join(names[:8]) or 'no object or light'}. "
            f"{update.rebake.mean():.1%} of the texels are baked anew, {update.stale.mean():.1%} are stale."
        )
        return np.flatnonzero(update.rebake).astype(np.uint32)

    def merged(self, estimate: F32) -> F32:
        """The new light where there is any, the earlier bake's elsewhere."""
        if self._before is not None:
            kept = self._bake.bake.sample_counts() == 0
            estimate = np.where(kept[:, None], self._before.irradiance_over_pi, estimate)
        self._estimate = estimate
        return estimate

    def memory(self) -> Memory | None:
        """What the next ``--update`` needs."""
        if self._coarse is None or self._estimate is None:
            return None
        counts = self._bake.bake.sample_counts()
        if self._before is not None:
            counts = np.where(counts == 0, self._before.sample_count, counts)
        return Memory(
            self._fingerprint,
            self._settings,
            self._bake.texels.pixel,
            self._estimate,
            self._coarse,
            counts.astype(np.uint32),
        )
