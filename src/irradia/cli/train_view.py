"""Shows a training's events as progress."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from typing import Any

from irradia.core.interrupt import asks_first
from irradia.core.progress import Progress, Stage
from irradia.field.training import (
    Remark,
    Stepped,
    SteppedBack,
    TrainEvent,
    TrainOptions,
    Validated,
    Working,
)

_LOSS_DECAY = 0.98  # of the mean that is shown


class _View:
    """The stage that is on show."""

    def __init__(self, progress: Progress, options: TrainOptions, stop: Callable[[], None]) -> None:
        self._progress, self._options, self._stop = progress, options, stop
        self._open = ExitStack()
        self._stage: Stage | None = None
        self._name, self._done, self._before = "", 0.0, 0.0
        self._loss: float | None = None
        self._psnr = ""

    def show(self, event: TrainEvent) -> None:
        if isinstance(event, Working):
            self._enter(event.stage, event.total, event.unit)
            self._advance(event.done)
        elif isinstance(event, Stepped):
            self._show_step(event)
        elif isinstance(event, Validated):
            self._psnr = f"  {event.figures.psnr_db:.1f} dB"
        elif isinstance(event, Remark):
            self._say(f"note: {event.text}")
        elif isinstance(event, SteppedBack):
            self._say(
                f"warning: no number after step {event.step}; back to step {event.to_step}, "
                f"learning rates at {event.rate_factor:g}"
            )

    def __enter__(self) -> _View:
        return self

    def __exit__(self, *raised: Any) -> None:
        self._open.__exit__(*raised)

    def _say(self, text: str) -> None:
        """Below the bar, if there is one."""
        self._progress.say(f"\n{text}" if self._name == "Train" else text)

    def _show_step(self, event: Stepped) -> None:
        by_time = self._options.time_s is not None
        if self._name != "Train":
            total = 100.0 if by_time else float(self._options.steps or 0) * self._options.batch_size
            before = 0.0 if by_time else float(event.samples - self._options.batch_size)
            self._enter("Train", total - before, "%" if by_time else "samples")
            self._before = before
            self._open.enter_context(asks_first(self._stop, self._progress.say))
        self._advance(100.0 * event.progress if by_time else event.samples - self._before)
        mean = event.loss if self._loss is None else self._loss
        self._loss = _LOSS_DECAY * mean + (1.0 - _LOSS_DECAY) * event.loss
        speed = f"  {event.samples_per_s / 1e6:.2f} M samples/s" if by_time else ""
        if self._stage is not None:
            self._stage.note(f"loss {self._loss:.4g}{self._psnr}{speed}")

    def _enter(self, name: str, total: float, unit: str) -> None:
        if name == self._name:
            return
        self._open.close()
        self._stage = self._open.enter_context(self._progress.stage(name, total or None, unit))
        self._name, self._done = name, 0.0

    def _advance(self, done: float) -> None:
        if self._stage is not None:
            self._stage.advance(done - self._done)
        self._done = done


def shown(
    events: Iterable[TrainEvent], options: TrainOptions, progress: Progress, stop: Callable[[], None]
) -> Iterator[TrainEvent]:
    """Passes events on while it shows them.

    Args:
        events: Of a training.
        options: Its options.
        progress: Where it is shown.
        stop: Called by the first Ctrl-C after the first step; before it, Ctrl-C ends all at once.
    """
    with _View(progress, options, stop) as view:
        for event in events:
            view.show(event)
            yield event
