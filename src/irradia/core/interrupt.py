"""Ctrl-C that lets work come to a good end: the first asks, the second stops at once."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def asks_first(stop: Callable[[], None], say: Callable[[str], None]) -> Iterator[None]:
    """While the block runs, the first Ctrl-C calls ``stop``; the next raises KeyboardInterrupt.

    Outside the main thread, where Python takes no signals, nothing changes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.getsignal(signal.SIGINT)

    def ask(*_: object) -> None:
        signal.signal(signal.SIGINT, before)
        say("\nStopping after this pass; Ctrl-C again stops at once.")
        stop()

    signal.signal(signal.SIGINT, ask)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
