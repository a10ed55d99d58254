"""Baked scenes for engines and viewers."""

from irradia.export.glb import write_baked_glb

__all__ = ["write_baked_glb"]
