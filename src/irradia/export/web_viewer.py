"""The viewer as it was built: in the installed package, or in a checkout's web/viewer/dist."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path

import irradia
from irradia.core.errors import MissingDependencyError

PAGE, SCRIPT, STYLE = "index.html", "viewer.js", "viewer.css"
_PACKAGE = Path(irradia.__file__).resolve().parent
PLACES = (_PACKAGE / "viewer", _PACKAGE.parents[1] / "web" / "viewer" / "dist")
CHARSET = '<meta charset="utf-8">'


@dataclass(frozen=True)
class Viewer:
    """A built viewer.

    Attributes:
        files: By address; ``index.html`` is among them.
    """

    files: Mapping[str, Path]

    def page(self, manifest_url: str | None = "manifest.json") -> str:
        """The page, told where its manifest is; None for one that waits for files."""
        text = self.text(PAGE)
        if manifest_url is None:
            return text
        return put_after(text, CHARSET, f'\n<meta name="irradia-manifest" content="{escape(manifest_url)}">')

    def text(self, name: str) -> str:
        """One of its files.

        Raises:
            MissingDependencyError: It isn't there.
        """
        try:
            return self.files[name].read_text(encoding="utf-8")
        except (KeyError, OSError) as error:
            raise not_built() from error


def find_viewer() -> Viewer:
    """The viewer of this installation.

    Raises:
        MissingDependencyError: It isn't built.
    """
    for folder in PLACES:
        if (folder / PAGE).is_file():
            found = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.suffix != ".map")
            return Viewer({path.relative_to(folder).as_posix(): path for path in found})
    raise not_built()


def put_after(text: str, mark: str, inserted: str) -> str:
    """``text`` with something behind a mark that it holds once.

    Raises:
        MissingDependencyError: It doesn't: this is another viewer's page.
    """
    if text.count(mark) != 1:
        raise not_built(f"its page doesn't hold {mark} once")
    return text.replace(mark, mark + inserted)


def not_built(reason: str = "it isn't built") -> MissingDependencyError:
    """What to tell the user of a viewer that is absent or of another make."""
    return MissingDependencyError(
        f"the viewer can't be shown: {reason}",
        fix="In a checkout, `make viewer` builds it (it needs Node.js and npm); packages come with it.",
    )
