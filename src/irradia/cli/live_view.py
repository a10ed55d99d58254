"""The viewer with a bake inside, written beside its report."""

from __future__ import annotations

from pathlib import Path

from irradia.core.errors import InputError
from irradia.core.progress import Progress
from irradia.report import LiveView

FILE = "view.html"


def write_live_view(folder: Path, progress: Progress) -> LiveView | None:
    """Writes a page that shows what else is in the folder, its ``bake.json`` included.

    Returns:
        What a report says of it; None where the viewer isn't built or the bake is too large for one file.
    """
    from irradia.export.web_folder import collect
    from irradia.export.web_single import check_size, write_single_file
    from irradia.export.web_viewer import find_viewer

    try:
        viewer, collection = find_viewer(), collect([folder])
        check_size(collection, folder / FILE)
    except InputError as error:
        progress.say(f"note: without a live view in the report. {error}")
        return None
    with progress.stage("live view"):
        return LiveView(FILE, write_single_file(folder / FILE, viewer, collection))
