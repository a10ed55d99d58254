"""The table of a sweep: one row a run, as CSV and as Parquet."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from irradia.cli.sweep_grid import SweepRun
from irradia.core.errors import MissingDependencyError
from irradia.core.files import write_atomic, write_text_atomic

Row = dict[str, Any]

CSV, PARQUET = "sweep.csv", "sweep.parquet"
_VALIDATION = ("relmse", "psnr_db", "mae", "mean_ratio", "under_noise")
_RESULT = ("bytes", "parameters", "train_s", "samples_per_s", "steps", "loss")
_QUERY = ("flops", "encoding_bytes", "queries_per_s", "flip")
FIXED = ("name", "status", *_VALIDATION, *_RESULT, *_QUERY)
_TEXT = {"name", "status", "error"}


def check_parquet() -> None:
    """Fails before anything is trained where Parquet can't be written.

    Raises:
        MissingDependencyError: pyarrow is absent.
    """
    if find_spec("pyarrow") is None:
        raise MissingDependencyError(
            "tables of sweeps are Parquet, which needs pyarrow", fix="pip install 'irradia[sweep]'"
        )


def make_row(run: SweepRun, result: Mapping[str, Any], cost: Mapping[str, Any]) -> Row:
    """One run: what was chosen, what came of it, what a query costs; absent values are None."""
    validation = result.get("validation") or {}
    row: Row = {"name": run.name, "status": "done" if result.get("ok") else "failed"}
    row.update({name: validation.get(name) for name in _VALIDATION})
    row.update({name: result.get(name) for name in _RESULT})
    row.update({name: cost.get(name) for name in _QUERY})
    row.update({f"option.{name}": value for name, value in run.choices.items()})
    row["error"] = result.get("error")
    return row


def write_tables(folder: Path, rows: Sequence[Row]) -> None:
    """Writes both files, each whole or not at all."""
    columns = _columns(rows)
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_text_atomic(folder / CSV, text.getvalue())
    _write_parquet(folder / PARQUET, rows, columns)


def _columns(rows: Sequence[Row]) -> list[str]:
    options = {name for row in rows for name in row if name.startswith("option.")}
    return [*FIXED, *sorted(options), "error"]


def _write_parquet(path: Path, rows: Sequence[Row], columns: Sequence[str]) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    arrays = {name: _column(name, [row.get(name) for row in rows]) for name in columns}
    with write_atomic(path) as stream:
        parquet.write_table(pa.table(arrays), stream)


def _column(name: str, values: list[Any]) -> Any:
    """A column of one type: options may be numbers in one grid and words in another."""
    import pyarrow as pa

    kinds = {type(value) for value in values if value is not None}
    if name in _TEXT or str in kinds or (bool in kinds and len(kinds) > 1):
        return pa.array([None if v is None else str(v) for v in values], pa.string())
    if kinds == {bool}:
        return pa.array(values, pa.bool_())
    if kinds == {int}:
        return pa.array(values, pa.int64())
    return pa.array([None if v is None else float(v) for v in values], pa.float64())
