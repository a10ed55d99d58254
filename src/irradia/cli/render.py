"""``irradia render``: a path-traced image of a scene or of a baked result."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from irradia.cli import options
from irradia.cli.output import finish

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from irradia.cli.lighting import LightOptions
    from irradia.core.progress import Progress
    from irradia.scene.load import LoadOptions
    from irradia.scene.types import Scene
    from irradia.transport.render import BakedLight

FORMATS = (".exr", ".hdr", ".png")
MAX_EDGE_PX = 16384
MAX_SPP = 1 << 20


@click.command("render")
@click.argument("scene")
@click.option("-o", "--out", type=click.Path(dir_okay=False, path_type=Path), required=True)
@click.option("--camera", metavar="CAMERA", help="Index, name, saved .json, or auto.  [default: the first]")
@click.option("--save-camera", type=click.Path(dir_okay=False, path_type=Path), help="Write it as .json.")
@click.option("--width", type=click.IntRange(1, MAX_EDGE_PX), default=1280, show_default=True)
@click.option("--height", type=click.IntRange(1, MAX_EDGE_PX), default=720, show_default=True)
@click.option(
    "--spp", type=click.IntRange(1, MAX_SPP), default=64, show_default=True, help="Samples per pixel."
)
@click.option(
    "--transport",
    type=click.Choice(["diffuse", "full"]),
    default="diffuse",
    show_default=True,
    help="Diffuse, as bakes are judged, or full materials.",
)
@click.option("--baked", is_flag=True, help="Show the plain lightmap inside SCENE instead of tracing light.")
@click.option("--exposure", type=options.ANY, metavar="EV", help="Stops, for .png.  [default: automatic]")
@options.lighting_options
@options.scene_options
@click.option("--fast-rays", is_flag=True, help="Faster intersection that may miss edges.")
@options.seed_option
@options.device_option
@options.threads_option
@options.json_option
def command(as_json: bool, scene: str, out: Path, baked: bool, **choices: Any) -> None:
    """Path-trace an image of a scene or of a baked result.

    SCENE is a .gltf, a .glb, or builtin:NAME; with --baked, a scene.baked.glb.
    The image is linear radiance as .exr or .hdr, or a picture at an exposure as .png.
    """
    from irradia.core.errors import InputError
    from irradia.core.progress import stderr_progress

    if out.suffix.lower() not in FORMATS:
        raise InputError(
            f"expected an image ending in {', '.join(FORMATS)}, found {out.suffix!r}", where=str(out)
        )
    if baked and choices["transport"] == "full":
        raise InputError("a lightmap holds diffuse light only", where="--transport full --baked")
    start = time.perf_counter()
    progress = stderr_progress()
    image = _render(scene, baked, choices, progress)
    exposure_ev = write_image(out, image, choices["exposure"])
    result = {
        "out": str(out),
        "width_px": image.shape[1],
        "height_px": image.shape[0],
        "spp": choices["spp"],
        "exposure_ev": exposure_ev,
        "mean_radiance": [float(v) for v in image.mean(axis=(0, 1), dtype="float64")],
        "stage_s": progress.seconds,
        "wall_s": time.perf_counter() - start,
    }
    finish(as_json, result, f"{out}, {image.shape[1]} × {image.shape[0]}, exposure {exposure_ev:+.1f} EV")


def write_image(out: Path, image: NDArray[np.float32], exposure_ev: float | None) -> float:
    """Writes linear radiance, or a picture of it; returns the exposure, automatic where None is given."""
    from irradia.core.colour import automatic_exposure_ev, picture_srgb8

    exposure = automatic_exposure_ev(image) if exposure_ev is None else exposure_ev
    suffix = out.suffix.lower()
    if suffix == ".exr":
        from irradia.formats.exr import write_exr_rgb

        write_exr_rgb(out, image, {"irradia:quantity": "radiance", "irradia:exposure": exposure})
    elif suffix == ".hdr":
        from irradia.formats.hdr import write_hdr

        write_hdr(out, image)
    else:
        from irradia.formats.png import write_png

        write_png(out, picture_srgb8(image, exposure))
    return exposure


def _render(scene_spec: str, baked: bool, choices: dict[str, Any], progress: Progress) -> NDArray[np.float32]:
    from irradia.cli.bake_job import open_scene
    from irradia.scene.framing import camera_from_spec, save_camera
    from irradia.scene.load import LoadOptions
    from irradia.transport import use_device

    use_device(choices["device"], choices["threads"])
    light = options.light_options(**{name: choices[name] for name in options.LIGHT_NAMES})
    load = LoadOptions(pose_time=choices["pose_time"], variant=choices["variant"])
    if baked:
        scene, lightmap = _open_baked(scene_spec, load, light, progress)
    else:
        scene, lightmap = open_scene(scene_spec, load, light, progress), None
    camera = camera_from_spec(scene, choices["camera"], choices["width"] / choices["height"])
    if choices["save_camera"]:
        save_camera(camera, choices["save_camera"])
    from irradia.transport.render import RenderOptions, render

    how = RenderOptions(
        width=choices["width"],
        height=choices["height"],
        spp=choices["spp"],
        transport=choices["transport"],
        seed=choices["seed"],
        fast_rays=choices["fast_rays"],
    )
    return render(scene, camera, how, lightmap=lightmap, progress=progress)


def _open_baked(
    spec: str, load: LoadOptions, light: LightOptions, progress: Progress
) -> tuple[Scene, BakedLight]:
    """A baked .glb; the surroundings are seen behind it, but light nothing that has a lightmap."""
    from irradia.cli.lighting import light_scene
    from irradia.export.read_baked import read_baked
    from irradia.transport.render import BakedLight

    baked = read_baked(spec, load)
    if baked.directional is not None:
        progress.say(
            f"note: the image shows the plain lightmap on smooth normals; the {baked.directional.mode} maps "
            "inside are for normal maps at run time"
        )
    surroundings = replace(light, default_light=False)
    return light_scene(baked.scene, surroundings), BakedLight(baked.layout, baked.pages)
