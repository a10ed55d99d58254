"""Animations sampled at one time: what each moves, and to where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.nodes import NodePose
from irradia.scene.gltf.notes import ImportNotes
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import F64

_PATHS = ("translation", "rotation", "scale", "weights")


def sample_animations(
    root: JsonView, accessors: Accessors, time_s: float, notes: ImportNotes
) -> Mapping[int, NodePose]:
    """The pose at ``time_s``, by node; before the first and after the last key it holds still.

    Files split one scene's motion over many animations, or hold alternatives for one character. So all
    are sampled, and where two move the same property of a node, the first one wins.

    Raises:
        InputError: A sampler or channel is malformed.
    """
    poses: dict[int, NodePose] = {}
    for animation in root.items("animations"):
        samplers = animation.items("samplers")
        for channel in animation.items("channels"):
            target = channel.object("target")
            path = target.string("path")
            node = target.index("node", root.length("nodes"))
            if path not in _PATHS or node is None:
                notes.add(f"animation of '{path}' is not read")
                continue
            pose = poses.get(node, NodePose())
            if getattr(pose, path) is not None:
                notes.add("several animations move the same node: the first one is taken")
                continue
            sampler = channel.index("sampler", len(samplers))
            if sampler is None:
                raise InputError("'sampler' is missing", where=channel.pointer)
            value = _sample(samplers[sampler], accessors, time_s, path)
            poses[node] = replace(pose, **{path: tuple(value.tolist())})
    return poses


def _sample(sampler: JsonView, accessors: Accessors, time_s: float, path: str) -> F64:
    times = accessors.read(sampler.integer("input")).floats(1)[:, 0].astype(np.float64)
    mode = sampler.choice("interpolation", ("LINEAR", "STEP", "CUBICSPLINE"), "LINEAR")
    keys = _keys(sampler, accessors, path, len(times), 3 if mode == "CUBICSPLINE" else 1)
    if np.any(np.diff(times) <= 0):
        raise InputError("expected times that grow", where=f"{sampler.pointer}/input")
    key = int(np.clip(np.searchsorted(times, time_s, side="right") - 1, 0, max(len(times) - 2, 0)))
    following = min(key + 1, len(times) - 1)
    span_s = times[following] - times[key]
    share = float(np.clip((time_s - times[key]) / span_s, 0.0, 1.0)) if span_s > 0 else 0.0
    if mode == "STEP":
        return keys[following if share >= 1.0 else key, 0]
    if mode == "CUBICSPLINE":
        value = _hermite(keys[key], keys[following], share, span_s)
        return value / max(np.linalg.norm(value), 1e-20) if path == "rotation" else value
    if path == "rotation":
        return _slerp(keys[key, 0], keys[following, 0], share)
    return (1.0 - share) * keys[key, 0] + share * keys[following, 0]


def _keys(sampler: JsonView, accessors: Accessors, path: str, n_keys: int, per_key: int) -> F64:
    """(keys, per_key, components): with splines in-tangent, value and out-tangent, else the value."""
    stored = accessors.read(sampler.integer("output"))
    components = {"translation": 3, "rotation": 4, "scale": 3, "weights": 1}[path]
    values = stored.floats(components).astype(np.float64)
    n_weights, rest = divmod(len(values), n_keys * per_key)
    if rest or n_weights < 1 or (path != "weights" and n_weights != 1):
        raise InputError(
            f"expected {n_keys * per_key} values for {n_keys} keys, found {len(values)}", where=stored.pointer
        )
    return values.reshape(n_keys, per_key, -1)


def _hermite(start: F64, end: F64, share: float, span_s: float) -> F64:
    """Section C.5 of glTF 2.0: cubic Hermite spline with tangents per second."""
    t, t2, t3 = share, share**2, share**3
    _, value_0, out_tangent = start
    in_tangent, value_1, _ = end
    return (
        (2 * t3 - 3 * t2 + 1) * value_0
        + span_s * (t3 - 2 * t2 + t) * out_tangent
        + (3 * t2 - 2 * t3) * value_1
        + span_s * (t3 - t2) * in_tangent
    )


def _slerp(start: F64, end: F64, share: float) -> F64:
    """The shorter way round, at constant speed."""
    cosine = float(np.dot(start, end))
    if cosine < 0:
        end, cosine = -end, -cosine
    if cosine > 0.9995:
        value = (1.0 - share) * start + share * end
    else:
        angle = np.arccos(cosine)
        value = (np.sin((1.0 - share) * angle) * start + np.sin(share * angle) * end) / np.sin(angle)
    return value / max(np.linalg.norm(value), 1e-20)
