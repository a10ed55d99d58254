"""``--update`` and ``--only``: what a bake takes over from the one before it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.bake.lightmap import LightmapBake
from irradia.bake.rebake import (
    Memory,
    Update,
    plan_update,
    read_memory,
    reason_to_start_over,
)
from irradia.core.progress import Progress
from irradia.scene.fingerprint import SceneChanges, fingerprint, instance_names
from irradia.scene.types import F32, U32, Scene

if TYPE_CHECKING:
    from irradia.cli.bake_job import BakeJob

MEMORY = "bake.memory"  # in the folder of the results
_MOST_NAMES = 8


@dataclass
class Revision:
    """A bake that may build on an earlier one.

    Attributes:
        update: What was baked anew and what is stale; None where there was nothing to build on.
    """

    _job: BakeJob
    _scene: Scene
    _bake: LightmapBake
    _settings: dict[str, Any]
    _shown: dict[str, Any]
    _before: Memory | None
    _planned: Update | None = None
    update: Update | None = None

    @staticmethod
    def begin(job: BakeJob, scene: Scene, bake: LightmapBake, progress: Progress) -> Revision | None:
        """Finds the earlier bake, and sees to it that only what has changed gets the result's rays.

        Returns:
            None for a bake that neither builds on another nor is built on.

        Raises:
            InputError: The earlier bake's memory is damaged.
        """
        if not (job.update or (job.only and job.bake.cached and not job.bake.one_bounce)):
            return None
        settings = _settings(job)
        before = read_memory(job.out / MEMORY)
        if before is not None:
            reason = reason_to_start_over(before, bake.texels.pixel, settings)
            if reason is not None:
                progress.say(f"note: nothing of the last bake can be kept: {reason}")
                before = None
        elif job.only:
            progress.say(f"note: {job.out} holds no bake made with --update: the other objects stay coarse")
        revision = Revision(job, scene, bake, settings, fingerprint(scene), before)
        if before is not None:
            bake.bake.before_the_last_epoch = lambda: revision._plan(before, progress)
        return revision

    def _plan(self, before: Memory, progress: Progress) -> U32 | None:
        """Texels that get the last epoch's rays; None leaves it to ``--only``."""
        planned = plan_update(before, self._shown, self._coarse(), self._bake.texels, self._own_texels())
        self._planned = planned
        progress.say(f"Changed: {_names(planned.changes) or 'nothing'}.")
        return np.flatnonzero(planned.rebake).astype(np.uint32) if self._job.update else None

    def _coarse(self) -> F32:
        return self._bake.light.to_host(self._bake.bake.coarse())

    def _own_texels(self) -> dict[str, NDArray[np.bool_]]:
        """(N,) by name of each object: which texels are its."""
        instance = self._bake.mesh.instance[self._bake.texels.triangle]
        return {name: instance == index for index, name in enumerate(instance_names(self._scene))}

    def fill_in(self, progress: Progress) -> Memory:
        """Takes the earlier bake's light where this one has traced none.

        Returns:
            What the next ``--update`` or ``--only`` needs.
        """
        from irradia.transport.texel_sums import TexelSums

        before, coarse, shown = self._before, self._coarse(), self._shown
        if before is not None:
            fresh = self._bake.bake.sample_counts() > 0
            self._bake.bake.fill_in(TexelSums.from_arrays(dict(before.sums)))
            coarse = np.where(fresh[:, None], coarse, before.coarse)
            if self._job.only:
                shown = {**shown, "instances": self._last_baked(before, fresh)}
            self._tell(fresh, progress)
        sums = self._bake.bake.progression.total.to_arrays()
        return Memory(shown, self._settings, self._bake.texels.pixel, coarse, sums)

    def _last_baked(self, before: Memory, fresh: NDArray[np.bool_]) -> dict[str, str]:
        """Objects as they were when they were last baked."""
        now, known = self._shown["instances"], before.fingerprint["instances"]
        own = self._own_texels()
        return {name: now[name] if (own[name] & fresh).any() else known.get(name, "") for name in now}

    def _tell(self, fresh: NDArray[np.bool_], progress: Progress) -> None:
        """Whatever has moved and has got no rays is stale."""
        planned, valid = self._planned, self._bake.valid
        if planned is None:
            return
        stale = valid & ~fresh & (planned.rebake | planned.stale)
        self.update = Update(fresh, stale, planned.changes)
        progress.say(
            f"{fresh[valid].mean():.1%} of the texels were baked anew, {stale[valid].mean():.1%} are stale."
        )


def _settings(job: BakeJob) -> dict[str, Any]:
    """What must be the same for two bakes' early passes, and for their sums, to be comparable."""
    bake = job.bake
    return {
        "seed": bake.seed,
        "number of samples": bake.planned_samples,
        "mode": bake.mode,
        "directional mode": bake.directional,
        "choice of normal maps": bake.normal_maps,
        "clamp": bake.indirect_clamp,
        "choice of rays": bake.fast_rays,
        "view to finish first": job.view_first is not None,
    }


def _names(changes: SceneChanges) -> str:
    names = [f"{name} (gone)" for part in (changes.instances, changes.lights) for name in part.removed]
    names += [n for part in (changes.instances, changes.lights) for n in (*part.changed, *part.added)]
    names += ["the environment"] if changes.environment else []
    more = len(names) - _MOST_NAMES
    return ", ".join(names[:_MOST_NAMES]) + (f" and {more} more" if more > 0 else "")
