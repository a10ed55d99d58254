"""A lock has one holder, and dies with it."""

from __future__ import annotations

import os
import subprocess
import sys

from irradia.core.lock import acquire_lock, lock_holder

_HOLD = """
import sys
from pathlib import Path
from irradia.core.lock import acquire_lock
lock = acquire_lock(Path(sys.argv[1]))
print("held" if lock else "busy", flush=True)
sys.stdin.readline()
"""


def test_a_held_lock_is_refused_and_a_released_one_given(tmp_path):
    first = acquire_lock(tmp_path / "lock")
    assert first is not None
    assert acquire_lock(tmp_path / "lock") is None
    first.release()
    assert list(tmp_path.iterdir()) == []
    again = acquire_lock(tmp_path / "lock")
    assert again is not None
    again.release()


def test_the_file_says_who_holds_it(tmp_path):
    lock = acquire_lock(tmp_path / "lock")
    assert lock is not None
    assert f"process {os.getpid()} on " in lock_holder(tmp_path / "lock")
    lock.release()
    assert lock_holder(tmp_path / "lock") == ""


def test_another_process_is_refused_until_the_holder_is_killed(tmp_path):
    command = [sys.executable, "-c", _HOLD, str(tmp_path / "lock")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        assert acquire_lock(tmp_path / "lock") is None
        assert f"process {holder.pid} " in lock_holder(tmp_path / "lock")
        holder.kill()
        holder.wait()
    lock = acquire_lock(tmp_path / "lock")
    assert lock is not None
    lock.release()


def test_a_file_left_by_the_dead_is_no_lock(tmp_path):
    (tmp_path / "lock").write_text("process 1 on another machine since long ago\nand a longer tail " * 9)
    lock = acquire_lock(tmp_path / "lock")
    assert lock is not None
    assert lock_holder(tmp_path / "lock").count("process") == 1
    lock.release()
