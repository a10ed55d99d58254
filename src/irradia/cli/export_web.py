"""``irradia export --web`` and ``--single-file``: a scene with the viewer, to be put online or sent."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from irradia.core.errors import InputError
from irradia.core.progress import Progress

if TYPE_CHECKING:
    from irradia.export.web_collection import WebCollection

_OURS = {"source", "web", "single_file", "fields", "as_json"}


def refuse_others(context: click.Context) -> None:
    """Refuses options of ``irradia export`` that have no meaning for the web.

    Raises:
        click.UsageError: There is one.
    """
    given = [
        parameter.opts[-1]
        for parameter in context.command.params
        if parameter.name not in _OURS
        and context.get_parameter_source(str(parameter.name)) == ParameterSource.COMMANDLINE
    ]
    if given:
        raise click.UsageError(f"{given[0]} doesn't go with --web and --single-file.", context)


def run_web_export(
    source: Path, fields: Sequence[Path], web: Path | None, single_file: Path | None, progress: Progress
) -> dict[str, Any]:
    """Writes a site, a single file, or both.

    Args:
        source: A .glb, or a folder of results.
        fields: Further weights.
        web: Folder of the site.
        single_file: An .html.
        progress: Shows stages.

    Returns:
        What was written, plain values.

    Raises:
        InputError: A file is wrong, or the viewer isn't built.
    """
    from irradia.export.web_folder import collect
    from irradia.export.web_single import write_single_file
    from irradia.export.web_site import write_site
    from irradia.export.web_viewer import find_viewer

    if single_file is not None and single_file.suffix.lower() not in (".html", ".htm"):
        raise InputError("expected a name that ends in .html", where="--single-file")
    viewer = find_viewer()
    collection = collect([source], fields)
    _check_light(collection)
    result: dict[str, Any] = {"scenes": [scene.name for scene in collection.scenes]}
    if web is not None:
        with progress.stage("site"):
            files = write_site(web, viewer, collection)
        n_bytes = sum((web / name).stat().st_size for name in files)
        result["web"] = {"out": str(web), "bytes": n_bytes, "files": files}
    if single_file is not None:
        with progress.stage("single file"):
            n_bytes = write_single_file(single_file, viewer, collection)
        result["single_file"] = {"out": str(single_file), "bytes": n_bytes}
    return result


def describe(result: dict[str, Any]) -> str:
    """What was written, and how to see it."""
    lines = []
    if "web" in result:
        made = result["web"]
        lines += [
            f"{made['out']}: {len(made['files'])} files, {made['bytes']:,} bytes, for any static host",
            f"  try it: python3 -m http.server --bind 127.0.0.1 --directory {made['out']}",
        ]
    if "single_file" in result:
        made = result["single_file"]
        lines.append(f"{made['out']}: {made['bytes']:,} bytes; open it in a browser")
    return "\n".join(lines)


def _check_light(collection: WebCollection) -> None:
    """Refuses scenes that would be shown dark."""
    from irradia.export.field_extension import read_baked_document

    for scene in collection.scenes:
        if not scene.fields:
            read_baked_document(scene.file.path)
