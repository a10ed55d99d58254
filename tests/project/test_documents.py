"""What the documents point to and promise is there."""

from __future__ import annotations

import re
from pathlib import Path

import click
import pytest

from irradia.cli import app

DOCUMENTS = ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/conventions.md")


@pytest.fixture(params=DOCUMENTS)
def document(request, repo_root: Path) -> Path:
    return repo_root / request.param


def test_every_link_leads_somewhere(document):
    for target in re.findall(r"\]\(([^)#]+)", document.read_text(encoding="utf-8")):
        if not target.startswith("https://"):
            assert (document.parent / target).exists(), target


def test_every_source_file_that_is_named_exists(document, repo_root):
    for name in re.findall(
        r"`((?:src/irradia/|cli/|core/|scene/|bake/|transport/|report/)[\w/]+\.py)`",
        document.read_text(encoding="utf-8"),
    ):
        path = repo_root / (name if name.startswith("src/") else f"src/irradia/{name}")
        assert path.exists() or "NAME" in name, name


def test_every_command_line_of_the_readme_is_understood(repo_root):
    text = (repo_root / "README.md").read_text(encoding="utf-8")
    lines = re.findall(r"^    irradia (.+?)(?: {2,}#.*)?$", text, re.MULTILINE)
    assert len(lines) >= 7
    for line in lines:
        name, *arguments = line.split()
        command = app.group.get_command(click.Context(app.group), name)
        assert command is not None, line
        flags = {flag for parameter in command.params for flag in parameter.opts}
        assert {a for a in arguments if a.startswith("-")} <= flags, line


def test_every_command_is_in_the_readme(repo_root):
    text = (repo_root / "README.md").read_text(encoding="utf-8")
    assert [
        name for name in app.COMMANDS if f"irradia {name}" not in text and f"make {name}" not in text
    ] == []


def test_every_make_target_that_is_named_exists(document, repo_root):
    makefile = (repo_root / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([\w-]+):", makefile, re.MULTILINE))
    named = re.findall(r"(?:^    |`)make ([\w-]+)", document.read_text(encoding="utf-8"), re.MULTILINE)
    assert set(named) <= targets
