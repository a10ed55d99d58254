"""Takes the README's pictures of the viewer, from what `make demo` has left: docs/images/viewer-*.png.

    python scripts/screenshots.py out/demo [--gpu] [--only split]

In software each takes a minute or so. Pictures are kept small: they come with every clone.
"""

from __future__ import annotations

import argparse
import io
import json
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread

from PIL import Image

from irradia.cli.gallery_browser import Page, open_page
from irradia.cli.gallery_viewer import show
from irradia.cli.view_job import listen
from irradia.core.errors import IrradiaError
from irradia.core.files import write_atomic

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
SIZE_PX = (1280, 720)
MAX_BYTES = 300_000
TIMEOUT_S = 900.0


@dataclass(frozen=True)
class Shot:
    """What a picture shows.

    Attributes:
        address: What the viewer opens with.
        then: What is changed once that is on show, as its state names it.
    """

    address: str
    then: Mapping[str, str] = field(default_factory=dict)


# One side first: the other isn't there before all files are read.
SHOTS = {
    "split": Shot("pose=0&left=lightmap", {"right": "reference", "compare": "split"}),
    "error": Shot("pose=0&left=lightmap", {"right": "reference", "compare": "error"}),
    "field": Shot("pose=0&left=field&pass=full"),
    "texels": Shot("pose=0&left=lightmap&view=uv"),
}
_SETTLED = "irradiaViewer.state.set(%s); irradiaViewer.settled().then(() => true)"


def main() -> int:
    """Takes each picture in a browser of its own."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("demo", type=Path, nargs="?", default=ROOT / "out" / "demo")
    parser.add_argument("--gpu", action="store_true", help="draw with this machine's GPU")
    parser.add_argument("--only", choices=SHOTS, action="append", help="this picture; may be given again")
    asked = parser.parse_args()
    try:
        with served(asked.demo) as url:
            for name in asked.only or SHOTS:
                with open_page(*SIZE_PX, gpu=asked.gpu) as page:
                    take(page, url, SHOTS[name])
                    print(f"{name}: {save(name, page):,} bytes", flush=True)
    except IrradiaError as error:
        print(f"screenshots: {error}", file=sys.stderr)
        return 1
    return 0


def take(page: Page, url: str, shot: Shot) -> None:
    """Puts it on show."""
    show(page, f"{url}?renderer=webgl2&{shot.address}", TIMEOUT_S)
    if shot.then:
        page.evaluate(_SETTLED % json.dumps(shot.then), TIMEOUT_S)


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The viewer of a folder; gives its address."""
    server = listen([folder], [], 0)
    Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield server.url
    finally:
        server.shutdown()
        server.server_close()


def save(name: str, page: Page) -> int:
    """Writes the page's picture, panels included; returns its bytes."""
    data = packed(Image.open(io.BytesIO(page.picture(TIMEOUT_S))).convert("RGB"))
    with write_atomic(IMAGES / f"viewer-{name}.png") as stream:
        stream.write(data)
    return len(data)


def packed(picture: Image.Image) -> bytes:
    """A PNG of 256 colours, made smaller until it is small enough."""
    width, height = picture.size
    for share in (1.0, 0.875, 0.75, 0.625, 0.5):
        scaled = picture.resize((round(share * width), round(share * height)), Image.Resampling.LANCZOS)
        stream = io.BytesIO()
        scaled.quantize(256, dither=Image.Dither.NONE).save(stream, "PNG", optimize=True)
        if stream.tell() <= MAX_BYTES:
            break
    return stream.getvalue()


if __name__ == "__main__":
    sys.exit(main())
