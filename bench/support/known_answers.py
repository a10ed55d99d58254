"""Scenes whose E/π is known on paper: they hold the peer to our axes, units and conventions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from irradia.scene.environment import environment_from_color, texel_directions, texel_solid_angles
from irradia.scene.load import load_scene
from irradia.scene.types import Environment, Light, Scene

FLOOR = "builtin:plane-point"


@dataclass(frozen=True)
class KnownAnswer:
    """A scene and its answer.

    Attributes:
        answer: (N, 3) points on the floor, or anywhere where it is the same → (N, 3) E/π.
        tolerance: Relative, on the mean over texels and for every texel alike where noise-free.
        noisy: Whether single texels scatter, so that only the mean is held to the tolerance.
    """

    name: str
    scene: Scene
    answer: Callable[[np.ndarray], np.ndarray]
    tolerance: float
    noisy: bool


def known_answers() -> Iterator[KnownAnswer]:
    """Sun, point light, rectangle, environment and furnace, none of them symmetric by accident."""
    floor = replace(load_scene(FLOOR), lights=())
    yield _sun(floor, 0.0, "sun without size")
    yield _sun(floor, 10.0, "sun of 10°")
    yield _point(floor)
    yield _rectangle()
    yield _constant(floor)
    yield _lopsided(floor)
    for name, albedo in (("furnace", 0.5), ("furnace-80", 0.8)):
        value = 1.0 / (1.0 - albedo)
        room = load_scene(f"builtin:{name}")
        yield KnownAnswer(name, room, lambda p, v=value: np.full((len(p), 3), v), 0.005, noisy=True)


def _sun(floor: Scene, angle_deg: float, name: str) -> KnownAnswer:
    direction = np.array([0.48, -0.6, 0.64])
    intensity = np.array([3.0, 2.0, 1.0])
    light = Light("directional", (3.0, 2.0, 1.0), direction=tuple(direction), angle_deg=angle_deg)
    # The mean cosine over a disc of half angle a about the sun is (1 + cos a) / 2 times its centre's.
    cosine = 0.6 * 0.5 * (1.0 + np.cos(np.radians(0.5 * angle_deg)))
    value = intensity * cosine / np.pi
    scene = replace(floor, lights=(light,))
    return KnownAnswer(name, scene, lambda p: np.tile(value, (len(p), 1)), 0.005, noisy=angle_deg > 0.0)


def _point(floor: Scene) -> KnownAnswer:
    position, intensity = np.array([0.7, 0.9, -1.1]), np.array([5.0, 3.0, 1.0])
    scene = replace(floor, lights=(Light("point", (5.0, 3.0, 1.0), position=(0.7, 0.9, -1.1)),))

    def answer(points: np.ndarray) -> np.ndarray:
        distance = np.linalg.norm(position - points, axis=1, keepdims=True)
        return intensity * (position[1] - points[:, 1:2]) / distance**3 / np.pi

    return KnownAnswer("point light", scene, answer, 0.01, noisy=False)


def _rectangle() -> KnownAnswer:
    """E = ∫ L cos θ cos θ' / d² dA, by the midpoint rule on a fine grid."""
    from irradia.scene.builtin.rectangle import DEPTH_M, HEIGHT_M, RADIANCE, WIDTH_M

    n = 64
    x = ((np.arange(n) + 0.5) / n - 0.5) * WIDTH_M
    z = ((np.arange(n) + 0.5) / n - 0.5) * DEPTH_M
    lamp = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)
    cell = WIDTH_M * DEPTH_M / n**2

    def answer(points: np.ndarray) -> np.ndarray:
        squared = ((points[:, None, [0, 2]] - lamp) ** 2).sum(axis=-1) + HEIGHT_M**2
        return (HEIGHT_M**2 / squared**2).sum(axis=1, keepdims=True) * cell / np.pi * np.array(RADIANCE)

    return KnownAnswer("rectangle", load_scene("builtin:rectangle"), answer, 0.005, noisy=True)


def _constant(floor: Scene) -> KnownAnswer:
    scene = replace(floor, environment=environment_from_color((1.0, 2.0, 3.0)))
    return KnownAnswer(
        "constant environment", scene, lambda p: np.tile([1.0, 2.0, 3.0], (len(p), 1)), 0.005, noisy=True
    )


def _lopsided(floor: Scene) -> KnownAnswer:
    """A map that differs between all four sides: on a floor only its total counts, on tilted ones all.

    The floor is turned so that its normal points between +X, +Y and −Z.
    """
    height, width = 32, 64
    radiance = np.full((height, width, 3), 0.1, np.float32)
    radiance[4:14, 40:52] = (20.0, 5.0, 1.0)
    radiance[10:20, 8:16] = (1.0, 10.0, 30.0)
    normal = np.array([2.0, 1.0, -2.0]) / 3.0
    turned = np.eye(4)
    turned[:3, 1] = normal
    turned[:3, 0] = np.array([1.0, 2.0, 2.0]) / 3.0
    turned[:3, 2] = np.cross(turned[:3, 0], normal)
    scene = replace(
        floor,
        environment=Environment(radiance),
        instances=tuple(replace(i, world_from_object=turned @ i.world_from_object) for i in floor.instances),
    )
    fine = np.repeat(np.repeat(radiance, 8, axis=0), 8, axis=1)
    cosine = np.maximum(texel_directions(8 * height, 8 * width) @ normal, 0.0)
    weights = cosine * texel_solid_angles(8 * height, 8 * width)
    value = np.einsum("hw,hwc->c", weights, fine) / np.pi
    return KnownAnswer("lopsided environment", scene, lambda p: np.tile(value, (len(p), 1)), 0.01, noisy=True)
