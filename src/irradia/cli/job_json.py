"""A bake's choices as JSON and back, for whoever goes on with a bake elsewhere."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from irradia.bake.options import BakeOptions
from irradia.cli.bake_job import BakeJob
from irradia.cli.bake_views import ViewOptions
from irradia.cli.lighting import LightOptions
from irradia.core.errors import InputError
from irradia.scene.lightmap_uv.options import LayoutOptions
from irradia.scene.load import LoadOptions


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
    values = dict(plain)
    light = dict(values.pop("light"))
    light["env"] = None if light["env"] is None else Path(light["env"])
    if light.get("env_color") is not None:
        light["env_color"] = tuple(light["env_color"])
    views = values.pop("views")
    try:
        return BakeJob(
            **{
                **values,
                "scene": scene or values["scene"],
                "only": tuple(values.get("only", ())),
                "shard": tuple(values["shard"]) if values.get("shard") else None,
                "out": out,
                "load": LoadOptions(**values["load"]),
                "light": LightOptions(**light),
                "layout": LayoutOptions(**values["layout"]),
                "bake": BakeOptions(**values["bake"]),
                "views": None if views is None else ViewOptions(**views),
            }
        )
    except TypeError as error:
        raise InputError("these shards were traced by another version of Irradia") from error
