"""Whether two datasets are of the same light, as far as they say where they come from."""

from __future__ import annotations

from typing import Any

import numpy as np

from irradia.core.errors import InputError
from irradia.formats.sample_rows import SampleInfo

_CHOICES = ("load", "light", "overrides", "ies")  # of a sampling, those that change a scene's light


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
    for problem in (_of_boxes(info, other, same_box), _of_origins(info, other)):
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


def _of_origins(info: SampleInfo, other: SampleInfo) -> str:
    """Files that don't say whence they come are believed."""
    here, there = (_origin(each.provenance) for each in (info, other))
    return next((f"{name} differs" for name in here.keys() & there.keys() if here[name] != there[name]), "")


def _origin(provenance: Any) -> dict[str, Any]:
    """The scene's hash and the choices that light it, where they are known."""
    config, inputs = provenance.get("config"), provenance.get("inputs")
    if not isinstance(config, dict) or not isinstance(inputs, dict):
        return {}
    known = {name: config[name] for name in _CHOICES if name in config}
    scene = inputs.get(config.get("scene"))
    return known | ({} if scene is None else {"scene": scene})
