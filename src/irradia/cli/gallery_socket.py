"""A WebSocket to a browser on this machine: as much of RFC 6455 as its DevTools need."""

from __future__ import annotations

import base64
import hashlib
import os
import socket
import struct
from types import TracebackType

from irradia.core.errors import IrradiaError

_KEY_SUFFIX = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"  # section 1.3
_CONTINUATION, _TEXT, _CLOSE, _PING, _PONG = 0x0, 0x1, 0x8, 0x9, 0xA
_MAX_BYTES = 1 << 28
_PATIENCE_S = 30.0  # what has begun goes on
_STOPPED = "the browser stopped in the middle of a message"


class SocketError(IrradiaError):
    """The other side is gone, or says what it may not."""


class WebSocket:
    """A connection that sends and receives texts.

    Args:
        host: Of this machine.
        port: Where it listens.
        path: That is asked for.
        timeout_s: For connecting, and for each wait afterwards.

    Raises:
        SocketError: It doesn't answer as a WebSocket does.
    """

    def __init__(self, host: str, port: int, path: str, timeout_s: float) -> None:
        try:
            self._socket = socket.create_connection((host, port), timeout_s)
        except OSError as error:
            raise SocketError(f"no connection to {host}:{port}: {error}") from error
        self._unread = b""
        try:
            self._greet(host, port, path)
        except BaseException:
            self._socket.close()
            raise

    def __enter__(self) -> WebSocket:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._socket.close()

    def send(self, text: str) -> None:
        """Sends one text.

        Raises:
            SocketError: The connection is gone.
        """
        self._send(_TEXT, text.encode("utf-8"))

    def receive(self, timeout_s: float) -> str | None:
        """The next text; None where none begins in time.

        Raises:
            SocketError: The connection is gone.
        """
        message, has_begun = b"", False
        while True:
            self._socket.settimeout(_PATIENCE_S if has_begun else max(timeout_s, 1e-3))
            try:
                self._fill(2)
            except TimeoutError as error:
                if has_begun:
                    raise SocketError(_STOPPED) from error
                return None
            is_last, kind, data = self._frame()
            if kind == _PING:
                self._send(_PONG, data)
            elif kind == _CLOSE:
                raise SocketError("the browser has closed the connection")
            elif kind in (_TEXT, _CONTINUATION):
                message += data
                if is_last:
                    return message.decode("utf-8")
                has_begun = True

    def _greet(self, host: str, port: int, path: str) -> None:
        """The handshake of section 4. Without an Origin, which browsers refuse here."""
        key = base64.b64encode(os.urandom(16))
        lines = (
            f"GET {path} HTTP/1.1",
            f"Host: {host}:{port}",
            "Upgrade: websocket",
            "Connection: Upgrade",
            f"Sec-WebSocket-Key: {key.decode()}",
            "Sec-WebSocket-Version: 13",
        )
        self._write("\r\n".join((*lines, "", "")).encode())
        while b"\r\n\r\n" not in self._unread:
            self._read_more()
        head, _, self._unread = self._unread.partition(b"\r\n\r\n")
        wanted = base64.b64encode(hashlib.sha1(key + _KEY_SUFFIX).digest())
        if not head.startswith(b"HTTP/1.1 101") or wanted not in head:
            raise SocketError(f"expected a WebSocket, found {head[:80]!r}")

    def _send(self, kind: int, data: bytes) -> None:
        """One frame, masked as those of clients are."""
        mask = os.urandom(4)
        if len(data) < 126:
            size = bytes([0x80 | len(data)])
        elif len(data) < 1 << 16:
            size = bytes([0x80 | 126]) + struct.pack(">H", len(data))
        else:
            size = bytes([0x80 | 127]) + struct.pack(">Q", len(data))
        key = int.from_bytes((mask * (len(data) // 4 + 1))[: len(data)], "big")
        masked = (int.from_bytes(data, "big") ^ key).to_bytes(len(data), "big")
        self._write(bytes([0x80 | kind]) + size + mask + masked)

    def _frame(self) -> tuple[bool, int, bytes]:
        """Whether it is its message's last, its kind, and its content."""
        first, second = self._take(2)
        n_bytes = second & 0x7F
        if n_bytes == 126:
            (n_bytes,) = struct.unpack(">H", self._take(2))
        elif n_bytes == 127:
            (n_bytes,) = struct.unpack(">Q", self._take(8))
        if second & 0x80 or n_bytes > _MAX_BYTES:
            raise SocketError(f"expected a browser's frame, found one of {n_bytes} bytes")
        return bool(first & 0x80), first & 0x0F, self._take(n_bytes)

    def _take(self, n_bytes: int) -> bytes:
        self._socket.settimeout(_PATIENCE_S)
        try:
            self._fill(n_bytes)
        except TimeoutError as error:
            raise SocketError(_STOPPED) from error
        taken, self._unread = self._unread[:n_bytes], self._unread[n_bytes:]
        return taken

    def _fill(self, n_bytes: int) -> None:
        parts, there = [self._unread], len(self._unread)
        try:
            while there < n_bytes:
                part = self._receive()
                parts.append(part)
                there += len(part)
        finally:
            self._unread = b"".join(parts)

    def _read_more(self) -> None:
        try:
            self._unread += self._receive()
        except TimeoutError as error:
            raise SocketError("the browser doesn't answer") from error

    def _receive(self) -> bytes:
        try:
            part = self._socket.recv(1 << 16)
        except TimeoutError:
            raise
        except OSError as error:
            raise SocketError(f"the connection to the browser broke: {error}") from error
        if not part:
            raise SocketError("the browser has gone")
        return part

    def _write(self, data: bytes) -> None:
        try:
            self._socket.sendall(data)
        except OSError as error:
            raise SocketError(f"the connection to the browser broke: {error}") from error
