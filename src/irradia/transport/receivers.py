"""Points that light is gathered at: on surfaces, or in free space under a normal of their own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.geometry import SurfacePoint
from irradia.transport.world import World

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class Receivers:
    """N points on the host, ready to be looked around from.

    Attributes:
        positions: (N, 3) metres.
        normals: (N, 3) unit shading normals, which cosines are measured from.
        origins: (N, 3) where rays start: on surfaces lifted off them as :class:`SurfacePoint` says.
        geometric: (N, 3) unit geometric normals; light from below their plane doesn't count.
        lod: (N,) level of detail of the surface; 0 where nothing has any.
    """

    positions: F32
    normals: F32
    origins: F32
    geometric: F32
    lod: NDArray[np.uint32]

    def __len__(self) -> int:
        return len(self.positions)

    @staticmethod
    def in_space(positions: F32, normals: F32) -> Receivers:
        """Points on no surface: (N, 3) metres and (N, 3) unit normals."""
        return Receivers(positions, normals, positions, normals, np.zeros(len(positions), np.uint32))

    @staticmethod
    def join(parts: Sequence[Receivers]) -> Receivers:
        """All points of at least one part, in order."""
        return Receivers(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Receivers)))

    def take(self, chosen: NDArray | slice) -> Receivers:
        """Some of the points, by mask, numbers or slice."""
        return Receivers(*(getattr(self, f.name)[chosen] for f in fields(Receivers)))


def surface_receivers(
    world: World, triangle: NDArray[np.uint32], bary: F32, back: NDArray[np.bool_]
) -> tuple[Receivers, F32]:
    """Points on surfaces.

    Args:
        world: The scene.
        triangle: (N,) of the merged mesh.
        bary: (N, 2) weights of the second and third corner.
        back: (N,) which side is meant.

    Returns:
        The points, and (N,) the share of the surface that is there at all: alpha after its mode.
    """
    number, place = mi.UInt32(triangle), mi.Point2f(*columns(bary))
    active = mi.Bool(True)
    point = world.geometry.point(number, place, active, back=mi.Bool(back))
    covers = mi.Float(1.0)
    if world.filters:
        covers = world.appearance(number, place, active).coverage
    covers = covers + dr.zeros(mi.Float, len(triangle))
    lod = dr.zeros(mi.UInt32, len(triangle)) + (0 if point.lod is None else point.lod)
    dr.eval(point.position, point.ns, point.origin, point.ng, covers, lod)
    vectors = (_rows(v) for v in (point.position, point.ns, point.origin, point.ng))
    return Receivers(*vectors, lod=np.array(lod)), np.array(covers)


@dataclass
class DeviceReceivers:
    """The same points on the device.

    Attributes:
        origin, normal, geometric: A column each.
        lod: None where the scene has no levels of detail.
    """

    origin: mi.Point3f
    normal: mi.Vector3f
    geometric: mi.Vector3f
    lod: mi.UInt32 | None

    @staticmethod
    def of(world: World, receivers: Receivers) -> DeviceReceivers:
        """Uploads what rays need of them."""
        return DeviceReceivers(
            mi.Point3f(*columns(receivers.origins)),
            mi.Vector3f(*columns(receivers.normals)),
            mi.Vector3f(*columns(receivers.geometric)),
            mi.UInt32(np.ascontiguousarray(receivers.lod)) if world.geometry.has_lods else None,
        )

    def fetch(self, number: mi.UInt32) -> SurfacePoint:
        """One point a lane; where light from behind counts is for materials to say, and not asked here."""
        origin = dr.gather(mi.Point3f, self.origin, number)
        return SurfacePoint(
            position=origin,
            origin=origin,
            ng=dr.gather(mi.Vector3f, self.geometric, number),
            ns=dr.gather(mi.Vector3f, self.normal, number),
            lod=None if self.lod is None else dr.gather(mi.UInt32, self.lod, number),
        )


def columns(rows: NDArray) -> list[mi.Float]:
    """The columns of (N, k) on the device, each for itself: split there, N would be part of the kernel."""
    return [mi.Float(np.ascontiguousarray(column, np.float32)) for column in rows.T]


def _rows(vector: mi.Vector3f) -> F32:
    return np.ascontiguousarray(np.array(vector).T, np.float32)
