"""Irradia: bakes the light of a glTF scene into lightmaps, probes and neural fields."""

__version__ = "0.1.0"
