"""What every layer may use: errors, randomness, files, progress, provenance, the device."""

from irradia.core.errors import (
    InputError,
    InternalError,
    IrradiaError,
    MissingDependencyError,
)
from irradia.core.files import write_atomic, write_text_atomic
from irradia.core.progress import Progress, silent_progress
from irradia.core.rng import Seed

__all__ = [
    "InputError",
    "InternalError",
    "IrradiaError",
    "MissingDependencyError",
    "Progress",
    "Seed",
    "silent_progress",
    "write_atomic",
    "write_text_atomic",
]
