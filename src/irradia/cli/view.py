"""``irradia view``: the viewer in a browser, served on this machine."""

from __future__ import annotations

from pathlib import Path

import click

from irradia.cli import options

_PATH = click.Path(path_type=Path)


@click.command("view")
@click.argument("paths", nargs=-1, type=_PATH, metavar="[DIR|GLB]...")
@click.option("--field", "fields", multiple=True, type=_PATH, help="Further weights; may be given again.")
@click.option(
    "--port",
    type=options.Whole(0, 65535),
    default=0,
    metavar="PORT",
    help="Where to serve.  [default: any that is free]",
)
@click.option("--no-browser", is_flag=True, help="Only print the address.")
@options.json_option
def command(
    as_json: bool, paths: tuple[Path, ...], fields: tuple[Path, ...], port: int, no_browser: bool
) -> None:
    """Show baked light in the browser.

    DIR is a folder of `irradia bake`, demo or eval: its baked scene, weights and reference pictures are
    shown together. Without any, the page waits for files that are dropped on it. Served on 127.0.0.1
    until Ctrl-C; a page that is loaded again shows what has been baked since.
    """
    from irradia.cli.view_job import announce, listen, open_browser, serve_until_interrupted

    server = listen(paths, fields, port)
    announce(server, as_json=as_json)
    if not no_browser:
        open_browser(server.url)
    serve_until_interrupted(server)
