"""Starts the viewer's server, says where it is, and serves."""

from __future__ import annotations

import threading
import webbrowser
from collections.abc import Sequence
from pathlib import Path

import click

from irradia.cli.output import finish
from irradia.cli.view_server import HOST, Library, ViewServer
from irradia.core.errors import InputError
from irradia.export.web_collection import WebCollection
from irradia.export.web_folder import collect
from irradia.export.web_viewer import find_viewer


def listen(paths: Sequence[Path], fields: Sequence[Path], port: int) -> ViewServer:
    """A server that listens but doesn't answer yet.

    Raises:
        InputError: A file is wrong, the viewer isn't built, or the port is taken.
    """
    library = Library(find_viewer(), lambda: collect(paths, fields))
    try:
        return ViewServer(library, port)
    except (OSError, OverflowError) as error:
        raise InputError(
            f"port {port} of {HOST} can't be used: {error}",
            where="--port",
            fix="Choose another, or leave the option out.",
        ) from error


def announce(server: ViewServer, *, as_json: bool) -> None:
    """Says where the page is and what is on it, before it is served."""
    collection = server.library.collection
    shown = {"url": server.url, "port": server.server_port, "manifest": collection.manifest()}
    finish(as_json, shown, f"{describe(collection)}\n{server.url}  (Ctrl-C ends it)")


def describe(collection: WebCollection) -> str:
    """What is shown, a line for each scene."""
    if not collection.scenes:
        return "Drop a .glb, weights or an HDRI on the page."
    return "\n".join(
        f"{scene.name}: {_counted(len(scene.fields), 'field')}, "
        f"{_counted(len(scene.references), 'reference picture')}"
        for scene in collection.scenes
    )


def open_browser(url: str) -> None:
    """Opens the page; some browsers' programs only return when they are closed."""

    def ask() -> None:
        if not webbrowser.open(url):
            click.echo("No browser could be opened: open the address yourself.", err=True)

    threading.Thread(target=ask, daemon=True).start()


def serve_until_interrupted(server: ViewServer) -> None:
    """Answers until Ctrl-C, which is how it ends well."""
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        click.echo("", err=True)
    finally:
        server.server_close()


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
