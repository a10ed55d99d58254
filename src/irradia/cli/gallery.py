"""``irradia gallery``: every field of a folder from the same camera, side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from irradia.cli import options
from irradia.cli.output import finish


@click.command("gallery")
@click.argument("folder", type=click.Path(exists=True, path_type=Path), metavar="DIR")
@click.option(
    "-o",
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    required=True,
    help="The sheet: a .png, or an .html.",
)
@click.option(
    "--scene",
    type=click.Path(exists=True, path_type=Path),
    help="A scene.baked.glb or its folder.  [default: that in DIR]",
)
@click.option(
    "--camera", help="Index or name in the scene, a saved .json, or auto.  [default: the reference's]"
)
@click.option("--ev", type=options.Finite(), help="Exposure in stops.  [default: the first picture's]")
@click.option(
    "--width",
    type=options.Whole(64, 4096),
    default=480,
    metavar="PIXELS",
    show_default=True,
    help="Of each picture.",
)
@click.option(
    "--renderer",
    type=click.Choice(["webgl2", "webgpu"]),
    default="webgl2",
    show_default=True,
    help="What draws.",
)
@click.option("--gpu", is_flag=True, help="Draw with this machine's GPU.  [default: alike everywhere]")
@click.option(
    "--timeout",
    "timeout_s",
    type=options.Finite(0.0, low_open=True),
    default=300.0,
    show_default=True,
    metavar="SECONDS",
    help="For each picture.",
)
@options.json_option
def command(as_json: bool, **choices: Any) -> int:
    """Show every field of a folder from the same camera, side by side.

    DIR holds weights: .safetensors, .safetensors.zst and .bin. The viewer draws each in a Chromium without
    a window; reference and lightmap come first where the scene has them.
    """
    from irradia.cli.gallery_job import GalleryJob, describe, run_gallery
    from irradia.core.progress import stderr_progress

    result = run_gallery(GalleryJob(**choices), stderr_progress())
    return finish(as_json, result, describe(result), 2 if result["failed"] else 0)
