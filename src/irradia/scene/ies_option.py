"""``--ies [LIGHT=]FILE``: measured distributions for the lights of a file that has none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean
from irradia.scene.light_profile import load_profile
from irradia.scene.types import IesProfile, Light, Scene

_OPTION = "--ies"


def apply_ies(scene: Scene, choices: Sequence[str]) -> Scene:
    """Gives points and spots the distribution of an IES file.

    The file's candela replace the light's own and its cone; what stays of its intensity is the
    hue, the brightest channel at 1. Later choices go over earlier ones.

    Args:
        scene: With its lights.
        choices: Each ``FILE``, for all points and spots, or ``LIGHT=FILE``, for those of that name.

    Raises:
        InputError: There is no such light, or the file can't be read or is malformed.
    """
    lights = list(scene.lights)
    notes: dict[str, None] = dict.fromkeys(scene.notes)
    for choice in choices:
        name, path = _split(choice, lights)
        profile, remarks = load_profile(path)
        notes.update(dict.fromkeys(f"{path}: {remark}" for remark in remarks))
        for index in _chosen(lights, name):
            lights[index] = _measured(lights[index], profile)
    return replace(scene, lights=tuple(lights), notes=tuple(notes))


def _split(choice: str, lights: Sequence[Light]) -> tuple[str | None, Path]:
    """The light's name, or None for all, and the file. A file's own name may hold an equals sign."""
    name, equals, path = choice.partition("=")
    if not equals or (name not in {light.name for light in lights} and Path(choice).exists()):
        return None, Path(choice)
    return name, Path(path)


def _chosen(lights: Sequence[Light], name: str | None) -> list[int]:
    local = [index for index, light in enumerate(lights) if light.kind != "directional"]
    chosen = local if name is None else [index for index in local if lights[index].name == name]
    if chosen:
        return chosen
    if name is None:
        raise InputError("the scene has no point or spot light to give a profile to", where=_OPTION)
    raise InputError(
        f"there is no point or spot light called {name!r}",
        where=_OPTION,
        fix=did_you_mean(name, [lights[index].name for index in local]),
    )


def _measured(light: Light, profile: IesProfile) -> Light:
    strongest = max(light.intensity)
    red, green, blue = (c / strongest if strongest else 1.0 for c in light.intensity)
    return replace(light, intensity=(red, green, blue), profile=profile)
