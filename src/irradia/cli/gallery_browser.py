"""Chromium without a window, driven through its DevTools with nothing but the standard library."""

from __future__ import annotations

import base64
import json
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from irradia.cli.gallery_socket import SocketError, WebSocket
from irradia.cli.machine import find_chromium
from irradia.core.errors import IrradiaError, MissingDependencyError

# Draws WebGPU and WebGL2 on a machine without a GPU; other sets lose the GPU process at the first canvas.
SOFTWARE_FLAGS = (
    "--enable-unsafe-webgpu",
    "--use-angle=swiftshader",
    "--use-vulkan=swiftshader",
    "--enable-features=Vulkan",
    "--enable-unsafe-swiftshader",
)
_FLAGS = (
    "--headless=new",
    "--no-sandbox",  # which root and most containers can't have; only our own page is shown
    "--no-first-run",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--mute-audio",
    "--remote-debugging-port=0",
)
_START_S = 60.0
_ANSWER_S = 60.0
_POLL_S = 0.1


class BrowserError(IrradiaError):
    """The browser can't show a page; the message says why, as far as it told."""


class Page:
    """The one page of a browser; see :func:`open_page`.

    Attributes:
        complaints: What the page has said since it was last sent somewhere: errors and warnings.
    """

    def __init__(self, socket: WebSocket) -> None:
        self._socket = socket
        self._number = 0
        self._session: str | None = None
        self._crashed = False
        self.complaints: list[str] = []
        target = self._call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Inspector"):
            self._call(f"{domain}.enable")

    def resize(self, width: int, height: int) -> None:
        """Sets the page's size in pixels."""
        self._call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )

    def go(self, url: str) -> None:
        """Leaves for another address.

        Raises:
            BrowserError: There is nothing.
        """
        self.complaints = []
        self._call("Page.navigate", url="about:blank")  # the same address but for its # would not load anew
        answer = self._call("Page.navigate", url=url)
        if answer.get("errorText"):
            raise BrowserError(f"{url}: {answer['errorText']}")

    def evaluate(self, expression: str, timeout_s: float = _ANSWER_S) -> Any:
        """The value of an expression of JavaScript, or of what it promises.

        Raises:
            BrowserError: It throws, or takes longer.
        """
        asked = {"expression": expression, "returnByValue": True, "awaitPromise": True}
        answer = self._call("Runtime.evaluate", timeout_s, **asked)
        if "exceptionDetails" in answer:
            raise BrowserError(_exception(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def wait_for(self, expression: str, timeout_s: float) -> Any:
        """The first value of an expression that isn't null, false or empty; asks again and again.

        Raises:
            BrowserError: There is none in time; it holds what the page complained of.
        """
        ends_at = time.monotonic() + timeout_s
        while not (value := self._value_if_there(expression, ends_at)):
            if time.monotonic() > ends_at:
                said = f"; it says: {' / '.join(self.complaints[-3:])}" if self.complaints else ""
                raise BrowserError(f"the page isn't ready after {timeout_s:.3g} s{said}")
            self._listen(_POLL_S)
        return value

    def _value_if_there(self, expression: str, ends_at: float) -> Any:
        """Like ``evaluate``; nothing while one page goes and the next isn't there yet."""
        try:
            return self.evaluate(expression, max(ends_at - time.monotonic(), _POLL_S))
        except BrowserError:
            if self._crashed:
                raise
            return None

    def picture(self, timeout_s: float = _ANSWER_S) -> bytes:
        """What is on show, as a PNG; waits for a moment in which nothing is drawn.

        Raises:
            BrowserError: There is none in time.
        """
        return base64.b64decode(self._call("Page.captureScreenshot", timeout_s, format="png")["data"])

    def close_browser(self) -> None:
        """Asks the browser to end."""
        self._session = None
        with suppress(IrradiaError):
            self._call("Browser.close")

    def _call(self, method: str, timeout_s: float = _ANSWER_S, /, **arguments: Any) -> dict[str, Any]:
        """Sends a command and waits for its answer."""
        self._number += 1
        command: dict[str, Any] = {"id": self._number, "method": method, "params": arguments}
        if self._session is not None:
            command["sessionId"] = self._session
        self._socket.send(json.dumps(command))
        ends_at = time.monotonic() + timeout_s
        while (left := ends_at - time.monotonic()) > 0.0:
            message = self._receive(left)
            if message is not None and message.get("id") == self._number:
                if "error" in message:
                    raise BrowserError(f"{method}: {message['error'].get('message')}")
                return message["result"]
        raise BrowserError(f"the browser doesn't answer {method} within {timeout_s:g} s")

    def _listen(self, seconds: float) -> None:
        """Takes in what the page says meanwhile."""
        ends_at = time.monotonic() + seconds
        while (left := ends_at - time.monotonic()) > 0.0:
            self._receive(left)

    def _receive(self, timeout_s: float) -> dict[str, Any] | None:
        text = self._socket.receive(timeout_s)
        if text is None:
            return None
        message = json.loads(text)
        self._note(message.get("method", ""), message.get("params", {}))
        return message

    def _note(self, event: str, about: dict[str, Any]) -> None:
        if event == "Runtime.exceptionThrown":
            self.complaints.append(_exception(about["exceptionDetails"]))
        elif event == "Runtime.consoleAPICalled" and about["type"] in ("error", "warning", "assert"):
            values = (each.get("value", each.get("description", "")) for each in about["args"])
            self.complaints.append(" ".join(map(str, values)))
        elif event == "Log.entryAdded" and about["entry"]["level"] in ("error", "warning"):
            self.complaints.append(f"{about['entry']['text']} {about['entry'].get('url', '')}".strip())
        elif event == "Inspector.targetCrashed":
            self._crashed = True
            raise BrowserError("the page has crashed; it may have taken too much memory")


def _exception(details: dict[str, Any]) -> str:
    thrown = details.get("exception", {})
    return str(thrown.get("description") or thrown.get("value") or details.get("text"))


@contextmanager
def open_page(width: int, height: int, *, gpu: bool = False, program: str | None = None) -> Iterator[Page]:
    """A page of a browser of its own, which ends with the block.

    Args:
        width: In pixels.
        height: Likewise.
        gpu: Draws with this machine's GPU as the browser sees fit; by default in software, alike everywhere.
        program: The browser; None finds one.

    Raises:
        MissingDependencyError: There is no Chromium.
        BrowserError: It doesn't start.
    """
    program = program or find_chromium()
    if program is None:
        raise MissingDependencyError(
            "no Chromium was found",
            fix="Debian: sudo apt-get install chromium, or set IRRADIA_CHROMIUM to a browser.",
        )
    with tempfile.TemporaryDirectory(prefix="irradia-browser-", ignore_cleanup_errors=True) as profile:
        process = _start(program, Path(profile), gpu)
        try:
            port, path = _door(process, Path(profile))
            with WebSocket("127.0.0.1", port, path, _ANSWER_S) as socket:
                page = Page(socket)
                page.resize(width, height)
                yield page
                page.close_browser()
        except SocketError as error:
            raise BrowserError(f"{error}{_said(Path(profile))}") from error
        finally:
            _end(process)


def _start(program: str, profile: Path, gpu: bool) -> subprocess.Popen[bytes]:
    flags = _FLAGS if gpu else _FLAGS + SOFTWARE_FLAGS
    command = [program, *flags, f"--user-data-dir={profile}", "about:blank"]
    with (profile / "stderr").open("wb") as said:
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said)


def _door(process: subprocess.Popen[bytes], profile: Path) -> tuple[int, str]:
    """Port and path of the DevTools, which the browser writes to its profile."""
    file, ends_at = profile / "DevToolsActivePort", time.monotonic() + _START_S
    while time.monotonic() < ends_at:
        lines = file.read_text().splitlines() if file.exists() else []
        if len(lines) == 2 and lines[1]:
            return int(lines[0]), lines[1]
        if process.poll() is not None:
            raise BrowserError(f"the browser ended with {process.returncode}{_said(profile)}")
        time.sleep(0.05)
    raise BrowserError(f"the browser didn't start within {_START_S:g} s{_said(profile)}")


def _said(profile: Path) -> str:
    with suppress(OSError):
        lines = (profile / "stderr").read_text(errors="replace").strip().splitlines()
        return f"; it said: {' / '.join(lines[-3:])}" if lines else ""
    return ""


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ends our browser, however it is."""
    for ask in (lambda: None, process.terminate, process.kill):
        ask()
        with suppress(subprocess.TimeoutExpired):
            process.wait(5.0)
            return
