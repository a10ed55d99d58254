"""Contact sheets: every picture with its label, and what couldn't be made."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from irradia.formats.png import encode_png
from irradia.report.contact import Contact, contact_page, contact_sheet


def plain(colour: tuple[int, int, int], width: int = 40, height: int = 20) -> bytes:
    return encode_png(np.full((height, width, 3), colour, np.uint8))


def opened(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))


def count(sheet: np.ndarray, colour: tuple[int, int, int]) -> int:
    return int(np.count_nonzero((sheet == colour).all(axis=-1)))


@pytest.mark.parametrize("n", [1, 2, 3, 7, 20])
def test_every_picture_is_on_the_sheet_whole(n: int) -> None:
    colours = [(10 * i + 5, 200, 255 - 9 * i) for i in range(n)]
    contacts = [Contact(f"{i}", "", plain(colour)) for i, colour in enumerate(colours)]
    sheet = opened(contact_sheet("A", "b", contacts, (40, 20)))
    assert [count(sheet, colour) for colour in colours] == [40 * 20] * n


def test_pictures_of_another_size_are_fitted() -> None:
    sheet = opened(contact_sheet("A", "", [Contact("a", "", plain((9, 99, 199), 80, 40))], (40, 20)))
    assert count(sheet, (9, 99, 199)) == 40 * 20


def test_a_missing_picture_says_why() -> None:
    there, missing = Contact("a", "", plain((9, 99, 199))), Contact("b", "the browser has gone", None)
    without = contact_sheet("A", "", [there, Contact("b", "", None)], (200, 100))
    assert not np.array_equal(opened(contact_sheet("A", "", [there, missing], (200, 100))), opened(without))
    page = contact_page("A", "", [there, missing])
    assert page.count('<img src="data:image/png;base64,') == 1
    assert "the browser has gone" in page
    assert "b, failed" in page


def test_labels_change_nothing_of_a_sheet_s_size() -> None:
    sizes = {
        opened(contact_sheet(name, name, [Contact(name, name, plain((1, 2, 3)))], (40, 20))).shape
        for name in ("a", "a long name " * 40, "\N{MINUS SIGN}12 …")
    }
    assert len(sizes) == 1


def test_names_are_no_elements() -> None:
    page = contact_page("<b>", "<i>", [Contact("<u>", "<s>", plain((1, 2, 3)))])
    assert not any(tag in page for tag in ("<b>", "<i>", "<u>", "<s>"))
