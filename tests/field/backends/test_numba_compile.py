"""How kernels are compiled."""

from __future__ import annotations

import ast
from importlib.util import find_spec
from pathlib import Path

from irradia.field.backends import numba_compile

# Classes of errors, and how many threads there are: nothing that is compiled.
NOT_COMPILED = {"irradia.core.errors", "irradia.core.device"}


def test_compiled_code_is_stamped_by_every_file_that_kernels_take_anything_from():
    stamped = set(numba_compile.stamped_files())
    kernels = sorted(Path(numba_compile.__file__).parent.glob("numba_*.py"))
    assert stamped >= set(kernels)
    for kernel in kernels:
        for module in imported(kernel) - NOT_COMPILED:
            assert file_of(module) in stamped, f"{module}, which {kernel.name} imports"


def imported(file):
    """Modules of ours that a file names, wherever in it; what it takes from packages may be modules."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("irradia"):
            inside = [f"{node.module}.{name.name}" for name in node.names if is_package(node.module)]
            found |= {each for each in inside if is_module(each)} or {node.module}
    return found


def is_package(module):
    return find_spec(module).submodule_search_locations is not None


def is_module(name):
    return find_spec(name) is not None


def file_of(module):
    return Path(find_spec(module).origin)


def test_a_changed_constant_makes_another_stamp(monkeypatch, tmp_path):
    constants = tmp_path / "losses.py"
    monkeypatch.setattr(numba_compile, "stamped_files", lambda: [constants])
    stamps = []
    for text in ("EPSILON = 0.01", "EPSILON = 0.02"):
        constants.write_text(text)
        stamps.append(numba_compile._stamp())
    assert stamps[0] != stamps[1]
