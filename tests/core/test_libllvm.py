"""The search for a libLLVM that works."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from irradia.core import libllvm
from irradia.core.errors import InputError, MissingDependencyError
from irradia.core.libllvm import Candidate


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("IRRADIA_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def only(monkeypatch):
    """Makes the search see just these folders."""

    def limit(*folders: Path) -> None:
        monkeypatch.delenv(libllvm.VARIABLE, raising=False)
        monkeypatch.setattr(libllvm, "_folders", lambda: list(folders))

    return limit


@pytest.mark.parametrize(
    ("name", "major"),
    [
        ("/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1", 19),
        ("/usr/lib/x86_64-linux-gnu/libLLVM-15.so.1", 15),
        ("/usr/lib/llvm-20/lib/libLLVM.so", 20),
        ("/opt/homebrew/opt/llvm@18/lib/libLLVM.dylib", 18),
        ("/opt/homebrew/opt/llvm/lib/libLLVM.dylib", None),
        ("C:/Program Files/LLVM/bin/LLVM-C.dll", None),
    ],
)
def test_version_is_read_from_the_name_or_the_folders(name, major):
    assert libllvm.major_version(Path(name)) == major


def test_candidates_come_newest_first_and_once(tmp_path, only):
    for name in ("libLLVM-15.so.1", "libLLVM.so.19.1", "libLLVM-20.so"):
        (tmp_path / name).write_bytes(b"")
    (tmp_path / "libLLVM-19.so").symlink_to(tmp_path / "libLLVM.so.19.1")
    only(tmp_path)
    assert [c.major for c in libllvm.candidates()] == [20, 19, 15]


def test_an_old_version_is_refused_without_loading_it(tmp_path, monkeypatch):
    monkeypatch.setattr(libllvm, "probe", lambda path: pytest.fail("an old library was probed"))
    verdict = libllvm.judge(Candidate(tmp_path / "libLLVM-16.so", 16))
    assert not verdict.works
    assert "older than 17" in verdict.reason


def test_a_file_that_is_no_library_is_refused_by_its_probe(tmp_path, cache):
    fake = tmp_path / "libLLVM.so.99"
    fake.write_bytes(b"not a library")
    verdict = libllvm.judge(Candidate(fake, 99))
    assert not verdict.works
    assert verdict.reason.startswith("its probe ended with code")


def test_the_machines_library_computes_right_numbers():
    found = libllvm.find_libllvm()
    assert libllvm.probe(found.candidate.path) == ""


def test_a_yes_is_remembered_until_the_file_changes(tmp_path, cache, monkeypatch):
    asked = []
    monkeypatch.setattr(libllvm, "probe", lambda path: asked.append(path) or "")
    library = tmp_path / "libLLVM.so.99"
    library.write_bytes(b"one")
    for _ in range(3):
        assert libllvm.judge(Candidate(library, 99)).works
    assert len(asked) == 1
    library.write_bytes(b"changed")
    libllvm.judge(Candidate(library, 99))
    assert len(asked) == 2


def test_a_no_is_asked_again(tmp_path, cache, monkeypatch):
    answers = iter(["killed", ""])
    monkeypatch.setattr(libllvm, "probe", lambda path: next(answers))
    library = tmp_path / "libLLVM.so.99"
    library.write_bytes(b"")
    assert not libllvm.judge(Candidate(library, 99)).works
    assert libllvm.judge(Candidate(library, 99)).works


def test_a_damaged_memory_is_forgotten(tmp_path, cache, monkeypatch):
    cache.mkdir()
    (cache / "libllvm.json").write_text("{ broken")
    monkeypatch.setattr(libllvm, "probe", lambda path: "")
    library = tmp_path / "libLLVM.so.99"
    library.write_bytes(b"")
    assert libllvm.judge(Candidate(library, 99)).works


def test_a_newer_library_that_fails_gives_way_to_an_older_one(tmp_path, only, cache, monkeypatch):
    for name in ("libLLVM.so.98", "libLLVM.so.99"):
        (tmp_path / name).write_bytes(b"")
    only(tmp_path)
    monkeypatch.setattr(libllvm, "probe", lambda path: "aborts" if path.suffix == ".99" else "")
    assert libllvm.find_libllvm().candidate.major == 98


def test_without_any_library_the_message_says_what_to_install(tmp_path, only):
    only(tmp_path)
    with pytest.raises(MissingDependencyError, match="none was found") as caught:
        libllvm.find_libllvm()
    assert caught.value.fix == libllvm.install_line()


def test_libraries_that_fail_are_listed_with_the_reason(tmp_path, only):
    (tmp_path / "libLLVM-15.so").write_bytes(b"")
    only(tmp_path)
    with pytest.raises(MissingDependencyError, match=r"libLLVM-15\.so: LLVM 15 is older"):
        libllvm.find_libllvm()


def test_the_variable_decides_alone(tmp_path, monkeypatch):
    monkeypatch.setenv(libllvm.VARIABLE, str(tmp_path / "absent.so"))
    with pytest.raises(InputError, match="no such library"):
        libllvm.find_libllvm()
    old = tmp_path / "libLLVM-14.so"
    old.write_bytes(b"")
    monkeypatch.setenv(libllvm.VARIABLE, str(old))
    with pytest.raises(InputError, match="older than 17"):
        libllvm.find_libllvm()


def test_the_module_itself_never_loads_dr_jit():
    import subprocess
    import sys

    code = "import irradia.core.device, sys; sys.exit(any(m in sys.modules for m in ('drjit', 'mitsuba')))"
    assert subprocess.run([sys.executable, "-c", code], env=os.environ, check=False).returncode == 0


def test_the_reason_is_the_first_of_a_chain_of_errors():
    from irradia.core.llvm_probe import root_cause

    def import_with_a_missing_library():
        try:
            raise ImportError("libatomic.so.1: cannot open shared object file")
        except ImportError:
            raise NameError("name '_drjit_ext' is not defined")  # noqa: B904 - as Dr.Jit does

    with pytest.raises(NameError) as caught:
        import_with_a_missing_library()
    assert root_cause(caught.value) == "ImportError: libatomic.so.1: cannot open shared object file"
