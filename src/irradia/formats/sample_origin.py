"""Whether two datasets are of the same light, as far as they say where they come from."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from irradia.core.errors import InputError
from irradia.formats.sample_rows import SampleInfo

_CHOICES = ("load", "light", "overrides", "ies")  # of a sampling, those that change a scene's light
_PHRASES = {
    "scene": "the scene's file differs",
    "load": "the variant or the pose differs",
    "light": "light from outside differs (--env, --sky and the like)",
    "overrides": "--material-override differs",
    "ies": "--ies differs",
}
_SCENES = (".glb", ".gltf")  # hashed as scenes, or lightmaps, of which there may be several


def check_same_light(info: SampleInfo, other: SampleInfo, where: str, *, same_box: bool = False) -> None:
    """Refuses a dataset of another scene, or of the same one lit otherwise.

    Args:
        info: Of the samples that are trained from.
        other: Of those to judge by.
        where: The latter's file, for the error.
        same_box: The boxes must be the same; without, it is enough that they meet.

    Raises:
        InputError: It says what differs.
    """
    for problem in (_of_boxes(info, other, same_box), difference(info.provenance, other.provenance)):
        if problem:
            raise InputError(
                f"these samples are of another scene than those to train from: {problem}",
                where=where,
                fix="Sample both from the same scene and light.",
            )


def _of_boxes(info: SampleInfo, other: SampleInfo, same_box: bool) -> str:
    (low, high), (other_low, other_high) = (np.array(each.aabb, np.float32) for each in (info, other))
    if same_box:
        same = np.array_equal(low, other_low) and np.array_equal(high, other_high)
        return "" if same else "their boxes differ"
    return "" if np.all(low <= other_high) and np.all(other_low <= high) else "their boxes don't meet"


def difference(provenance: Any, other: Any) -> str:
    """What the scenes and the light of two datasets' provenances differ in; empty where they don't.

    Files that don't say whence they come are believed.
    """
    here, there = _origin(provenance), _origin(other)
    return next((_PHRASES.get(name, name) for name in _differing(here, there)), "")


def _differing(here: dict[str, Any], there: dict[str, Any]) -> list[str]:
    """Names of what both know and know otherwise, the scene first."""
    names = [*_PHRASES, *sorted(here.keys() - _PHRASES.keys())]
    return [name for name in names if name in here and name in there and here[name] != there[name]]


def _origin(provenance: Any) -> dict[str, Any]:
    """Hashes of the scene and of files that light it, and the choices that do, where they are known."""
    config, inputs = (
        provenance.get(name) if isinstance(provenance, Mapping) else None for name in ("config", "inputs")
    )
    if not isinstance(config, Mapping) or not isinstance(inputs, Mapping):
        return {}
    known = {name: _plain(config[name]) for name in _CHOICES if name in config}
    scene = inputs.get(config.get("scene"))
    files = {
        f"the file {name} differs": digest
        for name, digest in inputs.items()
        if not name.lower().endswith(_SCENES) and name != config.get("scene")
    }
    return known | files | ({} if scene is None else {"scene": scene})


def _plain(choice: Any) -> Any:
    """A choice without the folders of its files, which earlier versions have kept."""
    if isinstance(choice, (list, tuple)):
        return [re.sub(r"[^=]*[/\\]", "", each) if isinstance(each, str) else each for each in choice]
    return choice
