"""IES LM-63 files of all editions, and damaged ones."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.ies import decode_ies, encode_ies

BODY = """1 1000 {multiplier} 3 2 {kind} 2 0.1 0.1 0
{ballast} {second} 60
0 45 90
0 90
100 50 0
80, 40, 10
"""


def text(
    first: str | None = "IESNA:LM-63-2002",
    tilt: str = "TILT=NONE",
    multiplier: float = 1,
    kind: int = 1,
    ballast: float = 1,
    second: float = 1,
    body: str | None = None,
) -> bytes:
    """A small file."""
    header = [] if first is None else [first]
    filled = (body or BODY).format(multiplier=multiplier, kind=kind, ballast=ballast, second=second)
    return "\r\n".join([*header, "[TEST] 42", "[MANUFAC] Lampen Müller", tilt, filled]).encode("latin-1")


@pytest.mark.parametrize(
    ("first", "edition"),
    [
        (None, 1986),
        ("IESNA91", 1991),
        ("IESNA:LM-63-1995", 1995),
        ("IESNA:LM-63-2002", 2002),
        ("IES:LM-63-2019", 2019),
    ],
)
def test_every_edition_is_read(first, edition):
    table = decode_ies(text(first), "lamp.ies")
    assert table.edition == edition
    assert table.photometric_type == "C"
    np.testing.assert_array_equal(table.vertical_deg, [0, 45, 90])
    np.testing.assert_array_equal(table.horizontal_deg, [0, 90])
    np.testing.assert_array_equal(table.candela, [[100, 50, 0], [80, 40, 10]])
    assert table.keywords == {"TEST": "42", "MANUFAC": "Lampen Müller"}
    assert table.notes == ()


@pytest.mark.parametrize(
    ("first", "factor"),
    [("IESNA91", 2 * 0.9 * 0.5), ("IESNA:LM-63-1995", 2 * 0.9), ("IES:LM-63-2019", 2 * 0.9)],
)
def test_multiplier_and_ballast_count_and_the_second_factor_in_old_editions_alone(first, factor):
    """Since 1995 its place is for future use, and since 2019 it says how the file was made."""
    table = decode_ies(text(first, multiplier=2, ballast=0.9, second=0.5), "lamp.ies")
    assert table.candela[0, 0] == pytest.approx(100 * factor)


@pytest.mark.parametrize("before", [b"\xef\xbb\xbf", b"\r\n \r\n"])
def test_marks_and_blanks_before_the_first_line_do_not_hide_the_edition(before):
    assert decode_ies(before + text("IES:LM-63-2019") + b"\x1a", "lamp.ies").edition == 2019


def test_tilt_tables_are_passed_over_with_a_note():
    plain = decode_ies(text(), "lamp.ies")
    tilted = decode_ies(text(tilt="TILT=INCLUDE\n1\n3\n0 45 90\n1.0 0.9 0.8"), "lamp.ies")
    elsewhere = decode_ies(text(tilt="TILT=lamp.tlt"), "lamp.ies")
    for table, name in ((tilted, "INCLUDE"), (elsewhere, "lamp.tlt")):
        np.testing.assert_array_equal(table.candela, plain.candela)
        assert len(table.notes) == 1
        assert f"TILT={name}" in table.notes[0]


def test_writing_and_reading_gives_the_same_table():
    table = decode_ies(text(kind=2, multiplier=1.25), "lamp.ies")
    again = decode_ies(encode_ies(table), "again.ies")
    assert again.photometric_type == "B"
    assert again.keywords == table.keywords
    for name in ("vertical_deg", "horizontal_deg", "candela"):
        np.testing.assert_allclose(getattr(again, name), getattr(table, name), rtol=1e-8)


def test_type_a_is_refused_and_says_so():
    with pytest.raises(InputError, match="Type A"):
        decode_ies(text(kind=3), "lamp.ies")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "no line TILT="),
        (b"hello", "no line TILT="),
        (text("IESNA:LM-63-2099"), "first line"),
        (text()[:-12], "ends early"),
        (text() + b" 7", "1 more numbers"),
        (text(kind=4), "photometric type"),
        (text(multiplier=0), "positive"),
        (text(multiplier=-1), "positive"),
        (text(ballast=float("nan")), "finite"),
        (text(body=BODY.replace("50", "x50")), "expected a number, found 'x50'"),
        (text(body=BODY.replace("100 50 0", "100 -50 0")), "negative"),
        (text(body=BODY.replace("0 45 90", "0 90 45")), "ascending vertical"),
        (text(body=BODY.replace("0 45 90", "0 45 190")), "vertical angles within"),
        (text(body=BODY.replace("\n0 90\n", "\n90 0\n")), "ascending horizontal"),
        (text(body=BODY.replace("\n0 90\n", "\n0 77\n")), "horizontal angles"),
        (text(body="1 1 1 1 1 1 2 0 0 0 1 1 1 0 0 5"), "vertical angles of at least 2"),
        (text(body="1 1 1 2.5 1 1 2 0 0 0 1 1 1 0 0 5"), "whole number"),
        (text(body="1 1 1 99999 99999 1 2 0 0 0 1 1 1 0 0 5"), "more than a file may hold"),
    ],
)
def test_damaged_files_are_input_errors_that_name_the_file(data, message):
    with pytest.raises(InputError, match=message) as error:
        decode_ies(data, "lamp.ies")
    assert error.value.where == "lamp.ies"


def test_any_shortening_or_flipped_byte_ends_in_a_table_or_an_input_error():
    whole = text()
    rng = np.random.default_rng(4)
    damaged = [whole[:n] for n in range(len(whole))]
    for _ in range(300):
        data = bytearray(whole)
        data[rng.integers(len(data))] = rng.integers(256)
        damaged.append(bytes(data))
    n_refused = 0
    for data in damaged:
        try:
            table = decode_ies(data, "lamp.ies")
        except InputError:
            n_refused += 1
            continue
        assert np.isfinite(table.candela).all()
        assert table.candela.shape == (len(table.horizontal_deg), len(table.vertical_deg))
    assert n_refused > len(whole) // 2
