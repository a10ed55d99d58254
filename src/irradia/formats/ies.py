"""IES LM-63 photometric files, the editions of 1986, 1991, 1995, 2002 and 2019.

    IESNA:LM-63-2002                                    the edition; that of 1986 has no such line
    [TEST] ABC1234                                      keywords, free text
    TILT=NONE                                           or INCLUDE and its table, or a file's name
    1 -1 1.0 5 2 1 2 0.1 0.1 0  1.0 1.0 20              lamps … horizontal count, type … ; factors, watts
    0 22.5 45 67.5 90                                   vertical angles
    0 90                                                horizontal angles
    1000 950 700 300 0                                  candela: one run of verticals a horizontal
    1000 900 600 200 0

Numbers are separated by blanks, commas and line ends in any mixture. What is read is the luminous
intensity; lamp counts, sizes and watts are not, and a TILT table (how an old lamp's output depends on
how it is mounted) is passed over with a note.
"""

from __future__ import annotations

import codecs
import math
import re
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError

PhotometricType = Literal["B", "C"]

MAX_BYTES = 1 << 24
MAX_CANDELA_VALUES = 1 << 20

_EDITIONS = {
    "IESNA:LM-63-1986": 1986,
    "IESNA91": 1991,
    "IESNA:LM-63-1991": 1991,
    "IESNA:LM-63-1995": 1995,
    "IESNA:LM-63-2002": 2002,
    "IES:LM-63-2019": 2019,
}
_TYPES: dict[int, PhotometricType] = {1: "C", 2: "B"}
_NEWEST_WITH_BALLAST_LAMP_FACTOR = 1991  # later editions keep its place for other things
_WAY_OUT = "Ask the luminaire's maker for the file again, or export it anew from a photometry tool."


@dataclass(frozen=True)
class IesTable:
    """Luminous intensity as it was measured.

    Attributes:
        photometric_type: ``C``: vertical angles from the beam's axis, horizontal ones counter-clockwise
            round it. ``B``: vertical angles turn about a horizontal axis, horizontal ones lean
            towards that axis, clockwise.
        vertical_deg: (V,) ascending.
        horizontal_deg: (H,) ascending; the range says how the table is continued by symmetry.
        candela: (H, V) with the file's multiplier and ballast factors in it.
        edition: Year of the LM-63 that the file follows.
        keywords: The bracketed header lines, the last of each name.
        notes: What was passed over.
    """

    photometric_type: PhotometricType
    vertical_deg: NDArray[np.float64]
    horizontal_deg: NDArray[np.float64]
    candela: NDArray[np.float64]
    edition: int
    keywords: dict[str, str]
    notes: tuple[str, ...] = ()


def decode_ies(data: bytes, where: str) -> IesTable:
    """Reads the bytes of an LM-63 file.

    Args:
        data: The file.
        where: Its name or JSON pointer, for errors.

    Raises:
        InputError: It is malformed, of Type A, or larger than any real one.
    """
    if len(data) > MAX_BYTES:
        raise InputError(f"expected at most {MAX_BYTES} bytes of IES data, found {len(data)}", where=where)
    # Names of makers come in every code page; the numbers are ASCII.
    text = data.removeprefix(codecs.BOM_UTF8).decode("latin-1").replace("\x1a", "")
    lines = text.lstrip().splitlines()
    edition, keywords, tilt, body = _header(lines, where)
    numbers = _Numbers(body, where)
    notes = [] if tilt == "NONE" else [f"TILT={tilt} is ignored: the lamp shines as in its test position"]
    if tilt == "INCLUDE":
        numbers.skip_tilt()
    return _table(numbers, edition, keywords, tuple(notes), where)


def encode_ies(table: IesTable) -> bytes:
    """Writes a table as LM-63-2002; decoding gives it back but for notes and edition."""
    number = {kind: code for code, kind in _TYPES.items()}[table.photometric_type]
    n_horizontal, n_vertical = table.candela.shape
    rows = [table.vertical_deg, table.horizontal_deg, *table.candela]
    lines = [
        "IESNA:LM-63-2002",
        *(f"[{name}] {value}" for name, value in table.keywords.items()),
        "TILT=NONE",
        f"1 -1 1 {n_vertical} {n_horizontal} {number} 2 0 0 0",
        "1 1 0",
        *(" ".join(f"{value:.9g}" for value in row) for row in rows),
    ]
    return ("\r\n".join(lines) + "\r\n").encode("latin-1", "replace")


def _header(lines: list[str], where: str) -> tuple[int, dict[str, str], str, str]:
    """Edition, keywords, the tilt's kind, and all text behind it."""
    edition = 1986
    if lines and lines[0].strip().upper().startswith("IES"):
        found = lines[0].strip()
        if found.upper() not in _EDITIONS:
            raise InputError(
                f"expected one of {', '.join(_EDITIONS)} in the first line, found {found[:40]!r}",
                where=where,
                fix=_WAY_OUT,
            )
        edition = _EDITIONS[found.upper()]
    keywords: dict[str, str] = {}
    for number, line in enumerate(lines):
        if line.strip().upper().startswith("TILT="):
            tilt = line.strip()[5:].strip()
            kind = tilt.upper() if tilt.upper() in ("NONE", "INCLUDE") else tilt
            return edition, keywords, kind, "\n".join(lines[number + 1 :])
        keyword = re.match(r"\s*\[([^\]]+)\]\s*(.*)", line)
        if keyword:
            keywords[keyword[1]] = keyword[2].strip()
    raise InputError("this is no IES LM-63 file: it has no line TILT=", where=where, fix=_WAY_OUT)


