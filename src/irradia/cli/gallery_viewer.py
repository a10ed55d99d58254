"""The viewer in a browser's page, as scripts drive it; docs/viewer.md lists what it tells of itself."""

from __future__ import annotations

import base64
import math
import time

from irradia.cli.gallery_browser import BrowserError, Page

_ROOT = "document.documentElement.dataset"
_PICTURE = """irradiaViewer.picture().then((blob) => new Promise((resolve, reject) => {
  const reader = new FileReader();
  reader.onload = () => resolve(reader.result.slice(reader.result.indexOf(",") + 1));
  reader.onerror = () => reject(reader.error);
  reader.readAsDataURL(blob);
}))"""


def show(page: Page, url: str, timeout_s: float) -> None:
    """Opens the viewer and waits until all that the address asks for is on show.

    Raises:
        BrowserError: It can't be shown, or not in time.
    """
    ends_at = time.monotonic() + timeout_s
    page.go(url)
    page.wait_for("!!globalThis.irradiaViewer", timeout_s)
    page.evaluate("void irradiaViewer.ready.then(() => { globalThis.isShown = true; })")
    left_s = max(ends_at - time.monotonic(), 1.0)
    page.wait_for(f'globalThis.isShown && ["ready", "error"].includes({_ROOT}.state)', left_s)
    if page.evaluate(f'{_ROOT}.state === "error"'):
        raise BrowserError(page.evaluate(f"{_ROOT}.message") or "the viewer can't show it")


def viewer_picture(page: Page, timeout_s: float) -> bytes:
    """What the viewer shows, without its panels, as a PNG.

    It draws this itself: a picture of the page waits for a moment in which nothing is drawn.

    Raises:
        BrowserError: There is none in time.
    """
    return base64.b64decode(page.evaluate(_PICTURE, timeout_s))


def exposure_ev(page: Page) -> float | None:
    """Stops at which the viewer shows, if it tells."""
    said = page.evaluate(f"Number.parseFloat({_ROOT}.ev)")
    return float(said) if isinstance(said, (int, float)) and math.isfinite(said) else None
