"""What an evaluation is asked to do."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from irradia.cli.eval import BASELINES
from irradia.cli.lighting import LightOptions
from irradia.cli.origin import scene_config
from irradia.core.device import DeviceChoice
from irradia.core.errors import InputError
from irradia.formats.samples_bin import BinOptions
from irradia.scene.load import LoadOptions


@dataclass(frozen=True)
class PictureOptions:
    """Pictures.

    Attributes:
        cameras: As ``--camera`` names them; none for all of the scene's, or one that frames it.
        reference_spp: Samples per pixel of the references, two halves together.
        spp: Of what is judged: it smooths edges, and the noise of lights that are lit live, of which each
            sample asks one.
        n_pixels: About how many each picture has; its shape is the camera's.
        exposure_ev: Stops; None for automatic exposure of each reference.
    """

    cameras: tuple[str, ...] = ()
    reference_spp: int = 512
    spp: int = 16
    n_pixels: int = 640 * 360
    exposure_ev: float | None = None


@dataclass(frozen=True)
class SpaceOptions:
    """Places in space.

    Attributes:
        samples: A dataset to judge by; None draws places of its own.
        count: How many are drawn, half of them within 5 cm of surfaces.
        rays: Per place, a multiple of 4.
        bin_samples: What ``samples`` don't say of themselves where they are a ``.bin``.

    Raises:
        InputError: ``rays`` is no multiple of 4.
    """

    samples: Path | None = None
    count: int = 16_384
    rays: int = 1024
    bin_samples: BinOptions = field(default_factory=BinOptions)

    def __post_init__(self) -> None:
        if self.rays < 4 or self.rays % 4:
            raise InputError(
                f"expected a multiple of 4, found {self.rays}",
                where="--rays",
                fix="Their noise is told from four quarters.",
            )


@dataclass(frozen=True)
class EvalJob:
    """Everything that decides an evaluation.

    Attributes:
        weights: The field's file.
        scene: A file or ``builtin:NAME``.
        out: Folder for the results.
        overrides, ies: As in :class:`irradia.cli.bake_job.BakeJob`.
        baselines: Names of BASELINES.
        force: Judges a field also where it was trained in another scene or light.
        seed: Root of all random numbers.
    """

    weights: Path
    scene: str
    out: Path
    load: LoadOptions = field(default_factory=LoadOptions)
    light: LightOptions = field(default_factory=LightOptions)
    overrides: tuple[str, ...] = ()
    ies: tuple[str, ...] = ()
    pictures: PictureOptions = field(default_factory=PictureOptions)
    space: SpaceOptions = field(default_factory=SpaceOptions)
    baselines: tuple[str, ...] = BASELINES
    seed: int = 0
    device: DeviceChoice = "auto"
    threads: int | None = None
    force: bool = False

    def config(self) -> dict[str, Any]:
        """Every choice as plain values; files by their names, since folders differ between machines."""
        plain = asdict(self) | scene_config(self)
        del plain["out"]
        plain["weights"] = self.weights.name
        plain["space"]["samples"] = self.space.samples.name if self.space.samples else None
        return plain
