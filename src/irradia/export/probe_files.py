"""Probes beside a baked scene: one file for each kind of reader."""

from __future__ import annotations

from pathlib import Path

from irradia.formats.probes import VALID, ProbeGrid, ProbeSet, write_probes
from irradia.formats.probes_bin import write_probes_bin
from irradia.formats.probes_three import write_three_grid


def write_probe_files(folder: Path | str, probes: ProbeSet) -> tuple[Path, ...]:
    """Writes ``probes.npz`` and ``probes.bin``, and for a grid ``probes.three.json``; returns their paths.

    The ``.bin`` trains fields, so probes inside walls are left out of it.
    """
    target = Path(folder)
    npz, binary, three = (target / name for name in ("probes.npz", "probes.bin", "probes.three.json"))
    write_probes(npz, probes)
    valid = probes.state == VALID
    write_probes_bin(binary, probes.places[valid], probes.coefficients[valid])
    if not isinstance(probes.structure, ProbeGrid):
        return npz, binary
    write_three_grid(three, probes)
    return npz, binary, three
