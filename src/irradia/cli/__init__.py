"""The command line: wiring only, one file per command."""

from irradia.cli.app import main

__all__ = ["main"]
