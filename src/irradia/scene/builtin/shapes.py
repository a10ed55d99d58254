"""Elementary surfaces: quads, boxes, cylinders, spheres. Fronts face outward; uv in metres."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from irradia.scene.builtin.mesh import Array, Mesh, drop_degenerate, grid, join


def quad(origin: ArrayLike, edge_u: ArrayLike, edge_v: ArrayLike, n_u: int = 1, n_v: int = 1) -> Mesh:
    """A parallelogram in n_u × n_v cells; its front is where edge_u × edge_v points."""
    origin, edge_u, edge_v = (np.asarray(x, np.float64) for x in (origin, edge_u, edge_v))
    s, t = np.meshgrid(np.linspace(0, 1, n_u + 1), np.linspace(0, 1, n_v + 1), indexing="ij")
    positions = origin + s[..., None] * edge_u + t[..., None] * edge_v
    normals = np.broadcast_to(np.cross(edge_u, edge_v), positions.shape)
    uv = np.stack([s * np.linalg.norm(edge_u), (1 - t) * np.linalg.norm(edge_v)], axis=-1)
    return grid(positions, normals, uv)


def face(corners: ArrayLike) -> Mesh:
    """A flat convex polygon from (N, 3) corners, counter-clockwise from its front, as a fan."""
    points = np.asarray(corners, np.float64)
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    normal /= np.linalg.norm(normal)
    u_axis = points[1] - points[0]
    u_axis = u_axis / np.linalg.norm(u_axis)
    v_axis = np.cross(normal, u_axis)
    offset = points - points[0]
    middle = np.arange(1, len(points) - 1)
    return Mesh(
        points,
        np.tile(normal, (len(points), 1)),
        np.stack([offset @ u_axis, -offset @ v_axis], axis=1),
        np.stack([np.zeros_like(middle), middle, middle + 1], axis=1).astype(np.uint32),
    )


def frame(outer: ArrayLike, inner: ArrayLike) -> Mesh:
    """A flat ring between two polygons of N corners each: N trapezoids that meet without T-junctions."""
    outer, inner = np.asarray(outer, np.float64), np.asarray(inner, np.float64)
    following = np.roll(np.arange(len(outer)), -1)
    return join(*(face([outer[k], outer[n], inner[n], inner[k]]) for k, n in enumerate(following)))


def floor(size_x: float, size_z: float, y: float = 0.0, n_x: int = 1, n_z: int = 1) -> Mesh:
    """A horizontal rectangle around the Y axis, front up."""
    return quad((-size_x / 2, y, size_z / 2), (size_x, 0, 0), (0, 0, -size_z), n_x, n_z)


def box(low: ArrayLike, high: ArrayLike) -> Mesh:
    """A closed box between two corners, flat faces: 24 vertices, 12 triangles."""
    low, high = np.asarray(low, np.float64), np.asarray(high, np.float64)
    (x0, y0, z0), (x1, y1, z1), (dx, dy, dz) = low, high, high - low
    faces = join(
        quad((x1, y0, z1), (0, 0, -dz), (0, dy, 0)),
        quad((x0, y0, z0), (0, 0, dz), (0, dy, 0)),
        quad((x0, y1, z1), (dx, 0, 0), (0, 0, -dz)),
        quad((x0, y0, z0), (dx, 0, 0), (0, 0, dz)),
        quad((x0, y0, z1), (dx, 0, 0), (0, dy, 0)),
        quad((x1, y0, z0), (-dx, 0, 0), (0, dy, 0)),
    )
    # Faces meet to the last bit: y0 + dy needs not be y1.
    nearer_high = np.abs(faces.positions - high) < np.abs(faces.positions - low)
    return replace(faces, positions=np.where(nearer_high, high, low))


def centred_box(size: ArrayLike, centre: ArrayLike = (0.0, 0.0, 0.0)) -> Mesh:
    """A closed box given by its size and centre."""
    size, centre = np.asarray(size, np.float64), np.asarray(centre, np.float64)
    return box(centre - size / 2, centre + size / 2)


def bevelled_box(low: ArrayLike, high: ArrayLike, bevel: float) -> Mesh:
    """A closed box whose edges are cut; shading runs smoothly from face to face across the cuts."""
    low, high = np.asarray(low, np.float64), np.asarray(high, np.float64)
    faces = box(low, high)
    # Each face shrinks within its plane; corners k and l of two faces then bound a cut.
    towards_middle = np.sign((low + high) / 2 - faces.positions) * (np.abs(faces.normals) < 0.5)
    positions = faces.positions + bevel * towards_middle
    cuts = [*_edge_cuts(faces.positions), *_corner_cuts(faces.positions)]
    turned = [_turn_outward(triangle, positions, (low + high) / 2) for triangle in cuts]
    return Mesh(positions, faces.normals, faces.uv, np.concatenate([faces.indices, turned]).astype(np.uint32))


def _edge_cuts(corners: Array) -> list[tuple[int, ...]]:
    """Two triangles for each edge of a 24-vertex box, between the two faces that share it."""
    cuts: list[tuple[int, ...]] = []
    for first, second in itertools.combinations(range(0, 24, 4), 2):
        shared = [
            (k, m)
            for k in range(first, first + 4)
            for m in range(second, second + 4)
            if np.array_equal(corners[k], corners[m])
        ]
        if shared:
            (a, b), (c, d) = shared
            cuts += [(a, b, c), (c, b, d)]
    return cuts


def _corner_cuts(corners: Array) -> list[tuple[int, ...]]:
    """One triangle for each corner of a 24-vertex box."""
    _, corner = np.unique(corners, axis=0, return_inverse=True)
    return [tuple(np.flatnonzero(corner.reshape(-1) == k).tolist()) for k in range(8)]


def _turn_outward(triangle: tuple[int, ...], positions: Array, centre: Array) -> tuple[int, ...]:
    a, b, c = positions[list(triangle)]
    outward = np.cross(b - a, c - a) @ (a - centre) > 0
    return triangle if outward else triangle[::-1]


def disc(radius: float, y: float, n_sides: int, up: bool = True) -> Mesh:
    """A flat regular polygon, its vertices on the circle, facing up or down."""
    rim = radius * circle(n_sides)[:-1] + [0.0, y, 0.0]
    return face(rim if up else rim[::-1])


def cylinder(radius: float, height: float, n_sides: int, capped: bool = True) -> Mesh:
    """An upright cylinder on the XZ plane: smooth round its side, flat caps."""
    radial, angle = circle(n_sides), np.linspace(0, 2 * np.pi, n_sides + 1)
    normals = np.stack([radial, radial], axis=1)
    positions = radius * normals
    positions[:, 1, 1] = height
    uv = np.stack(np.broadcast_arrays(radius * angle[:, None], np.array([height, 0.0])), axis=-1)
    side = grid(positions, normals, uv)
    if not capped:
        return side
    return join(side, disc(radius, height, n_sides), disc(radius, 0.0, n_sides, up=False))


def cone(radius: float, height: float, n_sides: int) -> Mesh:
    """An upright cone with a base, smooth round its side."""
    radial, angle = circle(n_sides), np.linspace(0, 2 * np.pi, n_sides + 1)
    slope = np.array([height, radius]) / np.hypot(radius, height)
    normals = np.repeat((radial * slope[0] + [0, slope[1], 0])[:, None], 2, axis=1)
    positions = np.stack([radius * radial, np.broadcast_to([0.0, height, 0.0], radial.shape)], axis=1)
    uv = np.stack(
        np.broadcast_arrays(radius * angle[:, None], np.array([np.hypot(radius, height), 0.0])), axis=-1
    )
    return join(drop_degenerate(grid(positions, normals, uv)), disc(radius, 0.0, n_sides, up=False))


def sphere(radius: float, n_sides: int, n_rings: int) -> Mesh:
    """A latitude-longitude sphere around the origin, smooth."""
    colatitude = np.linspace(np.pi, 0, n_rings + 1)
    ring = np.sin(colatitude) * (np.arange(n_rings + 1) % n_rings != 0)
    normals = circle(n_sides)[:, None] * ring[:, None] + np.cos(colatitude)[:, None] * [0.0, 1.0, 0.0]
    longitude = np.linspace(0, 2 * np.pi, n_sides + 1)
    uv = radius * np.stack(np.meshgrid(longitude, colatitude, indexing="ij"), axis=-1)
    return drop_degenerate(grid(radius * normals, normals, uv))


def circle(n_sides: int) -> Array:
    """(n_sides + 1, 3) unit vectors from +Z, counter-clockwise seen from above; last = first, exactly."""
    angle = 2 * np.pi * (np.arange(n_sides + 1) % n_sides) / n_sides
    return np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)
