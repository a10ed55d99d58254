"""What a scene's light depends on, as short hashes: tells a re-bake what has changed since.

Hashes are of what is shown, not of how the file stores it: triangles count in any order, images by
their pixels, numbers up to the noise of another exporter's float arithmetic, and names only tell things
apart. So a file that is merely saved again keeps its fingerprint.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from hashlib import blake2b
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import Instance, Primitive, Scene, TextureRef

Fingerprint = dict[str, Any]
"""``{"version": 1, "instances": {name: hash}, "lights": {name: hash}, "environment": hash}``: plain JSON."""

_VERSION = 1
_DIGEST_BYTES = 16
_KEPT_BITS = 20  # of an array's largest number; what lies below is noise


@dataclass(frozen=True)
class Changes:
    """Names, sorted."""

    changed: tuple[str, ...] = ()
    added: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.changed or self.added or self.removed)


@dataclass(frozen=True)
class SceneChanges:
    """What differs between two fingerprints.

    Attributes:
        environment: Whether the light from outside differs.
        comparable: False where the older one is of another version: then everything counts as changed.
    """

    instances: Changes
    lights: Changes
    environment: bool
    comparable: bool = True

    def __bool__(self) -> bool:
        return bool(self.instances or self.lights or self.environment)


def fingerprint(scene: Scene) -> Fingerprint:
    """Hashes every instance, every light and the environment."""
    images = [_digest(image.pixels.shape, image.pixels) for image in scene.images]
    materials = [_hash(material, images) for material in scene.materials]
    shapes = [_shape_hash(primitive) for primitive in scene.primitives]
    instances = [
        _digest(shapes[i.primitive], materials[scene.primitives[i.primitive].material], *_placement(i))
        for i in scene.instances
    ]
    lights = [_hash(light, images) for light in scene.lights]
    return {
        "version": _VERSION,
        "instances": dict(zip(instance_names(scene), instances, strict=True)),
        "lights": dict(zip(_told_apart(light.name for light in scene.lights), lights, strict=True)),
        "environment": "" if scene.environment is None else _hash(scene.environment, images),
    }


def instance_names(scene: Scene) -> list[str]:
    """A name for each instance, unlike all others: its node's, with mesh part and number where needed."""
    several = Counter((i.node_index, i.gpu_instance) for i in scene.instances)
    return _told_apart(_instance_name(scene, instance, several) for instance in scene.instances)


def compare_fingerprints(old: Mapping[str, Any], new: Mapping[str, Any]) -> SceneChanges:
    """What an edit changed, by the names of the newer scene and, for what is gone, of the older."""
    if old.get("version") != new["version"]:
        everything = [Changes(changed=tuple(sorted(new[kind]))) for kind in ("instances", "lights")]
        return SceneChanges(everything[0], everything[1], environment=True, comparable=False)
    return SceneChanges(
        _compare(old["instances"], new["instances"]),
        _compare(old["lights"], new["lights"]),
        old["environment"] != new["environment"],
    )


def _compare(old: Mapping[str, str], new: Mapping[str, str]) -> Changes:
    return Changes(
        changed=tuple(sorted(name for name in new.keys() & old.keys() if new[name] != old[name])),
        added=tuple(sorted(new.keys() - old.keys())),
        removed=tuple(sorted(old.keys() - new.keys())),
    )


def _instance_name(scene: Scene, instance: Instance, several: Mapping[Any, int]) -> str:
    name = instance.name or f"node {instance.node_index}"
    if instance.gpu_instance is not None:
        name += f"[{instance.gpu_instance}]"
    if several[instance.node_index, instance.gpu_instance] > 1:
        name += f"/{scene.primitives[instance.primitive].primitive_index}"
    return name


def _told_apart(names: Iterable[str]) -> list[str]:
    """Repeated names get numbers, in order."""
    met: Counter[str] = Counter()
    result = []
    for name in names:
        met[name] += 1
        result.append(name if met[name] == 1 else f"{name} #{met[name]}")
    return result


def _placement(instance: Instance) -> tuple[Any, ...]:
    """Where an instance stands and what part it has."""
    linear, translation = instance.world_from_object[:3, :3], instance.world_from_object[:3, 3]
    part = (instance.lightmap_scale, instance.casts, instance.lod_level)
    return (*_steps(linear), *_steps(translation), *part)


def _hash(value: Any, images: list[str]) -> str:
    return _digest(*_parts(value, images))


def _parts(value: Any, images: list[str]) -> Iterator[Any]:
    """What of a material, a light or an environment its light depends on."""
    if isinstance(value, TextureRef):
        yield images[value.image]
    if isinstance(value, np.ndarray):
        yield value.shape
        yield from _steps(value)
    elif isinstance(value, tuple):
        for element in value:
            yield from _parts(element, images)
    elif is_dataclass(value):
        for field in fields(value):
            if field.name not in ("name", "image"):
                yield field.name
                yield from _parts(getattr(value, field.name), images)
    else:
        yield f"{value:.6g}" if isinstance(value, float) else value


def _digest(*parts: Any) -> str:
    hasher = blake2b(digest_size=_DIGEST_BYTES)
    for part in parts:
        data = part.tobytes() if isinstance(part, np.ndarray) else repr(part).encode()
        hasher.update(len(data).to_bytes(8, "little") + data)
    return hasher.hexdigest()


def _steps(values: NDArray) -> tuple[int, NDArray[np.int64]]:
    """Numbers as whole steps of a power of two, and its exponent.

    The largest number keeps ``_KEPT_BITS``. It counts a little more than it is, since 1 is common and a
    bit less than 1, as another exporter may write it, should have the same exponent.
    """
    values = np.asarray(values, np.float64)
    exponent = int(np.frexp(1.001 * np.abs(values).max(initial=0.0))[1]) - _KEPT_BITS
    return exponent, np.rint(np.ldexp(values, -exponent)).astype(np.int64)


def _shape_hash(primitive: Primitive) -> str:
    """Of the triangles with all that their corners carry, in any order."""
    corners = [primitive.positions, primitive.normals, *primitive.texcoords]
    if primitive.colors is not None:
        corners.append(primitive.colors)
    exponents, steps = zip(*(_steps(values) for values in corners), strict=True)
    columns = np.concatenate(steps, axis=1).view(np.uint64)
    vertex = np.zeros((2, len(columns)), np.uint64)
    for number, column in enumerate(columns.T):
        for lane in (0, 1):
            vertex[lane] = _mix(vertex[lane] ^ column ^ np.uint64(2 * number + lane + 1))
    a, b, c = (vertex[:, primitive.indices[:, k]] for k in range(3))
    # Alike for every corner to start from, unlike when turned over.
    triangle = _mix(a + _mix(b)) + _mix(b + _mix(c)) + _mix(c + _mix(a))
    sums = _mix(triangle).sum(axis=1, dtype=np.uint64)
    widths = [values.shape[1] for values in corners]
    return _digest(len(primitive.indices), widths, exponents, sums.tolist())


def _mix(values: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """A full-avalanche 64-bit permutation (constants: Stafford 2011, "Mix13")."""
    values = (values ^ (values >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    values = (values ^ (values >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return values ^ (values >> np.uint64(31))
