"""The ways to compute fields, loaded when they are asked for.

To add one, derive from :class:`irradia.field.backend.Backend` in a module here and give it a line in
``BACKENDS``. Its constructor takes the number of threads, or None for all that the process may use.
"""

from __future__ import annotations

import importlib
import importlib.util

from irradia.core.device import cuda_status
from irradia.core.errors import InputError, MissingDependencyError
from irradia.core.names import did_you_mean
from irradia.field.backend import Backend
from irradia.field.registry import ENCODINGS
from irradia.field.spec import FieldSpec

BACKENDS = {  # fastest first: name → module here, class, library that it needs
    "drjit": ("drjit_backend", "DrJitBackend", "drjit"),
    "numba": ("numba_backend", "NumbaBackend", "numba"),
    "numpy": ("numpy_backend", "NumpyBackend", "numpy"),
}
ON_GPU = frozenset({"drjit"})  # chosen by hand only where there is none


def backend(name: str = "auto", spec: FieldSpec | None = None, threads: int | None = None) -> Backend:
    """Finds what computes a field.

    Args:
        name: A backend's name; or ``auto``, which is the fastest here that can do the spec: Dr.Jit where
            there is a GPU, else Numba, else NumPy.
        spec: What will be computed; None asks for no more than that the backend exists.
        threads: Of the CPU; None takes all that this process may use.

    Raises:
        InputError: If there is no such backend, or it can't do the spec.
        MissingDependencyError: If its library isn't installed.
    """
    if name == "auto":
        return _fastest(spec, threads)
    found = _load(name, threads)
    if spec is not None and (lack := found.lacks(spec)):
        raise InputError(
            f"{name} can't compute this field: {lack}", where="--backend", fix="Use --backend auto."
        )
    return found


def available() -> list[str]:
    """Names of the backends whose libraries are installed."""
    return [name for name in BACKENDS if _is_there(name)]


def matrix() -> dict[str, dict[str, bool]]:
    """Which backend can compute which encoding, asked of the backends themselves: ``[encoding][backend]``."""
    loaded = {name: _load(name) for name in available()}
    return {
        encoding: {
            name: not loaded[name].lacks(_probe(encoding)) if name in loaded else False for name in BACKENDS
        }
        for encoding in ENCODINGS
    }


def matrix_text() -> str:
    """:func:`matrix` as a table to print."""
    rows = [["encoding", *BACKENDS]]
    rows += [[name, *("yes" if can else "–" for can in row.values())] for name, row in matrix().items()]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
    return "\n".join(lines) + "\n"


def _fastest(spec: FieldSpec | None, threads: int | None) -> Backend:
    on_gpu = cuda_status().gpu is not None
    names = [name for name in available() if on_gpu or name not in ON_GPU]
    candidates = (_load(name, threads) for name in names)
    return next(found for found in candidates if spec is None or not found.lacks(spec))


def _is_there(name: str) -> bool:
    module, _, library = BACKENDS[name]
    return all(importlib.util.find_spec(needed) for needed in (library, f"{__name__}.{module}"))


def _load(name: str, threads: int | None = None) -> Backend:
    if name not in BACKENDS:
        raise InputError(f"no backend {name!r}", where="--backend", fix=did_you_mean(name, BACKENDS))
    module, class_name, library = BACKENDS[name]
    if not _is_there(name):
        raise MissingDependencyError(
            f"the backend {name} needs {library}", where="--backend", fix=f"pip install {library}"
        )
    return getattr(importlib.import_module(f"{__name__}.{module}"), class_name)(threads)


def _probe(encoding: str) -> FieldSpec:
    """A field that stands or falls with one encoding."""
    return FieldSpec(ENCODINGS[encoding](), mode="sh1", head="linear")
