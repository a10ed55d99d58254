"""Finds out what a ``.bin`` of the Unity project leaves open, from a few places whose light is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.progress import Progress, silent_progress
from irradia.core.sh import light_on
from irradia.field import mlp
from irradia.field.bin_conventions import BinConventions, all_conventions
from irradia.field.bin_reader import encoding_of, fits, frame_of, network_of, spec_of, to_field
from irradia.field.field import Field
from irradia.field.spec import FieldSpec
from irradia.formats.field_bin import BinField, decode_field_bin

F32 = NDArray[np.float32]
MAX_SAMPLES = 512  # more tell no more
ENOUGH = 0.5  # a relative error over which nothing has been found


@dataclass(frozen=True)
class Candidate:
    """Conventions, and how well they explain the samples.

    Attributes:
        conventions: See there.
        error: Mean |prediction − sample| over mean |sample|.
    """

    conventions: BinConventions
    error: float


@dataclass(frozen=True)
class Calibration:
    """What was found.

    Attributes:
        field: By the best conventions.
        ranking: All candidates, the best first. Some may do equally well, such as those that differ only in
            a hash that no level of the file needs.
    """

    field: Field
    ranking: tuple[Candidate, ...]

    @property
    def best(self) -> Candidate:
        """Of least error."""
        return self.ranking[0]

    @property
    def is_convincing(self) -> bool:
        """Whether the samples are explained at all."""
        return self.best.error < ENOUGH


def calibrate(
    data: bytes,
    positions: F32,
    normals: F32,
    irradiance: F32,
    *,
    usual: BinConventions | None = None,
    where: str = "field",
    progress: Progress | None = None,
) -> Calibration:
    """Tries all combinations of conventions on samples.

    Args:
        data: The ``.bin``.
        positions: (N, 3) metres; up to 512 are used, evenly picked.
        normals: (N, 3) unit.
        irradiance: (N, 3) E.
        usual: For what can't be told from samples, such as the activation.
        where: The file, for errors.
        progress: Shows how far it is.

    Raises:
        InputError: The file is damaged, or there are no samples.
    """
    if len(positions) == 0 or not np.any(irradiance):
        raise InputError("expected samples that are lit, found none", where=where)
    picked = np.linspace(0, len(positions) - 1, min(len(positions), MAX_SAMPLES)).astype(int)
    positions, normals, irradiance = (
        np.asarray(a, np.float32)[picked] for a in (positions, normals, irradiance)
    )
    content = decode_field_bin(data, where)
    groups = list(all_conventions(content.header.encoding, content.n_outputs > 4, usual or BinConventions()))
    found: list[Candidate] = []
    with (progress or silent_progress()).stage("calibrate", sum(len(g) for _, g in groups), "") as stage:
        for of_encoding, choices in groups:
            spec, features = spec_of(content, of_encoding), _features(content, of_encoding, positions)
            for choice in (each for each in choices if fits(content, each)):
                predicted = _irradiance(content, spec, choice, features, normals)
                found.append(Candidate(choice, _error(predicted, irradiance)))
            stage.advance(len(choices))
    ranking = tuple(sorted(found, key=lambda candidate: candidate.error))
    return Calibration(to_field(content, ranking[0].conventions), ranking)


def _features(content: BinField, conventions: BinConventions, positions: F32) -> F32:
    encoding, table = encoding_of(content, conventions)
    return encoding.forward(frame_of(content, conventions).to_unit(positions), table)


def _irradiance(
    content: BinField, spec: FieldSpec, choice: BinConventions, features: F32, normals: F32
) -> F32:
    """As :class:`Field` does it, from features that many choices share."""
    inputs = features if spec.direction is None else np.hstack([features, normals])
    outputs, _ = mlp.forward(spec, network_of(content, choice), inputs)
    if spec.mode == "irradiance":
        return outputs
    return light_on(outputs.reshape(-1, 4, 3), normals).astype(np.float32)


def _error(predicted: F32, irradiance: F32) -> float:
    return float(np.abs(predicted - irradiance).mean() / np.abs(irradiance).mean())