def _table(
    numbers: _Numbers, edition: int, keywords: dict[str, str], notes: tuple[str, ...], where: str
) -> IesTable:
    """Everything behind the TILT."""
    numbers.take(2)  # lamps and lumens: candela are absolute, whatever these say
    multiplier = numbers.one()
    n_vertical = numbers.count("vertical angles", minimum=2)
    n_horizontal = numbers.count("horizontal angles", minimum=1)
    if n_vertical * n_horizontal > MAX_CANDELA_VALUES:
        raise InputError(f"{n_vertical} × {n_horizontal} angles are more than a file may hold", where=where)
    kind = _photometric_type(numbers.one(), where)
    numbers.take(4)  # units, width, length, height
    ballast, ballast_lamp, _ = numbers.take(3)
    factor = multiplier * ballast
    if edition <= _NEWEST_WITH_BALLAST_LAMP_FACTOR:
        factor *= ballast_lamp
    if not factor > 0.0:
        raise InputError(f"expected positive multiplier and ballast factors, found {factor:g}", where=where)
    vertical = np.array(numbers.take(n_vertical))
    horizontal = np.array(numbers.take(n_horizontal))
    candela = np.array(numbers.take(n_vertical * n_horizontal)).reshape(n_horizontal, n_vertical) * factor
    numbers.expect_end()
    _check_angles(kind, vertical, horizontal, where)
    if candela.min() < 0.0:
        raise InputError(f"expected no negative candela, found {candela.min():g}", where=where, fix=_WAY_OUT)
    return IesTable(kind, vertical, horizontal, candela, edition, keywords, notes)


def _photometric_type(number: float, where: str) -> PhotometricType:
    if number == 3:
        raise InputError(
            "photometry of Type A (headlamps and signals) isn't read",
            where=where,
            fix="Convert the file to Type B or C with a photometry tool.",
        )
    if number not in _TYPES:
        raise InputError(f"expected photometric type 1 (C) or 2 (B), found {number:g}", where=where)
    return _TYPES[int(number)]


def _check_angles(
    kind: PhotometricType, vertical: NDArray[np.float64], horizontal: NDArray[np.float64], where: str
) -> None:
    """Refuses angles out of order, or ranges that no symmetry continues."""
    for name, angles in (("vertical", vertical), ("horizontal", horizontal)):
        if (np.diff(angles) <= 0.0).any():
            raise InputError(f"expected ascending {name} angles", where=where, fix=_WAY_OUT)
    low = -90.0 if kind == "B" else 0.0
    high = 90.0 if kind == "B" else 180.0
    if vertical[0] < low or vertical[-1] > high:
        raise InputError(
            f"expected vertical angles within {low:g} … {high:g}, found {vertical[0]:g} … {vertical[-1]:g}",
            where=where,
            fix=_WAY_OUT,
        )
    span = (float(horizontal[0]), float(horizontal[-1]))
    if not _has_symmetry(kind, span):
        ranges = "0 … 90 or −90 … 90" if kind == "B" else "0 alone, 0 … 90, 0 … 180, 0 … 360 or 90 … 270"
        raise InputError(
            f"expected horizontal angles {ranges}, found {span[0]:g} … {span[1]:g}", where=where, fix=_WAY_OUT
        )


def _has_symmetry(kind: PhotometricType, span: tuple[float, float]) -> bool:
    """Whether a horizontal range says what the directions outside it hold."""
    if kind == "B":
        return span in ((0.0, 90.0), (-90.0, 90.0))
    # A full turn may leave out its last plane, which is its first.
    return span in ((0.0, 0.0), (0.0, 90.0), (0.0, 180.0), (90.0, 270.0)) or (
        span[0] == 0.0 and 180.0 < span[1] <= 360.0
    )


class _Numbers:
    """The numbers of a file in turn."""

    def __init__(self, text: str, where: str) -> None:
        self._tokens = re.split(r"[\s,]+", text.strip()) if text.strip() else []
        self._next = 0
        self._where = where

    def take(self, count: int) -> list[float]:
        """The next ``count``."""
        tokens = self._tokens[self._next : self._next + count]
        if len(tokens) < count:
            raise InputError(
                f"this file ends early: expected at least {self._next + count} numbers behind TILT, "
                f"found {len(self._tokens)}",
                where=self._where,
                fix=_WAY_OUT,
            )
        self._next += count
        return [self._number(token) for token in tokens]

    def one(self) -> float:
        """The next one."""
        return self.take(1)[0]

    def count(self, name: str, *, minimum: int) -> int:
        """The next one as a number of things."""
        value = self.one()
        if value != int(value) or value < minimum:
            raise InputError(
                f"expected a whole number of {name} of at least {minimum}, found {value:g}", where=self._where
            )
        return int(value)

    def skip_tilt(self) -> None:
        """Passes over the lamp's geometry, the count, the angles and the factors."""
        self.take(1)
        self.take(2 * self.count("tilt angles", minimum=0))

    def expect_end(self) -> None:
        """Refuses numbers that the counts don't announce: one of them must be wrong."""
        rest = len(self._tokens) - self._next
        if rest:
            raise InputError(
                f"{rest} more numbers than the counts of angles announce", where=self._where, fix=_WAY_OUT
            )

    def _number(self, token: str) -> float:
        try:
            value = float(token)
        except ValueError:
            raise InputError(
                f"expected a number, found {token[:20]!r}", where=self._where, fix=_WAY_OUT
            ) from None
        if not math.isfinite(value):
            raise InputError(f"expected a finite number, found {token[:20]!r}", where=self._where)
        return value
