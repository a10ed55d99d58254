"""What is installed, what is pinned and what is credited are the same."""

from __future__ import annotations

import json
import re
import tomllib
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

import pytest

# Licences as package metadata spells them, by the identifier that THIRD_PARTY.md uses.
SPELLINGS = {
    "Apache-2.0": ("Apache",),
    "BSD-2-Clause": ("BSD",),
    "BSD-3-Clause": ("BSD",),
    "MIT": ("MIT",),
    "MIT-0": ("MIT-0",),
    "MIT-CMU": ("MIT-CMU",),
    "MPL-2.0": ("MPL", "Mozilla"),
    "PSF-2.0": ("PSF", "Python Software Foundation"),
    "Apache-2.0 OR BSD-2-Clause": ("Apache-2.0 OR BSD-2-Clause",),
}
SAYS_NOTHING = frozenset({"openexr", "rendercanvas"})  # their licences are in their licence files alone


def _normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def _section(text: str, title: str) -> dict[str, str]:
    """Package to licence, of one table of Python packages."""
    return {_normal(name): licence for name, licence in _table(text, title).items()}


def _table(text: str, title: str) -> dict[str, str]:
    body = text.split(f"## {title}\n", 1)[1].split("\n## ", 1)[0]
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in body.splitlines() if "|" in line
    ]
    return {row[0]: row[1] for row in rows[2:]}


@pytest.fixture(scope="module")
def text(repo_root: Path) -> str:
    return (repo_root / "THIRD_PARTY.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def credited(text) -> dict[str, str]:
    titles = ("What running needs", "What these bring along", "What developing needs")
    return {name: licence for title in titles for name, licence in _section(text, title).items()}


@pytest.fixture(scope="module")
def pinned(repo_root: Path) -> set[str]:
    lines = (repo_root / "constraints.txt").read_text(encoding="utf-8").splitlines()
    return {_normal(line.split("==")[0]) for line in lines}


@pytest.fixture(scope="module")
def declared(repo_root: Path) -> dict[str, set[str]]:
    project = tomllib.loads((repo_root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    names = {"core": project["dependencies"], **project["optional-dependencies"]}
    return {key: {_normal(re.split(r"[<>=!~\[; ]", n)[0]) for n in group} for key, group in names.items()}


def test_every_pinned_package_is_credited_and_the_reverse(credited, pinned):
    assert set(credited) == pinned


def test_the_core_table_is_the_core_install(text, declared):
    assert set(_section(text, "What running needs")) == declared["core"]


def test_every_declared_package_is_pinned(declared, pinned):
    assert set().union(*declared.values()) <= pinned


def test_every_package_of_web_is_credited_with_its_locked_licence(text, repo_root):
    web = repo_root / "web"
    package = json.loads((web / "package.json").read_text(encoding="utf-8"))
    locked = json.loads((web / "package-lock.json").read_text(encoding="utf-8"))["packages"]
    wanted = {**package.get("dependencies", {}), **package.get("devDependencies", {})}
    found = {name: locked[f"node_modules/{name}"]["license"] for name in wanted}
    assert _table(text, "What web/ needs") == found


def test_pins_are_exact_and_name_no_address(repo_root):
    for line in (repo_root / "constraints.txt").read_text(encoding="utf-8").splitlines():
        assert re.fullmatch(r"[A-Za-z0-9_.-]+==[A-Za-z0-9_.]+", line), line


def test_credited_licences_are_the_installed_ones(credited):
    for name, licence in credited.items():
        try:
            found = metadata(name)
        except PackageNotFoundError:
            pytest.fail(f"{name} is credited but not installed: run make setup-dev")
        stated = [found.get("License-Expression"), found.get("License"), *found.get_all("Classifier", [])]
        stated = " ".join(s for s in stated if s and ("License" in s or "::" not in s))
        if name not in SAYS_NOTHING:
            assert any(spelling in stated for spelling in SPELLINGS[licence]), (name, licence, stated[:120])


def test_no_licence_forbids_shipping_beside_apache(credited):
    assert not [name for name, licence in credited.items() if "GPL" in licence]
