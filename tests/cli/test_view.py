"""``irradia view``: what is served, what isn't, and how it ends."""

from __future__ import annotations

import contextlib
import http.client
import json
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest

from irradia.cli import app
from irradia.cli.view_server import Library, ViewServer
from irradia.export import web_viewer
from irradia.export.web_folder import collect
from irradia.export.web_viewer import find_viewer

from .viewing import WEIGHTS, glb, viewer, write_results

__all__ = ["viewer"]


@pytest.fixture
def baked(tmp_path: Path) -> Path:
    return write_results(tmp_path / "out")


@pytest.fixture
def server(viewer: Path, baked: Path):
    served = ViewServer(Library(find_viewer(), lambda: collect([baked])))
    thread = threading.Thread(target=served.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield served
    served.shutdown()
    thread.join()
    served.server_close()


@pytest.fixture
def ask(server: ViewServer):
    def request(path: str, method: str = "GET", **headers: str) -> tuple[http.client.HTTPResponse, bytes]:
        connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=10)
        connection.putrequest(method, path, skip_host="Host" in headers)
        for name, value in headers.items():
            connection.putheader(name.replace("_", "-"), value)
        connection.endheaders()
        answer = connection.getresponse()
        data = answer.read()
        connection.close()
        return answer, data

    return request


@pytest.mark.parametrize(
    ("path", "kind"),
    [
        ("/", "text/html; charset=utf-8"),
        ("/index.html?left=field#ev=1", "text/html; charset=utf-8"),
        ("/viewer.js", "text/javascript; charset=utf-8"),
        ("/viewer.css", "text/css; charset=utf-8"),
        ("/manifest.json", "application/json"),
        ("/files/0/scene.baked.glb", "model/gltf-binary"),
        ("/files/2/view0.reference.hdr", "image/vnd.radiance"),
    ],
)
def test_everything_has_its_type(ask, path: str, kind: str) -> None:
    answer, data = ask(path)
    assert (answer.status, answer.headers["Content-Type"]) == (200, kind)
    assert len(data) == int(answer.headers["Content-Length"]) > 0


def test_the_page_is_told_of_its_manifest(ask) -> None:
    assert b'<meta name="irradia-manifest" content="manifest.json">' in ask("/")[1]


def test_the_manifest_leads_to_the_files(ask, baked: Path) -> None:
    manifest = json.loads(ask("/manifest.json")[1])
    field = manifest["scenes"][0]["fields"][0]
    data = ask("/" + field["url"])[1]
    assert data == WEIGHTS.read_bytes()
    assert len(data) == field["bytes"]


@pytest.mark.parametrize(
    "path",
    [
        "/bake.json",
        "/files/0/bake.json",
        "/files/0/../../bake.json",
        "/../out/bake.json",
        "/..%2f..%2fetc%2fpasswd",
        "/%2e%2e/viewer/viewer.js",
        "//etc/passwd",
        "/files/0/scene.baked.glb/",
        "/viewer.js%00.css",
        "/files",
    ],
)
def test_nothing_else_can_be_asked_for(ask, path: str) -> None:
    answer, data = ask(path)
    assert (answer.status, data) == (404, b"")


def test_other_names_of_this_machine_are_refused(ask) -> None:
    assert ask("/", Host="evil.example")[0].status == 403
    assert ask("/", Host="localhost:80")[0].status == 200


def test_only_reading_is_answered(ask) -> None:
    assert ask("/manifest.json", "POST")[0].status == 501


def test_head_says_the_length_alone(server: ViewServer) -> None:
    with socket.create_connection(("127.0.0.1", server.server_port), 10) as connection:
        connection.sendall(
            b"HEAD /files/0/scene.baked.glb HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
        )
        answer = b"".join(iter(lambda: connection.recv(4096), b""))
    head, _, body = answer.partition(b"\r\n\r\n")
    assert f"Content-Length: {len(glb())}".encode() in head
    assert body == b""


@pytest.mark.parametrize(
    ("asked", "part"),
    [("bytes=0-3", slice(0, 4)), ("bytes=5-", slice(5, None)), ("bytes=-6", slice(-6, None))],
)
def test_parts_of_files_are_served(ask, asked: str, part: slice) -> None:
    answer, data = ask("/files/0/scene.baked.glb", Range=asked)
    assert (answer.status, data) == (206, glb()[part])
    first = range(len(glb()))[part][0]
    assert answer.headers["Content-Range"] == f"bytes {first}-{first + len(data) - 1}/{len(glb())}"


