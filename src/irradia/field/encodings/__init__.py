"""The catalogue of encodings, one a file; :mod:`irradia.field.registry` lists them by name."""

from irradia.field.encodings.composite import Composite
from irradia.field.encodings.frequency import Frequency
from irradia.field.encodings.hash_grid import HashGrid
from irradia.field.encodings.identity import Identity
from irradia.field.encodings.one_blob import OneBlob
from irradia.field.encodings.spherical_harmonics import SphericalHarmonics
from irradia.field.encodings.tri_plane import TriPlane

__all__ = ["Composite", "Frequency", "HashGrid", "Identity", "OneBlob", "SphericalHarmonics", "TriPlane"]
