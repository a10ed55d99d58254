"""A training's log: a table of what was learned when, as CSV."""

from __future__ import annotations

import csv
import io
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path

from irradia.core.errors import InputError
from irradia.core.files import write_text_atomic
from irradia.field.training.events import Stepped, SteppedBack, TrainEvent, Validated
from irradia.field.training.figures import Figures

N_ROWS = 200  # of losses over a training, about


@dataclass(frozen=True)
class LogRow:
    """One line.

    Attributes:
        step: Steps done.
        seconds: Of training.
        samples: Seen.
        loss: Mean since the row before.
        psnr_db, relmse, mean_ratio, mae: Of validation, where there was one.
        rate_factor: What setbacks have left of the learning rates.
    """

    step: int
    seconds: float
    samples: int
    loss: float
    psnr_db: float | None = None
    relmse: float | None = None
    mean_ratio: float | None = None
    mae: float | None = None
    rate_factor: float = 1.0


COLUMNS = tuple(field.name for field in fields(LogRow))
_FIGURES = ("psnr_db", "relmse", "mean_ratio", "mae")


class TrainingLog:
    """Gathers rows from events.

    Args:
        rows: Of an earlier part of the same training.
    """

    def __init__(self, rows: list[LogRow] | None = None) -> None:
        self.rows = rows or []
        self._rate_factor = self.rows[-1].rate_factor if self.rows else 1.0
        self._losses: list[float] = []
        self._last: Stepped | None = None
        self._next = 0.0  # progress at which the next row is due

    def take(self, event: TrainEvent) -> None:
        """Notes what is worth a row."""
        if isinstance(event, Stepped):
            self._losses.append(event.loss)
            self._last = event
            if event.progress >= self._next:
                self._next = event.progress + 1.0 / N_ROWS
                self._add()
        elif isinstance(event, Validated) and self._last is not None:
            self._add(event.figures)
        elif isinstance(event, SteppedBack):
            self.rows = [row for row in self.rows if row.step <= event.to_step]
            self._losses, self._rate_factor = [], event.rate_factor
            self._last = None  # its row is gone, and the state gone back to has been judged

    def _add(self, figures: Figures | None = None) -> None:
        last = self._last
        if last is None:
            return
        if self._losses:
            loss = sum(self._losses) / len(self._losses)
        else:  # a validation right after a row: it takes that row's place
            loss = self.rows.pop().loss
        row = LogRow(last.step, round(last.spent_s, 3), last.samples, loss, rate_factor=self._rate_factor)
        if figures is not None:
            row = replace(row, **{name: getattr(figures, name) for name in _FIGURES})
        self.rows.append(row)
        self._losses = []


def write_log(path: Path, rows: list[LogRow]) -> None:
    """Writes rows as CSV with a line of names; what isn't known is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(["" if value is None else value for value in astuple(row)] for row in rows)
    write_text_atomic(path, text.getvalue())


def read_log(path: Path, up_to_step: int) -> list[LogRow]:
    """Rows of a log up to a step; none where there is no log.

    Raises:
        InputError: It isn't one.
    """
    if not path.exists():
        return []
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            lines = [_row(line) for line in csv.DictReader(stream)]
    except (ValueError, KeyError, TypeError) as error:
        raise InputError("expected the log of a training", where=str(path), fix="Move it away.") from error
    return [row for row in lines if row.step <= up_to_step]


def _row(line: dict[str, str]) -> LogRow:
    figures = {name: float(line[name]) if line[name] else None for name in _FIGURES}
    return LogRow(
        int(line["step"]),
        float(line["seconds"]),
        int(line["samples"]),
        float(line["loss"]),
        **figures,
        rate_factor=float(line["rate_factor"]),
    )
