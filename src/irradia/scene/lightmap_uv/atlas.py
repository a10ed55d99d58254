"""xatlas's atlases, given up late.

An atlas has worker threads, and joins them when it is destroyed. A worker that is just going to
sleep after its last task can miss the call to end (the flag is set outside the lock), and then the
join waits for ever, as was seen on a busy machine. So an atlas is kept until
its workers have long been asleep.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xatlas

REST_S = 2.0
_resting: deque[tuple[float, xatlas.Atlas]] = deque()


@contextmanager
def new_atlas() -> Iterator[xatlas.Atlas]:
    """An empty atlas for the length of the block."""
    import xatlas

    atlas = xatlas.Atlas()
    try:
        yield atlas
    finally:
        now = time.monotonic()
        _resting.append((now, atlas))
        while now - _resting[0][0] > REST_S:
            _resting.popleft()
