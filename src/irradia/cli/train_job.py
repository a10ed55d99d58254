"""What a training is to do, as it was asked for on the command line."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

from irradia.cli.train_spec import SpecChoices
from irradia.field.training.options import TrainOptions
from irradia.formats.samples_bin import BinOptions

Precision = Literal["fp16", "fp32"]
Finish = Literal["int8", "int4"]


@dataclass(frozen=True)
class TrainJob:
    """Everything that decides a field.

    Attributes:
        data: Samples.
        out: The field; its end chooses the format.
        choices: Which field.
        options: How it is trained.
        backend: What computes it.
        threads: Of a backend on the CPU; None takes all.
        validation: Samples to judge by; None takes those beside ``data``, if there are any.
        follow: Wait for ``data`` to appear.
        jitter_scene: Scene whose surfaces no copy may cross.
        resume: Go on from the checkpoint beside ``out``.
        finish: Quantise what was trained.
        precision: Of everything that isn't quantised.
        bin_samples: What samples don't say of themselves where they are a ``.bin``.
    """

    data: Path
    out: Path
    choices: SpecChoices = field(default_factory=SpecChoices)
    options: TrainOptions = field(default_factory=TrainOptions)
    backend: str = "auto"
    threads: int | None = None
    validation: Path | None = None
    follow: bool = False
    jitter_scene: str | None = None
    resume: bool = False
    finish: Finish | None = None
    precision: Precision = "fp16"
    bin_samples: BinOptions = field(default_factory=BinOptions)

    def beside(self, end: str) -> Path:
        """A file beside the field's, of its name with another end."""
        from irradia.field.files import FORMATS

        name = self.out.name
        stem = next((name[: -len(own)] for own in FORMATS if name.lower().endswith(own)), self.out.stem)
        return self.out.with_name(f"{stem}{end}")

    @property
    def checkpoint(self) -> Path:
        """What a stopped training goes on from."""
        return self.beside(".checkpoint.npz")

    def config(self) -> dict[str, Any]:
        """Every choice as plain values; files by their names, since folders differ between machines."""
        plain = asdict(self)
        plain["options"] = self.options.identity()
        plain["choices"]["spec_file"] = self.choices.spec_file.name if self.choices.spec_file else None
        plain["jitter_scene"] = None if self.jitter_scene is None else Path(self.jitter_scene).name
        for name in ("data", "out", "follow", "resume", "validation"):
            del plain[name]
        return plain
