"""Rectangles in space, and the light that arrives at a point of one: for tests of transport alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from irradia.scene.merge import merge
from irradia.scene.types import Environment, Instance, Light, Material, Primitive, Scene

BLACK = Material("black", base_color=(0.0, 0.0, 0.0, 1.0), metallic=0.0, specular=0.0)


def matte(value: float, **fields: Any) -> Material:
    """A grey diffuse material."""
    return Material("matte", base_color=(value, value, value, 1.0), metallic=0.0, specular=0.0, **fields)


@dataclass(frozen=True)
class Sheet:
    """A rectangle parallel to the floor, around the Y axis.

    Attributes:
        up: Whether its front is on top.
        instance: Fields of :class:`Instance`.
    """

    material: Material
    y: float = 0.0
    width: float = 1.0
    depth: float = 1.0
    up: bool = True
    instance: dict[str, Any] = field(default_factory=dict)


def stacked(
    sheets: Sequence[Sheet], lights: tuple[Light, ...] = (), environment: Environment | None = None
) -> Scene:
    """A scene of sheets; triangles 2 i and 2 i + 1 are those of sheet i."""
    primitives = tuple(_primitive(sheet, index) for index, sheet in enumerate(sheets))
    instances = tuple(
        replace(Instance(index, np.eye(4), index), **sheet.instance) for index, sheet in enumerate(sheets)
    )
    materials = tuple(sheet.material for sheet in sheets)
    return Scene("stacked", primitives, instances, materials, (), lights=lights, environment=environment)


def _primitive(sheet: Sheet, index: int) -> Primitive:
    x, z = sheet.width / 2, sheet.depth / 2
    corners = np.float32([[-x, sheet.y, -z], [-x, sheet.y, z], [x, sheet.y, z], [x, sheet.y, -z]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    return Primitive(
        positions=corners,
        normals=np.tile(np.float32([0, 1 if sheet.up else -1, 0]), (4, 1)),
        texcoords=(np.float32([[0, 0], [0, 1], [1, 1], [1, 0]]),),
        colors=None,
        indices=triangles if sheet.up else triangles[:, ::-1].copy(),
        material=index,
        mesh_index=index,
        primitive_index=0,
        vertex_source=np.arange(4, dtype=np.uint32),
    )


def world_of(scene: Scene):
    """The scene ready for light."""
    from irradia.transport.world import World

    return World(scene, merge(scene))


def hit_below(world, y: float = 10.0, lod: int | None = None):
    """What a ray straight down from (0.1, y, 0.05) meets: (triangle, height), or None."""
    return _hit(world, mi_point(0.1, y, 0.05), -1.0, lod)


def hit_above(world, y: float = -10.0, lod: int | None = None):
    """What a ray straight up meets."""
    return _hit(world, mi_point(0.1, y, 0.05), 1.0, lod)


def mi_point(x: float, y: float, z: float):
    """A point on the device."""
    from irradia.transport.backend import mi

    return mi.Point3f(x, y, z)


def _hit(world, origin, direction: float, lod: int | None):
    from irradia.transport.backend import mi

    level = None if lod is None else mi.UInt32(lod)
    hit = world.geometry.intersect(origin, mi.Vector3f(0, direction, 0), mi.Bool(True), level)
    if not np.array(hit.valid)[0]:
        return None
    height = np.array(origin.y)[0] + direction * np.array(hit.t)[0]
    return int(np.array(hit.triangle)[0]), float(height)


def irradiance_over_pi(world, triangle: int, n: int = 1 << 14) -> np.ndarray:
    """(3,) E/π at the sheet's centre, by as many gather rays as next-event samples."""
    from irradia.transport.backend import dr, mi
    from irradia.transport.path import direct, draw_ray, start, trace
    from irradia.transport.sampling import Sampler

    number = dr.arange(mi.UInt32, n)
    point = world.point(mi.UInt32(triangle) + 0 * number, _centre(world, triangle), mi.Bool(True))
    sampler = Sampler(number, mi.UInt32(3))
    leaving = draw_ray(point, sampler)
    ray = start(
        leaving.origin, leaving.direction, leaving.pdf, mi.Float(1.0), sampler, leaving.above, point.lod
    )
    light = leaving.weight * trace(world, ray).radiance
    light += direct(world, point, Sampler(number, mi.UInt32(4)), mi.Float(1.0), mi.Bool(True)).light
    return np.array(light, np.float64).mean(axis=1)


def _centre(world, triangle: int):
    """Barycentrics of the sheet's centre, which is the middle of its triangles' longest edges."""
    from irradia.transport.backend import mi

    def distance(bary: tuple[float, float]) -> float:
        place = world.point(mi.UInt32(triangle), mi.Point2f(*bary), mi.Bool(True)).position
        return float(np.hypot(np.array(place.x)[0], np.array(place.z)[0]))

    return mi.Point2f(*min(((0.5, 0.0), (0.0, 0.5), (0.5, 0.5)), key=distance))


def form_factor(width: float, depth: float, height: float) -> float:
    """From an element to a parallel rectangle centred above it (Howell, B-3)."""
    x, z = width / 2 / height, depth / 2 / height
    rx, rz = np.sqrt(1 + x**2), np.sqrt(1 + z**2)
    return 4 * (x / rx * np.arctan(z / rx) + z / rz * np.arctan(x / rz)) / (2 * np.pi)
