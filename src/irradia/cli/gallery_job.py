"""A whole gallery: what there is to see, a picture of each, the sheet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Thread
from typing import Any, Literal
from urllib.parse import urlencode

import numpy as np

from irradia.cli.gallery_browser import BrowserError, Page, open_page
from irradia.cli.gallery_shots import Shot, damage, find_shots, remark
from irradia.cli.gallery_socket import SocketError
from irradia.cli.gallery_viewer import exposure_ev, show, viewer_picture
from irradia.cli.view_server import Library, ViewServer
from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.core.progress import Progress
from irradia.export.web_collection import WebCollection, WebScene
from irradia.export.web_folder import collect, find_fields
from irradia.export.web_viewer import Viewer, find_viewer
from irradia.report import text
from irradia.report.contact import Contact, contact_page, contact_sheet
from irradia.scene.framing import DEFAULT_ASPECT
from irradia.scene.types import Camera

# Without panels, and the light once a pixel: fields are dear to evaluate where surfaces lie behind others.
_KIOSK = {"kiosk": "1", "pass": "full"}


@dataclass(frozen=True)
class GalleryJob:
    """Everything that decides a sheet.

    Attributes:
        folder: With weights, or one file of them.
        out: A ``.png`` or an ``.html``.
        scene: A .glb or its folder; None for that in ``folder``.
        camera: As ``--camera`` names it; None for that of the first reference, else the viewer's choice.
        ev: Stops; None takes the automatic exposure of the first picture for all.
        width: Of each picture in pixels.
        renderer: What draws.
        gpu: See :func:`irradia.cli.gallery_browser.open_page`.
        timeout_s: For each picture.

    Raises:
        InputError: ``out`` is of another kind.
    """

    folder: Path
    out: Path
    scene: Path | None = None
    camera: str | None = None
    ev: float | None = None
    width: int = 480
    renderer: Literal["webgl2", "webgpu"] = "webgl2"
    gpu: bool = False
    timeout_s: float = 300.0

    def __post_init__(self) -> None:
        if self.out.suffix.lower() not in (".png", ".html"):
            raise InputError("expected a name that ends in .png or .html", where="--out")


@dataclass(frozen=True)
class Taken:
    """A picture with its exposure, or why there is none."""

    shot: Shot
    png: bytes | None = None
    ev: float | None = None
    problem: str = ""


def run_gallery(job: GalleryJob, progress: Progress) -> dict[str, Any]:
    """Takes a picture of each field and writes the sheet.

    Returns:
        What came of it, plain values.

    Raises:
        InputError: A file is wrong, there is nothing to see, or the browser or the viewer is missing.
    """
    viewer = find_viewer()
    scene = _scene(job)
    shots = find_shots(scene, with_reference=job.camera is None)
    camera = _camera(job, scene)
    aspect = DEFAULT_ASPECT if camera is None else camera.aspect
    size = job.width, max(2, 2 * round(job.width / aspect / 2))
    with progress.stage("pictures", len(shots), "pictures") as stage:
        taken: list[Taken] = []
        for one in _take_all(job, viewer, shots, _pose(job, camera), size):
            taken.append(one)
            stage.advance()
    ev = next((one.ev for one in taken if one.ev is not None), job.ev)
    _write(job, scene, taken, size, ev)
    return _record(job, taken, ev)


def describe(result: dict[str, Any]) -> str:
    """What was written, and what failed."""
    lines = [f"{result['out']}: {len(result['pictures']) - len(result['failed'])} pictures"]
    lines += [f"  {each['name']} failed: {each['error']}" for each in result["failed"]]
    return "\n".join(lines)


def _scene(job: GalleryJob) -> WebScene:
    """The scene with the fields of the folder alone, wherever the scene comes from."""
    is_folder = job.folder.is_dir()
    weights = find_fields(job.folder, deep=True) if is_folder else (job.folder,)
    scenes = collect([job.scene or job.folder], weights).scenes
    if len(scenes) != 1:
        names = ", ".join(scene.name for scene in scenes)
        raise InputError(
            f"expected one scene, found {names}", where=str(job.folder), fix="Choose one with --scene."
        )
    chosen = {path.resolve() for path in weights}
    fields = tuple(each for each in scenes[0].fields if each.file.path.resolve() in chosen)
    return replace(scenes[0], fields=fields)


def _camera(job: GalleryJob, scene: WebScene) -> Camera | None:
    """Where from, if that is known here."""
    if job.camera is None:
        return scene.references[0].camera if scene.references else None
    from irradia.scene.framing import camera_from_spec, load_camera
    from irradia.scene.load import load_scene

    if Path(job.camera).suffix.lower() == ".json":
        return load_camera(job.camera)
    return camera_from_spec(load_scene(str(scene.file.path)), job.camera)


def _pose(job: GalleryJob, camera: Camera | None) -> dict[str, str]:
    """The camera as the viewer takes it: its eye, a place that it looks at, and its field of view."""
    if job.camera is None or camera is None:
        return {"pose": "0"}
    eye, forward = camera.world_from_camera[:3, 3], -camera.world_from_camera[:3, 2]
    values = (*eye, *(eye + forward / np.linalg.norm(forward)), math.degrees(camera.yfov_rad))
    return {"camera": ",".join(f"{value:.6g}" for value in values)}


def _take_all(
    job: GalleryJob, viewer: Viewer, shots: Sequence[Shot], pose: dict[str, str], size: tuple[int, int]
) -> Iterator[Taken]:
    """The pictures, all at one exposure; after a failure the next gets a browser of its own."""
    ev, waiting = job.ev, list(shots)
    while waiting:
        with open_page(*size, gpu=job.gpu) as page:
            failed = False
            while waiting and not failed:
                shot = waiting.pop(0)
                if shot.field is not None and (problem := damage(shot.field)):
                    yield Taken(shot, problem=problem)
                    continue
                view = {**_KIOSK, "renderer": job.renderer, "left": shot.source, **pose}
                exposure = {} if ev is None else {"ev": f"{ev:.4f}"}
                with _served(viewer, shot) as url:
                    taken = _take(page, f"{url}?{urlencode(view | exposure, safe=',:')}", shot, job.timeout_s)
                failed = taken.png is None
                ev = taken.ev if ev is None else ev
                yield taken


def _take(page: Page, url: str, shot: Shot, timeout_s: float) -> Taken:
    """One picture, or why there is none."""
    try:
        show(page, url, timeout_s)
        return Taken(shot, viewer_picture(page, timeout_s), exposure_ev(page))
    except (BrowserError, SocketError) as error:
        return Taken(shot, problem=str(error))


@contextmanager
def _served(viewer: Viewer, shot: Shot) -> Iterator[str]:
    """Serves one picture's files; gives the page's address."""
    server = ViewServer(Library(viewer, lambda: WebCollection(shot.scene.name, (shot.scene,))))
    thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
    thread.start()
    try:
        yield server.url
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def _write(
    job: GalleryJob, scene: WebScene, taken: Sequence[Taken], size: tuple[int, int], ev: float | None
) -> None:
    contacts = [Contact(one.shot.name, one.problem or remark(one.shot), one.png) for one in taken]
    exposure = "" if ev is None else f", exposure {text.stops(ev)}"
    subtitle = f"{len(contacts)} pictures from one camera{exposure}, drawn by {job.renderer}"
    if job.out.suffix.lower() == ".html":
        data = contact_page(scene.name, subtitle, contacts).encode("utf-8")
    else:
        data = contact_sheet(scene.name, subtitle, contacts, size)
    with write_atomic(job.out) as stream:
        stream.write(data)


def _record(job: GalleryJob, taken: Sequence[Taken], ev: float | None) -> dict[str, Any]:
    pictures = [
        {
            "name": one.shot.name,
            "source": one.shot.source,
            "file": str(one.shot.field.file.path) if one.shot.field else None,
            "error": one.problem or None,
        }
        for one in taken
    ]
    return {
        "out": str(job.out),
        "exposure_ev": ev,
        "renderer": job.renderer,
        "pictures": pictures,
        "failed": [each for each in pictures if each["error"]],
    }
