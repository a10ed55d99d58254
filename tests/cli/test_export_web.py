"""``irradia export --web`` and ``--single-file``."""

from __future__ import annotations

import base64
import gzip
import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

from irradia.cli import app
from irradia.export import web_single, web_viewer

from .viewing import WEIGHTS, glb, viewer, write_results

__all__ = ["viewer"]


@pytest.fixture
def export(capfd):
    def run(*arguments: Any) -> tuple[int, dict[str, Any]]:
        code = app.run(["export", *map(str, arguments), "--json"])
        return code, json.loads(capfd.readouterr().out)

    return run


@pytest.fixture
def baked(viewer: Path, tmp_path: Path) -> Path:
    return write_results(tmp_path / "out")


@pytest.fixture
def site(export, baked: Path, tmp_path: Path) -> Path:
    code, said = export(baked, "--web", tmp_path / "site")
    assert code == 0, said
    return tmp_path / "site"


def embedded(page: str) -> tuple[dict[str, Any], dict[str, bytes]]:
    """The manifest in a page, and its files as a browser would unpack them."""
    parser = _Scripts()
    parser.feed(page)
    manifest = next(text for attributes, text in parser.found if attributes.get("id") == "irradia-manifest")
    files = {}
    for attributes, text in parser.found:
        if "data-irradia-file" in attributes:
            data = base64.b64decode(text, validate=True)
            unpack = {"gzip": gzip.decompress, "identity": bytes}[attributes["data-encoding"]]
            files[attributes["data-irradia-file"]] = unpack(data)
    return json.loads(manifest), files


class _Scripts(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[dict[str, str | None], str]] = []
        self._open: dict[str, str | None] | None = None

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "script":
            self._open = dict(attrs)
            self.found.append((self._open, ""))

    def handle_data(self, data: str) -> None:
        if self._open is not None:
            self.found[-1] = (self._open, self.found[-1][1] + data)

    def handle_endtag(self, tag: str) -> None:
        if tag == "script":
            self._open = None


def urls(manifest: dict[str, Any]) -> list[str]:
    return [each["url"] for s in manifest["scenes"] for each in (s, *s["fields"], *s["references"])]


def test_a_site_holds_all_that_its_page_asks_for(site: Path, baked: Path) -> None:
    page = (site / "index.html").read_text()
    for address in re.findall(r'(?:src|href|content)="(\./[^"]+|manifest[^"]*)"', page):
        assert (site / address).is_file()
    manifest = json.loads((site / "manifest.json").read_text())
    assert len(urls(manifest)) == 3
    for each in manifest["scenes"][0]["fields"]:
        assert (site / unquote(each["url"])).read_bytes() == WEIGHTS.read_bytes()
    assert not any(url.startswith("/") or "://" in url for url in urls(manifest))


def test_the_record_lists_what_was_written(export, baked: Path, tmp_path: Path) -> None:
    _, said = export(baked, "--web", tmp_path / "site")
    there = sorted(
        path.relative_to(tmp_path / "site").as_posix()
        for path in (tmp_path / "site").rglob("*")
        if path.is_file()
    )
    assert said["web"]["files"] == there
    assert said["web"]["bytes"] == sum((tmp_path / "site" / name).stat().st_size for name in there)


def test_an_earlier_site_is_replaced(export, site: Path, baked: Path) -> None:
    old = site / "files" / "1" / "field.safetensors"
    assert old.is_file()
    (baked / "field.safetensors").rename(baked / "better.safetensors")
    assert export(baked, "--web", site)[0] == 0
    assert not old.exists()
    assert (site / "files" / "1" / "better.safetensors").is_file()


def test_another_site_is_left_alone(export, baked: Path, tmp_path: Path) -> None:
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "index.html").write_text("mine")
    code, said = export(baked, "--web", tmp_path / "site")
    assert (code, said["error"]["where"]) == (2, str(tmp_path / "site"))
    assert (tmp_path / "site" / "index.html").read_text() == "mine"


def test_a_manifest_cannot_make_us_remove_other_files(
    export, site: Path, baked: Path, tmp_path: Path
) -> None:
    mine = tmp_path / "mine.txt"
    mine.write_text("mine")
    manifest = json.loads((site / "manifest.json").read_text())
    manifest["scenes"][0]["fields"].append({"url": "../mine.txt"})
    (site / "manifest.json").write_text(json.dumps(manifest))
    assert export(baked, "--web", site)[0] == 0
    assert mine.exists()


def test_a_single_file_holds_every_file_whole(export, baked: Path, tmp_path: Path) -> None:
    code, said = export(baked, "--single-file", tmp_path / "a.html", "--field", WEIGHTS)
    assert (code, said["single_file"]["bytes"]) == (0, (tmp_path / "a.html").stat().st_size)
    manifest, files = embedded((tmp_path / "a.html").read_text())
    assert sorted(files) == sorted(urls(manifest))
    assert files["files/0/scene.baked.glb"] == glb()
    assert {len(data) for data in files.values()} >= {WEIGHTS.stat().st_size}


