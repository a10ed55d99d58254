"""One training of a sweep, in a process that ends with the sweep's.

    python -m irradia.cli.sweep_worker ARGUMENTS OF irradia

The sweep holds the other end of stdin. When it dies, however that happens, the pipe closes and this
process goes too, so that a sweep that is started again finds nobody writing into its folders.
"""

from __future__ import annotations

import os
import sys
import threading


def main() -> int:
    """Runs the command line that stands in the arguments."""
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    from irradia.cli.app import run

    return run(sys.argv[1:])


def _leave_with_parent() -> None:
    while os.read(0, 1):  # not by sys.stdin, whose lock would be held when the interpreter shuts down
        pass
    os._exit(1)


if __name__ == "__main__":
    sys.exit(main())
