"""A bake's choices as JSON and back, for whoever goes on with a bake elsewhere."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

from irradia.bake.occlusion import OcclusionOptions
from irradia.bake.options import BakeOptions
from irradia.bake.probes.options import ProbeOptions
from irradia.cli.bake_job import BakeJob
from irradia.cli.bake_views import ViewOptions
from irradia.cli.field_job import FieldOptions
from irradia.cli.lighting import LightOptions
from irradia.core.errors import InputError
from irradia.scene.lightmap_uv.options import LayoutOptions
from irradia.scene.load import LoadOptions

T = TypeVar("T")
_LISTS = ("only", "overrides", "ies", "formats")


def job_to_json(job: BakeJob) -> dict[str, Any]:
    """Plain values; files as they were named on the command line."""
    plain = asdict(job)
    plain["light"]["env"] = None if job.light.env is None else str(job.light.env)
    del plain["out"]
    return plain


def job_from_json(plain: dict[str, Any], out: Path, scene: str | None = None) -> BakeJob:
    """The job again.

    Args:
        plain: From :func:`job_to_json`.
        out: Folder for the results.
        scene: Where the scene is on this machine, if elsewhere than it was.

    Raises:
        InputError: The values are of another version.
    """
    try:
        values = dict(plain)
        light = dict(values["light"])
        light["env"] = None if light["env"] is None else Path(light["env"])
        light["env_color"] = None if light["env_color"] is None else tuple(light["env_color"])
        return BakeJob(
            **{
                **values,
                **{name: tuple(values[name]) for name in _LISTS},
                "scene": scene or values["scene"],
                "shard": None if values["shard"] is None else tuple(values["shard"]),
                "out": out,
                "load": LoadOptions(**values["load"]),
                "light": LightOptions(**light),
                "layout": LayoutOptions(**values["layout"]),
                "bake": BakeOptions(**values["bake"]),
                "views": _maybe(ViewOptions, values["views"]),
                "probes": _maybe(ProbeOptions, values["probes"]),
                "occlusion": _maybe(OcclusionOptions, values["occlusion"]),
                "neural_field": _maybe(FieldOptions, values["neural_field"]),
            }
        )
    except (TypeError, KeyError, ValueError) as error:
        raise InputError("these shards were traced by another version of Irradia") from error


def _maybe(options: type[T], values: dict[str, Any] | None) -> T | None:
    return None if values is None else options(**values)