def test_a_single_file_asks_for_nothing(export, baked: Path, tmp_path: Path) -> None:
    export(baked, "--single-file", tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert re.findall(r"<(?:script|link|img|iframe)[^>]+(?:src|href)=", page) == []
    assert "body { margin: 0 }" in page


def test_the_same_files_give_the_same_bytes(export, baked: Path, tmp_path: Path) -> None:
    for name in ("a.html", "b.html"):
        export(baked, "--single-file", tmp_path / name)
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()


def test_names_and_texts_that_look_like_elements_stay_texts(export, baked: Path, tmp_path: Path) -> None:
    record = json.loads((baked / "bake.json").read_text())
    (baked / "bake.json").write_text(json.dumps({**record, "scene": "</script><b>&amp;"}))
    (baked / "field.safetensors").rename(baked / 'a"b&c.safetensors')
    export(baked, "--single-file", tmp_path / "a.html")
    manifest, files = embedded((tmp_path / "a.html").read_text())
    assert manifest["title"] == "</script><b>&amp;"
    assert sorted(files) == sorted(urls(manifest))


def test_too_much_for_one_file_is_refused(export, baked: Path, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(web_single, "MAX_BYTES", 1000)
    code, said = export(baked, "--single-file", tmp_path / "a.html")
    assert code == 2
    assert "--web" in said["error"]["message"]
    assert not (tmp_path / "a.html").exists()


@pytest.mark.parametrize("tag", ["./viewer.js", "./viewer.css", '<meta charset="utf-8">', "</body>"])
def test_a_viewer_of_another_make_is_refused(
    export, baked: Path, viewer: Path, tmp_path: Path, tag: str
) -> None:
    page = (viewer / "index.html").read_text()
    (viewer / "index.html").write_text(page.replace(tag, "other"))
    code, said = export(baked, "--single-file", tmp_path / "a.html")
    assert code == 2
    assert "its page doesn't hold" in said["error"]["message"]


def test_a_viewer_of_more_parts_is_refused_as_one_file(
    export, baked: Path, viewer: Path, tmp_path: Path
) -> None:
    (viewer / "worker.js").write_text("")
    code, said = export(baked, "--single-file", tmp_path / "a.html")
    assert code == 2
    assert "worker.js" in said["error"]["message"]


def test_maps_of_sources_stay_at_home(site: Path, baked: Path, export, viewer: Path) -> None:
    (viewer / "viewer.js.map").write_text("{}")
    assert "viewer.js.map" not in web_viewer.find_viewer().files


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "Missing option"),
        (("-o", "a.bin"), "is a folder"),
        (("--web", "site", "-o", "a.bin"), "--out doesn't go"),
        (("--web", "site", "--finish", "int8"), "--finish doesn't go"),
        (("--web", "site", "--precision", "fp16"), "--precision doesn't go"),
        (("--single-file", "a.htmx"), "ends in .html"),
    ],
)
def test_choices_that_do_not_go_together(
    export, baked: Path, arguments: tuple[str, ...], message: str
) -> None:
    code, said = export(baked, *arguments)
    assert code == 2
    assert message in said["error"]["message"]


def test_further_weights_go_with_a_scene_for_the_web(export, viewer: Path, tmp_path: Path) -> None:
    code, said = export(WEIGHTS, "-o", tmp_path / "a.bin", "--field", WEIGHTS)
    assert code == 2
    assert "--field" in said["error"]["message"]


def test_a_scene_without_baked_light_is_refused(export, viewer: Path, tmp_path: Path) -> None:
    (tmp_path / "plain.glb").write_bytes(glb())
    code, said = export(tmp_path / "plain.glb", "--web", tmp_path / "site")
    assert code == 2
    assert "expected a baked scene" in said["error"]["message"]
    assert not (tmp_path / "site").exists()


def test_a_single_file_works_from_disk(export, baked: Path, tmp_path: Path, chromium: str) -> None:
    from irradia.cli.gallery_browser import open_page

    export(baked, "--single-file", tmp_path / "ä #1.html")
    with open_page(32, 32) as page:
        page.go((tmp_path / "ä #1.html").as_uri())
        page.wait_for("['ready', 'error'].includes(document.documentElement?.dataset.state)", 30.0)
        shown = json.loads(page.evaluate("document.body.textContent"))
        assert page.complaints == []
    manifest, files = embedded((tmp_path / "ä #1.html").read_text())
    assert shown["sizes"] == {url: len(files[url]) for url in urls(manifest)}
    assert shown["remark"] == "</script><!-- in a text"
