"""Fields of indirect light with a baked direct map are as near to the truth in browsers as in Python."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from irradia.bake.datasets.setting import in_quantity
from irradia.cli import app
from irradia.cli.bake_job import open_scene
from irradia.cli.eval_job import evaluate
from irradia.cli.eval_options import EvalJob, PictureOptions, SpaceOptions
from irradia.cli.eval_reference import Reference
from irradia.core.progress import Progress
from irradia.field.evaluation import score_picture
from irradia.field.files import read_field
from irradia.scene.types import Camera
from irradia.transport.gbuffer import pixels_of_scene
from irradia.transport.render import RenderOptions

from .pixels import BACKENDS, ask, view_of
from .studio import write_studio

WIDTH_PX, HEIGHT_PX = 96, 54
SIDE = 4  # samples of a pixel along each of its sides
CLOSE = 0.005
TABLES = ["--n-levels", "4", "--log2-hashmap-size", "9", "--base-resolution", "3", "--max-resolution", "16"]
LEARNING = ["--steps", "400", "--batch-size", "8192", "--hidden-dim", "16"]


@dataclass(frozen=True)
class Studio:
    """Its files, and what the evaluation found."""

    scene: Path
    weights: Path
    camera: Camera
    reference: Reference
    seen: NDArray[np.bool_]
    flip: float


@pytest.fixture(scope="module")
def studio(tmp_path_factory) -> Studio:
    """Baked with a direct map, and learnt by a small field."""
    folder = tmp_path_factory.mktemp("studio")
    source, bake, samples, weights = (
        folder / name for name in ("studio.gltf", "scene", "light.samples", "field.safetensors")
    )
    write_studio(source)
    run("bake", source, "-o", bake, "--direct-map", "--resolution", 512, "--samples", 32, "--no-report")
    given = ["--quantity", "indirect", "--count", 50_000, "--samples", 32, "--validation", 0]
    run("sample", source, "-o", samples, *given, "--lightmap", bake)
    run("train", samples, "-o", weights, *TABLES, *LEARNING)

    pictures = PictureOptions(reference_spp=256, spp=SIDE * SIDE, n_pixels=WIDTH_PX * HEIGHT_PX)
    space = SpaceOptions(count=0)
    job = EvalJob(weights, str(source), folder, pictures=pictures, space=space, baselines=())
    scene = open_scene(job.scene, job.load, job.light, Progress())
    stored = read_field(weights)
    found = evaluate(job, in_quantity(scene, stored.field.frame.quantity), stored, Progress())
    seen = pixels_of_scene(scene, scene.cameras[0], RenderOptions(WIDTH_PX, HEIGHT_PX, 1))
    flip = found.rivals[0].views[0].scores.flip.value
    return Studio(bake / "scene.baked.glb", weights, scene.cameras[0], found.references[0], seen, flip)


def run(*words: object) -> None:
    assert app.run([str(word) for word in words]) == 0


@pytest.mark.parametrize("backend", BACKENDS)
def test_flip_against_the_reference_is_that_of_the_evaluation(
    studio: Studio, web_check, chromium: str, tmp_path: Path, backend: str
) -> None:
    request = {
        "backend": backend,
        "scene": "/scene.glb",
        "view": view_of(studio.camera, SIDE * WIDTH_PX, SIDE * HEIGHT_PX),
        "channels": [],
        "fields": {"mine": "/field"},
        "pictures": {"mine": {"source": "mine", "how": "full"}},
    }
    files = {"/scene.glb": studio.scene, "/field": studio.weights}
    (answer,) = ask(web_check, chromium, tmp_path, [request], files)
    assert answer.backend == backend
    drawn = means(answer.pictures["mine"][..., :3])
    scores = score_picture(drawn, studio.reference.first, studio.reference.second, studio.seen)
    assert studio.flip > 2 * CLOSE  # a field that learns little is told from the truth
    assert abs(scores.flip.value - studio.flip) <= CLOSE


def means(picture: NDArray[np.float64]) -> NDArray[np.float32]:
    """(H, W, 3) of the samples of each pixel."""
    samples = picture.reshape(HEIGHT_PX, SIDE, WIDTH_PX, SIDE, 3)
    return samples.mean(axis=(1, 3)).astype(np.float32)
