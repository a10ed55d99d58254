"""Light probes: where they stand, what light they see, and how to read between them."""

from irradia.bake.probes.gather import bake_probes
from irradia.bake.probes.interpolation import interpolate, irradiance_at
from irradia.bake.probes.options import ProbeOptions

__all__ = ["ProbeOptions", "bake_probes", "interpolate", "irradiance_at"]
