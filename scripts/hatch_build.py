"""Puts the built viewer into packages: at irradia/viewer in a wheel, where it was built in an sdist."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

BUILT = Path("web") / "viewer" / "dist"


class ViewerHook(BuildHookInterface):
    """An editable install needs nothing: it finds the viewer in the checkout."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Adds the files; says so where there are none.

        Args:
            version: Of the target: ``standard`` or ``editable``.
            build_data: What the builder reads afterwards.
        """
        if version == "editable":
            return
        built = Path(self.root) / BUILT
        if not (built / "index.html").is_file():
            self.app.display_warning("the viewer is left out, as it isn't built: run `make viewer` before")
            return
        target = Path("irradia") / "viewer" if self.target_name == "wheel" else BUILT
        for path in sorted(built.rglob("*")):
            if path.is_file() and path.suffix != ".map":
                inside = (target / path.relative_to(built)).as_posix()
                build_data["force_include"][str(path)] = inside