@pytest.mark.parametrize("host", ["[", "[::1", "]"])
def test_what_is_no_address_is_a_bad_request(ask, host: str) -> None:
    assert ask("/", Host=host)[0].status == 400
    assert ask(f"http://{host}/", Host="localhost")[0].status == 400


@pytest.mark.parametrize(
    ("asked", "status"),
    [
        ("bytes=9999-", 416),
        ("bytes=-0", 416),
        (f"bytes={'9' * 5000}-", 416),
        (f"bytes=0-{'9' * 5000}", 416),
        ("bytes=\u00b2-", 200),
        ("lines=1-2", 200),
    ],
)
def test_ranges_that_are_not_there(ask, asked: str, status: int) -> None:
    assert ask("/files/0/scene.baked.glb", Range=asked)[0].status == status


def test_a_file_that_is_known_is_not_sent_again(ask) -> None:
    tag = ask("/viewer.js")[0].headers["ETag"]
    answer, data = ask("/viewer.js", If_None_Match=tag)
    assert (answer.status, data) == (304, b"")


def test_a_later_bake_shows_when_the_page_is_loaded_again(ask, baked: Path) -> None:
    (baked / "second.safetensors").write_bytes(WEIGHTS.read_bytes())
    fields = json.loads(ask("/manifest.json")[1])["scenes"][0]["fields"]
    assert [field["name"] for field in fields] == ["field", "second"]
    assert ask("/" + fields[1]["url"])[0].status == 200


def test_a_folder_that_is_just_written_leaves_what_was_found(ask, baked: Path) -> None:
    before = json.loads(ask("/manifest.json")[1])
    (baked / "bake.json").write_text("{")
    assert json.loads(ask("/manifest.json")[1]) == before
    (baked / "field.safetensors").unlink()
    assert ask("/" + before["scenes"][0]["fields"][0]["url"])[0].status == 404


@pytest.fixture
def fail(capfd):
    def run(*arguments: Any) -> str:
        assert app.run(["view", *map(str, arguments), "--no-browser", "--json"]) == 2
        return json.loads(capfd.readouterr().out)["error"]["message"]

    return run


def test_a_port_that_is_taken_is_refused(fail, viewer: Path) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        assert "can't be used" in fail("--port", other.getsockname()[1])


def test_a_missing_file_is_refused(fail, viewer: Path, tmp_path: Path) -> None:
    assert "no such file" in fail(tmp_path / "absent.glb")


def test_a_viewer_that_is_not_built_is_named(fail, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(web_viewer, "PLACES", (tmp_path / "nowhere",))
    assert "make viewer" in fail()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows sends no Ctrl-C to one process")
def test_ctrl_c_ends_it_well(viewer: Path, baked: Path) -> None:
    code = (
        "import sys; from pathlib import Path\n"
        "from irradia.cli import app; from irradia.export import web_viewer\n"
        "web_viewer.PLACES = (Path(sys.argv[1]),)\n"
        "sys.exit(app.run(['view', sys.argv[2], '--no-browser', '--json']))"
    )
    command = [sys.executable, "-c", code, str(viewer), str(baked)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            said = _first_object(process)
            connection = http.client.HTTPConnection("127.0.0.1", said["port"], timeout=20)
            connection.request("GET", "/viewer.js")
            with contextlib.closing(connection):
                assert connection.getresponse().status == 200
            process.send_signal(signal.SIGINT)
            assert process.wait(20) == 0
        finally:
            process.kill()  # or leaving the block would wait for what doesn't end
    assert said["url"] == f"http://127.0.0.1:{said['port']}/"
    assert said["manifest"]["scenes"][0]["name"] == "box"


def _first_object(process: subprocess.Popen) -> dict[str, Any]:
    text, ends_at = "", time.monotonic() + 60
    while time.monotonic() < ends_at:
        text += process.stdout.readline()
        try:
            return json.loads(text)
        except ValueError:
            continue
    raise AssertionError(text)
