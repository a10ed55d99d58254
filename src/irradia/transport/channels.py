"""What a bake keeps of each sample: E/π, and whatever else was asked for, in channels of one colour."""

from __future__ import annotations

from dataclasses import dataclass

from irradia.transport.backend import dr, mi
from irradia.transport.frames import Frame
from irradia.transport.hemispheres import COSINE, MIXED, Hemisphere
from irradia.transport.moments import Moments
from irradia.transport.path import Arrival

MAP = 0  # the channel of the map itself


@dataclass(frozen=True)
class Channels:
    """The channels, in order: the map; the first bounce of lights that are lit live; what a clamp has
    cut off; directional moments.

    Attributes:
        live: Whether any light is lit live. Its first bounce lights the scene, not the map.
        clamp: Largest radiance that a gather ray may bring, or None.
        moments: Directional moments of the map, or None.
    """

    live: bool = False
    clamp: float | None = None
    moments: Moments | None = None

    @property
    def count(self) -> int:
        """How many."""
        return 1 + self.live + (self.clamp is not None) + (self.moments.n_colours if self.moments else 0)

    @property
    def clamped_off(self) -> int:
        """The channel of what a clamp has cut off."""
        return 1 + self.live

    @property
    def first_moment(self) -> int:
        """The channel of the first moment."""
        return self.count - (self.moments.n_colours if self.moments else 0)

    @property
    def hemisphere(self) -> Hemisphere:
        """What gather rays are drawn from: moments lack the cosine and need grazing rays as well."""
        return COSINE if self.moments is None else MIXED

    def zeros(self) -> list[mi.Color3f]:
        """A lane's empty sums."""
        return [mi.Color3f(0.0) for _ in range(self.count)]

    def of_ray(self, light: mi.Color3f, direction: mi.Vector3f, frame: Frame) -> list[mi.Color3f]:
        """What a gather ray adds.

        Args:
            light: To E/π.
            direction: Where it comes from.
            frame: At the receiver.
        """
        extra = [mi.Color3f(0.0)] if self.live else []
        if self.clamp is not None:
            brightest = dr.max(light)
            share = dr.minimum(dr.opaque(mi.Float, self.clamp) / dr.maximum(brightest, 1e-30), 1.0)
            extra.append(light * (1.0 - share))
            light = light * share
        return [light, *extra, *self._moments(light, direction, frame)]

    def of_arrival(self, arrival: Arrival, frame: Frame) -> list[mi.Color3f]:
        """What a next-event sample adds."""
        light, extra = arrival.light, []
        if self.live:
            extra.append(dr.select(arrival.live, light, 0.0))
            light = dr.select(arrival.live, 0.0, light)
        if self.clamp is not None:
            extra.append(mi.Color3f(0.0))
        return [light, *extra, *self._moments(light, arrival.direction, frame)]

    def _moments(self, light: mi.Color3f, direction: mi.Vector3f, frame: Frame) -> list[mi.Color3f]:
        return [] if self.moments is None else self.moments.terms(light, direction, frame)
