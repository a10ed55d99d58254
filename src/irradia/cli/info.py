"""``irradia info``: what is in a scene and what the bake will do with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from irradia.cli import options
from irradia.cli.output import finish

if TYPE_CHECKING:
    from irradia.export.contents import BakedPart
    from irradia.scene.info import SceneFacts


@click.command("info")
@click.argument("scene")
@options.lighting_options
@options.scene_options
@options.json_option
def command(as_json: bool, scene: str, variant: str | None, pose_time: float | None, **light: Any) -> None:
    """What is in a scene and what the bake will do with it.

    SCENE is a .gltf, a .glb, or builtin:NAME. Light is as it would be baked. A source's mean is the
    irradiance that it would give the scene's surfaces on average with nothing in the way.
    """
    from irradia.cli.bake_job import open_scene
    from irradia.core.progress import silent_progress
    from irradia.export.contents import baked_parts
    from irradia.scene.info import scene_facts
    from irradia.scene.load import LoadOptions

    load = LoadOptions(pose_time=pose_time, variant=variant)
    opened = open_scene(scene, load, options.light_options(**light), silent_progress())
    facts = scene_facts(opened)
    baked = baked_parts(opened.document) if opened.document is not None else ()
    finish(as_json, _plain(facts) | {"baked": [asdict(part) for part in baked]}, describe(facts, baked))


def describe(facts: SceneFacts, baked: Sequence[BakedPart] = ()) -> str:
    """The inventory as text."""
    size = [high - low for low, high in zip(facts.bounds_min_m, facts.bounds_max_m, strict=True)]
    lines = [
        facts.name,
        f"  triangles   {facts.n_triangles:,} in {facts.n_instances:,} instances of {facts.n_primitives:,}",
        f"  vertices    {facts.n_vertices:,}",
        f"  materials   {facts.n_materials}, {facts.n_textures} textures",
        f"  cameras     {facts.n_cameras}",
        f"  size        {' × '.join(f'{s:.3g}' for s in size)} m, {facts.surface_area_m2:.4g} m² of surface",
        *_materials(facts),
        "  light, mean irradiance before shadows:",
        *[f"    {s.mean_irradiance:>10.4g}  {s.kind:<12} {s.name}" for s in facts.sources],
        *_baked(baked),
        *[f"  note: {note}" for note in facts.notes],
        *[f"  warning: {warning}" for warning in facts.warnings],
    ]
    if not facts.sources:
        lines.insert(lines.index("  light, mean irradiance before shadows:") + 1, "    none")
    return "\n".join(lines)


def _baked(parts: Sequence[BakedPart]) -> list[str]:
    """The light that an earlier bake has put inside."""
    if not parts:
        return []
    lines = [f"    {part.name:<12}{part.text}, {part.n_bytes:,} bytes" for part in parts]
    return ["  baked light inside:", *lines]


def _materials(facts: SceneFacts) -> list[str]:
    """Materials that are treated in a way of their own, by that way."""
    groups = {
        "alpha mask": facts.alpha_mask,
        "alpha blend": facts.alpha_blend,
        "transmissive": facts.transmissive,
        "emissive": facts.emissive,
        "unlit": facts.unlit,
        "two-sided": facts.double_sided,
    }
    return [f"  {label:<12}{_listed(names)}" for label, names in groups.items() if names]


def _listed(names: tuple[str, ...], at_most: int = 6) -> str:
    rest = len(names) - at_most
    return ", ".join(names[:at_most]) + (f" and {rest} more" if rest > 0 else "")


def _plain(facts: SceneFacts) -> dict[str, Any]:
    plain = asdict(facts)
    for written, source in zip(plain["sources"], facts.sources, strict=True):
        written["mean_irradiance"] = source.mean_irradiance
    return plain
