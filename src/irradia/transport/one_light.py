"""One punctual light at a time, where next-event estimation would choose among all of them."""

from __future__ import annotations

from irradia.transport.backend import dr, mi
from irradia.transport.geometry import Geometry, SurfacePoint
from irradia.transport.lights import Emission, Lights, LightSample
from irradia.transport.punctual import PunctualLights


class OneLight(Lights):
    """Every sample is of the same light, so that nothing is noise but a place on its disc or sphere.

    Args:
        lights: The light is one of them.
        index: Which; kernels are the same for all.
    """

    def __init__(self, lights: PunctualLights, index: int) -> None:
        super().__init__(lights)
        self.any = True
        self._lights, self._index = lights, dr.opaque(mi.UInt32, index)

    def sample(
        self,
        geometry: Geometry,
        emission: Emission,
        point: SurfacePoint,
        pick: mi.Float,
        u: mi.Point2f,
        active: mi.Bool,
    ) -> LightSample:
        """See :meth:`Lights.sample`."""
        direction, distance, irradiance = self._lights.sample_one(point.origin, self._index, u, active)
        return LightSample(direction, distance, irradiance, mi.Float(0.0), mi.UInt32(self._index))
