"""How near each directional mode comes to a path-traced, normal-mapped wall.

    python bench/directional.py [--density 16 32 64] [--samples 512] [--reference-samples 1024]

A wall whose stones exist only in its normal map stands between a lamp, the sun and a coloured
neighbour. It is baked with every mode, relit at each pixel of a head-on picture with the normal that the
map shows there, and compared with E/π path-traced at that pixel for that normal. "plain" is what a
lightmap without directions shows; "normal maps" the plain map baked with `--normal-maps`; "sh, linear" the
maps of ``sh`` read as ordinary L1 SH. Maps are denoised and filtered as always. Nothing is timed here.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np
from numpy.typing import NDArray

from irradia.bake.directional_modes import MODES, SurfaceFrame, sh_linear
from irradia.bake.lightmap import BakeOptions, LightmapResult, bake_lightmap
from irradia.core import Progress, silent_progress, write_text_atomic
from irradia.core.colour import automatic_exposure_ev, picture_srgb8
from irradia.core.progress import stderr_progress
from irradia.core.provenance import source_commit
from irradia.formats.png import write_png
from irradia.metrics import flip, flip_exposures, relmse_without_reference_noise
from irradia.scene.layout import LightmapLayout
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
from irradia.scene.types import Scene
from irradia.transport import use_device
from support.normal_mapped_wall import wall_scene

RESULTS = Path(__file__).parent / "results"
SHOWN = ("plain", "dominant", "rnm", "mono-sh", "sh", "reference")


@dataclass(frozen=True)
class Row:
    """One way of relighting at one density.

    Attributes:
        flip: Mean HDR-FLIP.
        relmse: Noise of the reference taken out.
        mean_ratio: To the reference.
        least: The smallest E/π of all pixels and colours.
        maps: Three-channel maps read for it.
    """

    density: float
    name: str
    maps: int
    flip: float
    relmse: float
    mean_ratio: float
    least: float


def main() -> None:
    """Bakes, relights, compares, writes."""
    arguments = _parse()
    use_device("cpu", None)
    from support.wall_view import WallTruth

    progress = stderr_progress()
    scene = wall_scene()
    rows: list[Row] = []
    pictures: dict[str, NDArray] = {}
    for density in arguments.density:
        layout = layout_lightmap(scene, LayoutOptions(texels_per_metre=density), silent_progress())
        truth = WallTruth(scene, layout, arguments.height)
        if not pictures:
            progress.say("reference")
            halves = [truth.trace(arguments.reference_samples, seed) for seed in (1, 2)]
            pictures["reference"] = truth.view.picture(0.5 * (halves[0] + halves[1]))
        relit = _relight_all(scene, layout, truth, arguments.samples, progress)
        for name, values in relit.items():
            rows.append(
                _row(density, name, values, truth.view.picture(values), halves, pictures["reference"])
            )
        if density == arguments.density[0]:
            pictures |= {name: truth.view.picture(values) for name, values in relit.items()}
    _write_picture(pictures)
    text = _markdown(rows, arguments)
    write_text_atomic(RESULTS / "directional.md", text)
    print(text)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--density", nargs="+", type=float, default=[16.0, 32.0, 64.0], help="texels a metre")
    parser.add_argument("--samples", type=int, default=512, help="of the bakes, a texel")
    parser.add_argument("--reference-samples", type=int, default=1024, help="of each of two halves, a pixel")
    parser.add_argument("--height", type=int, default=180, help="of the picture, in pixels")
    return parser.parse_args()


def _relight_all(
    scene: Scene, layout: LightmapLayout, truth, samples: int, progress: Progress
) -> dict[str, NDArray]:
    """(N, 3) E/π at the pixels by each way of relighting."""
    view = truth.view
    surface = SurfaceFrame(*(v.astype(np.float64) for v in (view.surface, view.tangent, view.bitangent)))
    normal = view.normal.astype(np.float64)
    plain = _bake(scene, layout, samples, progress)
    relit = {"plain": view.sampled(plain.pages)}
    bent = _bake(scene, layout, samples, progress, normal_maps=True)
    relit["normal maps"] = view.sampled(bent.pages)
    for name, mode in MODES.items():
        baked = _bake(scene, layout, samples, progress, directional=name)
        own = view.sampled(baked.pages)
        maps = {key: view.sampled(pages) for key, pages in baked.directional.pages.items()}
        relit[name] = mode.irradiance_over_pi(own, maps, normal, surface)
        if name == "sh":
            relit["sh, linear"] = sh_linear(maps, normal)
    return relit


def _bake(
    scene: Scene, layout: LightmapLayout, samples: int, progress: Progress, **choices: object
) -> LightmapResult:
    progress.say(", ".join(f"{key} {value}" for key, value in choices.items()) or "plain")
    return bake_lightmap(scene, layout, BakeOptions(samples=samples, seed=3, **choices), progress)  # type: ignore[arg-type]


def _row(
    density: float, name: str, values: NDArray, picture: NDArray, halves: list[NDArray], reference: NDArray
) -> Row:
    mode = MODES.get("sh" if name == "sh, linear" else name)  # type: ignore[call-overload]
    reads_plain = name in ("plain", "normal maps", "dominant")
    return Row(
        density=density,
        name=name,
        maps=(len(mode.maps) if mode else 0) + reads_plain,
        flip=flip(picture, reference, flip_exposures(reference)).mean,
        relmse=relmse_without_reference_noise(values, halves[0], halves[1]),
        mean_ratio=float(values.mean() / reference.mean()),
        least=float(values.min()),
    )


def _write_picture(pictures: dict[str, NDArray]) -> None:
    """All ways beside one another, exposed alike, the reference last."""
    exposure = automatic_exposure_ev(pictures["reference"])
    columns = [picture_srgb8(pictures[name], exposure) for name in SHOWN]
    rows = [np.concatenate(columns[k : k + 3], axis=1) for k in (0, 3)]
    write_png(RESULTS / "directional.png", np.concatenate(rows))


def _markdown(rows: list[Row], arguments: argparse.Namespace) -> str:
    lines = [
        "# Directional maps against a path-traced, normal-mapped wall",
        "",
        "![plain, dominant, rnm; mono-sh, sh, reference](directional.png)",
        "",
        f"From the top left: {', '.join(SHOWN)}; at {arguments.density[0]:g} texels a metre.",
        "",
        "| texels a metre | relit by | maps read | HDR-FLIP | relMSE | mean ratio | least E/π |",
        "|---|---|---|---|---|---|---|",
        *(
            f"| {r.density:g} | {r.name} | {r.maps} | {r.flip:.4f} | {r.relmse:.2e} | {r.mean_ratio:.3f} "
            f"| {r.least:.2e} |"
            for r in rows
        ),
        "",
        "relMSE has the reference's noise taken out. A map has three channels.",
        "",
        f"`python bench/directional.py --density {' '.join(f'{d:g}' for d in arguments.density)} "
        f"--samples {arguments.samples} --reference-samples {arguments.reference_samples} "
        f"--height {arguments.height}`, commit {source_commit() or 'unknown'}.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
