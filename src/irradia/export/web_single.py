"""One HTML file that holds the viewer and all it shows, and works from a disk without any server.

Each file is a ``<script type="text/plain">`` of base64, which no browser takes for a program, gzipped where
that helps; docs/viewer.md says how the page finds them.
"""

from __future__ import annotations

import base64
import gzip
import json
import re
from collections.abc import Iterator
from html import escape
from pathlib import Path

from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.export.web_collection import WebCollection, WebFile
from irradia.export.web_viewer import CHARSET, PAGE, SCRIPT, STYLE, Viewer, not_built, put_after

MAX_BYTES = 256 << 20  # a page of twice that is more than browsers hold as one text
_STYLE_TAG = f'<link rel="stylesheet" href="./{STYLE}">'
_SCRIPT_TAG = f'<script type="module" src="./{SCRIPT}"></script>'
_END = "</body>"
_ENDS_SCRIPT = re.compile("<(?=/script|!--)", re.IGNORECASE)
_WORTH = 0.95  # of its size, what gzip must leave to be used


def write_single_file(path: Path, viewer: Viewer, collection: WebCollection) -> int:
    """Writes the page; the same files give the same bytes.

    Args:
        path: An .html.
        viewer: The page and its parts.
        collection: What it shows.

    Returns:
        Bytes written.

    Raises:
        InputError: The files are too many bytes for one page.
        MissingDependencyError: The viewer isn't one that fits into a file.
    """
    check_size(collection, path)
    before, after = _page(viewer, collection)
    with write_atomic(path) as stream:
        stream.write(before.encode("utf-8"))
        for file in collection.files():
            stream.writelines(_embedded(file))
        stream.write(after.encode("utf-8"))
        return stream.tell()


def check_size(collection: WebCollection, path: Path) -> None:
    """Refuses what no browser would open as one page.

    Args:
        collection: What it is to show.
        path: The page that an error names.

    Raises:
        InputError: The files are too many bytes.
    """
    n_bytes = sum(file.path.stat().st_size for file in collection.files())
    if n_bytes > MAX_BYTES:
        raise InputError(
            f"expected at most {MAX_BYTES:,} bytes of scenes and fields for one file, found {n_bytes:,}",
            where=str(path),
            fix="Use --web, which leaves them as files of their own.",
        )


def _page(viewer: Viewer, collection: WebCollection) -> tuple[str, str]:
    """The page up to the files, and from there on."""
    extra = sorted(set(viewer.files) - {PAGE, SCRIPT, STYLE})
    if extra:
        raise not_built(f"it is more than one page, script and style: {', '.join(extra)}")
    manifest = json.dumps(collection.manifest(), allow_nan=False).replace("<", r"\u003c")
    tag = f'\n<script type="application/json" id="irradia-manifest">{manifest}</script>'
    page = put_after(viewer.text(PAGE), CHARSET, tag)
    page = _replace(page, _STYLE_TAG, f"<style>\n{viewer.text(STYLE)}</style>")
    page = _replace(page, _SCRIPT_TAG, f'<script type="module">\n{_inline(viewer.text(SCRIPT))}</script>')
    at = page.rfind(_END)
    if at < 0:
        raise not_built(f"its page doesn't hold {_END}")
    return page[:at], page[at:]


def _replace(page: str, tag: str, text: str) -> str:
    if page.count(tag) != 1:
        raise not_built(f"its page doesn't hold {tag} once")
    return page.replace(tag, text)


def _inline(script: str) -> str:
    """A program in which nothing ends the element around it: it may speak of elements in its texts."""
    return _ENDS_SCRIPT.sub(r"\\x3c", script)


def _embedded(file: WebFile) -> Iterator[bytes]:
    data = file.path.read_bytes()
    packed = gzip.compress(data, compresslevel=6, mtime=0)
    helps = len(packed) < _WORTH * len(data)
    encoding = "gzip" if helps else "identity"
    yield (
        f'<script type="text/plain" data-irradia-file="{escape(file.url)}" data-encoding="{encoding}">'
    ).encode()
    yield base64.b64encode(packed if helps else data)
    yield b"</script>\n"
