"""The gallery's WebSocket waits for what has not begun, and not for ever for what has."""

from __future__ import annotations

import base64
import hashlib
import socket
import threading

import pytest

from irradia.cli import gallery_socket
from irradia.cli.gallery_socket import SocketError, WebSocket

SUFFIX = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
FIRST, LAST, WHOLE = 0x01, 0x80, 0x81  # of a text's fragments


def frame(head: int, data: bytes) -> bytes:
    return bytes([head, len(data)]) + data


@pytest.fixture
def browser(monkeypatch):
    """``browser(bytes)`` is a connection to what greets as a browser does, sends that, and is silent."""
    monkeypatch.setattr(gallery_socket, "_PATIENCE_S", 0.05)
    listener = socket.create_server(("127.0.0.1", 0))
    opened: list[WebSocket] = []
    served: list[socket.socket] = []

    def serve(data: bytes) -> None:
        peer, _ = listener.accept()
        served.append(peer)
        asked = peer.recv(4096)
        key = next(
            line.split(b": ")[1] for line in asked.split(b"\r\n") if line.startswith(b"Sec-WebSocket-Key")
        )
        answer = base64.b64encode(hashlib.sha1(key + SUFFIX).digest())
        peer.sendall(b"HTTP/1.1 101 Yes\r\nSec-WebSocket-Accept: " + answer + b"\r\n\r\n" + data)

    def connect(data: bytes) -> WebSocket:
        thread = threading.Thread(target=serve, args=(data,))
        thread.start()
        opened.append(WebSocket("127.0.0.1", listener.getsockname()[1], "/", 10.0))
        thread.join()
        return opened[-1]

    yield connect
    for each in opened:
        each.__exit__(None, None, None)
    for peer in served:
        peer.close()
    listener.close()


def test_a_text_may_come_in_fragments(browser) -> None:
    assert browser(frame(FIRST, b"one ") + frame(LAST, b"text")).receive(1.0) == "one text"


def test_nothing_is_none(browser) -> None:
    assert browser(b"").receive(0.01) is None


@pytest.mark.parametrize("begun", [b"one ", b""])
def test_a_text_without_its_last_fragment_is_given_up(browser, begun: bytes) -> None:
    with pytest.raises(SocketError, match="in the middle"):
        browser(frame(FIRST, begun)).receive(0.01)


def test_a_frame_that_ends_early_is_given_up(browser) -> None:
    with pytest.raises(SocketError, match="in the middle"):
        browser(frame(WHOLE, b"whole")[:-2]).receive(1.0)
