"""Probes that hold numbers of no meaning, exact on every machine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irradia.formats.probes import NO_PROBE, ProbeGrid, ProbeOctree, ProbeSet


def exact(*shape: int) -> np.ndarray:
    """Numbers of no pattern between −0.75 and 0.82 that are the same on every machine."""
    return (((np.arange(np.prod(shape)) * 37 + 11) % 101).reshape(shape) / 64 - 0.75).astype(np.float32)


def made(n: int = 12, **changes: object) -> ProbeSet:
    probes = ProbeSet(
        positions=exact(n, 3),
        offsets=exact(n, 3) / 8,
        coefficients=exact(n, 9, 3),
        validity=np.abs(exact(n)) / 2,
        state=(np.arange(n) % 3).astype(np.uint8),
        sky=exact(n, 4),
        distance=np.abs(exact(n, 4, 4, 2)),
        reach=np.abs(exact(n)) + 1,
        light="indirect",
        structure=ProbeGrid(np.float32([1, 2, 3]), np.float32([0.5, 0.5, 0.25]), (2, 3, 2)),
        provenance={"seed": 7},
    )
    return replace(probes, **changes)  # type: ignore[arg-type]


OCTREE = ProbeOctree(
    np.float32([0, 1, 2]),
    2.0,
    np.array([(0, 0, 0, 0), (2, 0, 1, 1)], np.int32),
    np.array([range(8), [NO_PROBE, *range(4, 11)]], np.uint32),
)
