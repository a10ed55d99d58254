"""The one tree of errors.

    IrradiaError
    ├── InputError               the user's file or option is wrong        (exit code 2)
    ├── MissingDependencyError   the machine lacks something we need       (exit code 2)
    └── InternalError            we broke a promise of our own             (exit code 1)

A message says what was expected, what was found, where, and what to do about it.
"""

from __future__ import annotations


class IrradiaError(Exception):
    """Base of everything that Irradia raises on purpose."""

    exit_code = 1


class InputError(IrradiaError):
    """A file or option is not what it should be.

    Args:
        message: What was expected and what was found.
        where: A file name, an option, or a JSON pointer such as ``/materials/3``.
        fix: What the user can do.
    """

    exit_code = 2

    def __init__(self, message: str, *, where: str | None = None, fix: str | None = None) -> None:
        self.message = message
        self.where = where
        self.fix = fix
        text = f"{where}: {message}" if where else message
        super().__init__(f"{text}\n  {fix}" if fix else text)


class MissingDependencyError(InputError):
    """A library or program that this command needs is absent; ``fix`` holds the install line."""


class InternalError(IrradiaError):
    """A promise between our own parts was broken; please report it."""
