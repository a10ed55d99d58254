"""``irradia doctor``: what this machine can run, and how to mend what it can't."""

from __future__ import annotations

from dataclasses import asdict

import click

from irradia.cli import options
from irradia.cli.machine import Check, check_all
from irradia.cli.output import finish

_MARKS = {"ok": "ok     ", "missing": "MISSING", "optional": "absent "}


@click.command("doctor")
@options.json_option
def command(as_json: bool) -> int:
    """What this machine can run, and how to mend what it can't.

    Exit code 2 if something that baking needs is missing.
    """
    checks = check_all()
    missing = [check for check in checks if check.state == "missing"]
    lines = [line for check in checks for line in _lines(check)]
    verdict = "Ready to bake." if not missing else f"Not ready: {len(missing)} to mend, see above."
    fields, table = _fields()
    return finish(
        as_json,
        {"ready": not missing, "checks": [asdict(check) for check in checks], "field_backends": fields},
        "\n".join([*lines, "", table, verdict]),
        2 if missing else 0,
    )


def _lines(check: Check) -> list[str]:
    """One line, and another with the cure where there is something to cure."""
    first = f"{_MARKS[check.state]}  {check.name:<12}  {check.found}"
    return [first, f"{'':<23}{check.fix}"] if check.fix else [first]


def _fields() -> tuple[dict[str, dict[str, bool]], str]:
    """Which backend computes which encoding of a field, and a table of it."""
    from irradia.field.backends import backend, matrix, matrix_text

    head = f"Neural fields, encoding by backend; --backend auto starts with {backend('auto').name}:"
    return matrix(), f"{head}\n\n{matrix_text()}"
