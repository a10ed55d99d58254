"""Contact sheets: many pictures of one view with a label each, as one picture or one page."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

from irradia.report.sheet import section, sheet

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageFont import FreeTypeFont, ImageFont

_GROUND, _EMPTY, _TEXT, _QUIET, _WRONG = (
    (28, 28, 28),
    (45, 45, 45),
    (226, 226, 226),
    (155, 155, 155),
    (240, 162, 75),
)
_GAP_PX, _MARGIN_PX = 16, 24
_SHEET_ASPECT = 16.0 / 10.0
_MAX_TEXT = 400  # characters of an error


@dataclass(frozen=True)
class Contact:
    """One picture of a sheet.

    Attributes:
        name: Its label.
        remark: Below it.
        png: None where it couldn't be made; ``remark`` says why.
    """

    name: str
    remark: str
    png: bytes | None


def contact_page(title: str, subtitle: str, contacts: Sequence[Contact]) -> str:
    """A page with the pictures inside, and no request to anywhere."""
    figures = "".join(_figure(contact) for contact in contacts)
    return sheet(title, subtitle, (), (section("Contact sheet", f'<div class="pages">{figures}</div>'),))


def contact_sheet(title: str, subtitle: str, contacts: Sequence[Contact], cell_px: tuple[int, int]) -> bytes:
    """A PNG with the pictures in rows.

    Args:
        title: At the top.
        subtitle: Below it.
        contacts: In reading order; at least one.
        cell_px: Width and height of each picture.
    """
    from PIL import Image, ImageDraw

    width, height = cell_px
    size = max(13, width // 26)
    line = round(1.5 * size)
    row_px, column_px = height + 2 * line + 6 + _GAP_PX, width + _GAP_PX
    n_columns = _columns(len(contacts), column_px, row_px)
    n_rows = math.ceil(len(contacts) / n_columns)
    top = _MARGIN_PX + 3 * line + 8
    whole = (2 * _MARGIN_PX - _GAP_PX + n_columns * column_px, top + n_rows * row_px - _GAP_PX + _MARGIN_PX)
    image = Image.new("RGB", whole, _GROUND)
    draw = ImageDraw.Draw(image)
    large, small = _font(round(1.4 * size)), _font(size)
    room = whole[0] - 2 * _MARGIN_PX
    draw.text((_MARGIN_PX, _MARGIN_PX), _cut(title, large, room), _TEXT, large)
    draw.text((_MARGIN_PX, _MARGIN_PX + 1.6 * line), _cut(subtitle, small, room), _QUIET, small)
    for number, contact in enumerate(contacts):
        x = _MARGIN_PX + number % n_columns * column_px
        y = top + number // n_columns * row_px
        image.paste(_picture(contact, cell_px, small), (x, y))
        draw.text((x, y + height + 6), _cut(contact.name, small, width), _TEXT, small)
        remark = _cut(contact.remark, small, width) if contact.png is not None else "failed"
        draw.text((x, y + height + 6 + line), remark, _QUIET if contact.png is not None else _WRONG, small)
    stream = io.BytesIO()
    image.save(stream, "PNG", optimize=True)
    return stream.getvalue()


def _columns(count: int, column_px: int, row_px: int) -> int:
    """As many as give the sheet about its shape."""
    return max(1, min(count, round(math.sqrt(count * _SHEET_ASPECT * row_px / column_px))))


def _picture(contact: Contact, cell_px: tuple[int, int], font: FreeTypeFont | ImageFont) -> Image:
    from PIL import Image, ImageDraw

    if contact.png is not None:
        picture = Image.open(io.BytesIO(contact.png)).convert("RGB")
        return picture if picture.size == cell_px else picture.resize(cell_px)
    empty = Image.new("RGB", cell_px, _EMPTY)
    lines = _wrapped(contact.remark[:_MAX_TEXT], font, cell_px[0] - 2 * _GAP_PX)
    ImageDraw.Draw(empty).multiline_text((_GAP_PX, _GAP_PX), "\n".join(lines), _WRONG, font)
    return empty


def _wrapped(text: str, font: FreeTypeFont | ImageFont, width_px: float) -> list[str]:
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and font.getlength(longer) > width_px:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines


def _cut(text: str, font: FreeTypeFont | ImageFont, width_px: float) -> str:
    """As much of a line as there is room for, in signs that Pillow's font has."""
    text = text.replace("\N{MINUS SIGN}", "-")
    if font.getlength(text) <= width_px:
        return text
    while text and font.getlength(f"{text}...") > width_px:
        text = text[:-1]
    return f"{text}..."


def _font(size: int) -> FreeTypeFont | ImageFont:
    from PIL import ImageFont

    return ImageFont.load_default(size)


def _figure(contact: Contact) -> str:
    name = escape(contact.name)
    if contact.png is None:
        picture = f'<p class="notes">{escape(contact.remark[:_MAX_TEXT])}</p>'
        return f'<figure class="page">{picture}<figcaption>{name}, failed</figcaption></figure>'
    uri = f"data:image/png;base64,{base64.b64encode(contact.png).decode('ascii')}"
    remark = f", {escape(contact.remark)}" if contact.remark else ""
    return (
        f'<figure class="page"><img src="{uri}" alt="{name}" loading="lazy">'
        f"<figcaption>{name}{remark}</figcaption></figure>"
    )
