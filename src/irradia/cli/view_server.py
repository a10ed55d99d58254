"""Serves the viewer with its files on this machine alone: what isn't on its list can't be asked for."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BytesIO
from pathlib import Path
from typing import IO, cast
from urllib.parse import urlsplit

from irradia.core.errors import InputError
from irradia.export.web_collection import WebCollection
from irradia.export.web_viewer import PAGE, Viewer

HOST = "127.0.0.1"
MANIFEST = "manifest.json"
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".ico": "image/x-icon",
    ".wasm": "application/wasm",
    ".glb": "model/gltf-binary",
    ".hdr": "image/vnd.radiance",
    ".safetensors": "application/vnd.safetensors",
    ".zst": "application/zstd",
}
_MAX_DIGITS = 18  # of a byte's place; more than any file has
_RANGE = re.compile(r"bytes=([0-9]*)-([0-9]*)$")
_CHUNK_BYTES = 1 << 18


@dataclass(frozen=True)
class Served:
    """What an address stands for: a file, or text that was made for it."""

    kind: str
    path: Path | None = None
    text: bytes = b""

    def open(self) -> tuple[IO[bytes], int, str]:
        """Its bytes, their number, and a tag that changes with them.

        Raises:
            OSError: The file has gone.
        """
        if self.path is None:
            return BytesIO(self.text), len(self.text), ""
        stream = self.path.open("rb")
        state = self.path.stat()
        return stream, state.st_size, f'"{state.st_mtime_ns:x}-{state.st_size:x}"'


class Library:
    """What is shown, looked for anew whenever the page is loaded, so that a later bake shows.

    Args:
        viewer: The page and its parts.
        find: Finds the files.

    Raises:
        InputError: From ``find``.
    """

    def __init__(self, viewer: Viewer, find: Callable[[], WebCollection]) -> None:
        self._viewer, self._find = viewer, find
        self.collection = find()

    def look(self, address: str) -> Served | None:
        """What an address without its leading slash stands for; None where there is nothing."""
        if address in ("", PAGE):
            return Served(TYPES[".html"], text=self._viewer.page(MANIFEST).encode("utf-8"))
        if address == MANIFEST:
            return Served(TYPES[".json"], text=self._manifest())
        path = self._viewer.files.get(address) or self._files().get(address)
        return Served(_type(path), path) if path is not None else None

    def _files(self) -> dict[str, Path]:
        return {file.url: file.path for file in self.collection.files()}

    def _manifest(self) -> bytes:
        try:
            self.collection = self._find()
            manifest = self.collection.manifest()
        except (InputError, OSError):  # a bake is just being written: what was found before still stands
            manifest = self.collection.manifest()
        return json.dumps(manifest, indent=2, allow_nan=False).encode("utf-8")


class ViewServer(ThreadingHTTPServer):
    """The server; it listens as soon as it is made.

    Args:
        library: What it serves.
        port: 0 takes a free one.

    Raises:
        OSError: The port is taken.
    """

    daemon_threads = True
    allow_reuse_address = False

    def __init__(self, library: Library, port: int = 0) -> None:
        self.library = library
        super().__init__((HOST, port), _Handler)

    @property
    def url(self) -> str:
        """The page's."""
        return f"http://{HOST}:{self.server_port}/"


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server_version = "irradia"
    sys_version = ""

    def do_GET(self) -> None:
        self._answer(with_body=True)

    def do_HEAD(self) -> None:
        self._answer(with_body=False)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - named by http.server
        """Says nothing: a line for every file would hide what matters."""

    def _answer(self, *, with_body: bool) -> None:
        host, path = _host(self.headers.get("Host", "")), _path(self.path)
        if host is None or path is None:
            self._refuse(HTTPStatus.BAD_REQUEST)
            return
        if host not in (HOST, "localhost"):  # another site's name, made to point here, would own these files
            self._refuse(HTTPStatus.FORBIDDEN)
            return
        found = cast("ViewServer", self.server).library.look(path.removeprefix("/"))
        if found is None:
            self._refuse(HTTPStatus.NOT_FOUND)
            return
        try:
            stream, size, tag = found.open()
        except OSError:
            self._refuse(HTTPStatus.NOT_FOUND)
            return
        with stream:
            if tag and self.headers.get("If-None-Match") == tag:
                self._begin(HTTPStatus.NOT_MODIFIED, found, 0, tag)
                return
            self._send(found, stream, size, tag, with_body=with_body)

    def _send(self, found: Served, stream: IO[bytes], size: int, tag: str, *, with_body: bool) -> None:
        part = _part(self.headers.get("Range"), size)
        if part is None:
            self._refuse(HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE, f"bytes */{size}")
            return
        first, count = part
        whole = count == size
        about = {} if whole else {"Content-Range": f"bytes {first}-{first + count - 1}/{size}"}
        self._begin(HTTPStatus.OK if whole else HTTPStatus.PARTIAL_CONTENT, found, count, tag, about)
        if not with_body:
            return
        stream.seek(first)
        try:
            while count > 0 and (chunk := stream.read(min(count, _CHUNK_BYTES))):
                self.wfile.write(chunk)
                count -= len(chunk)
        except ConnectionError:  # the page was closed or loaded again
            count = 0
        self.close_connection |= count > 0  # the file has shrunk: there is less than was promised

    def _begin(
        self, status: HTTPStatus, found: Served, n_bytes: int, tag: str, about: dict[str, str] | None = None
    ) -> None:
        self.send_response(status)
        self.send_header("Content-Type", found.kind)
        self.send_header("Content-Length", str(n_bytes))
        self.send_header("Accept-Ranges", "bytes")
        self.send_header("Cache-Control", "no-cache")
        self.send_header("X-Content-Type-Options", "nosniff")
        if tag:
            self.send_header("ETag", tag)
        for name, value in (about or {}).items():
            self.send_header(name, value)
        self.end_headers()

    def _refuse(self, status: HTTPStatus, content_range: str | None = None) -> None:
        self.send_response(status)
        if content_range:
            self.send_header("Content-Range", content_range)
        self.send_header("Content-Length", "0")
        self.end_headers()


def _host(header: str) -> str | None:
    """Its name without the port; None where it is none."""
    try:
        return urlsplit(f"//{header}").hostname or ""
    except ValueError:
        return None


def _path(address: str) -> str | None:
    """Of what was asked for; None where it is none."""
    try:
        return urlsplit(address).path
    except ValueError:
        return None


def _part(asked: str | None, size: int) -> tuple[int, int] | None:
    """First byte and number of bytes of a Range header; None where there are no such bytes.

    What isn't understood (several ranges, other units) asks for everything, as RFC 9110 allows.
    """
    match = _RANGE.match(asked or "")
    if match is None or match.groups() == ("", ""):
        return 0, size
    first, last = match.groups()
    if max(len(first), len(last)) > _MAX_DIGITS:
        return None
    if first == "":
        count = min(int(last), size)
        return (size - count, count) if count else None
    start, stop = int(first), min(int(last) + 1 if last else size, size)
    return (start, stop - start) if start < stop else None


def _type(path: Path) -> str:
    return TYPES.get(path.suffix.lower(), "application/octet-stream")
