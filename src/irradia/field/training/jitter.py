"""Displaced copies of samples, which tell a field that light changes little from here to nearby.

A copy must not come to lie behind a wall. Samples on surfaces know the surfaces around them: every sample
stands for a disc across its normal (a surfel; Pfister et al. 2000), and a copy counts only if

1. no disc lies between the sample and its copy, and
2. the sample nearest to the copy faces the same way and its plane runs through the copy.

With d the distance of the sample's 48th neighbour, copies stay in its tangent plane within 0.3 d, about as
far as the next samples, and discs have a radius of 0.7 d: so all discs that could be in the way are known,
and where a wall stands on a floor a dozen of them cover the place at which a copy would pass through. The
wider discs cost a few copies near door posts. With 24 neighbours and halves of d, 5 % slipped through there.

Samples in space say nothing of surfaces, so for them a test by rays has to be given, which may also
replace the first rule for samples on surfaces. Some samples of a volume lie on surfaces too, which no file
says: where there is something between the points just above and just below one. Rays start above, as from
the surface itself rounding decides on which side of it they are, and copies stay above.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.core.rng import Seed
from irradia.field.backend import F32
from irradia.field.training.events import Working

if TYPE_CHECKING:
    from scipy.spatial import KDTree

# Rows of a chunk and a random stream → places (n, 3) for their copies, and (n,) whether they are good.
_Trial = Callable[[NDArray[np.int64], np.random.Generator], tuple[F32, NDArray[np.bool_]]]
# (n, 3) and (n, 3) points in metres → (n,) whether each pair sees each other.
Visibility = Callable[[F32, F32], NDArray[np.bool_]]

N_NEIGHBOURS = 48
_CHUNK_ROWS = 1 << 13
_TRIES = 4
_SAME_FACING = 0.9  # cosine
_LIFT = 0.01  # of how far a copy may go
_LIFT_IN_SPACE, _LEAST_LIFT = 1e-3, 1e-5  # of how far a copy may go; of coordinates, for their rounding
_OFF_PLANE = 0.1  # of how far a copy may go
_REACH, _RADIUS = 0.3, 0.7  # of the distance of the last neighbour


@dataclass(frozen=True)
class _Surfels:
    """The surroundings of n samples.

    Attributes:
        centre, normal: (n, k, 3) of their neighbours.
        known: (n,) how far all samples are known.
    """

    centre: F32
    normal: F32
    known: F32

    def of(self, row: NDArray[np.int64]) -> _Surfels:
        """Those of some of the samples."""
        return _Surfels(self.centre[row], self.normal[row], self.known[row])


def jittered_on_surfaces(
    positions: F32, normals: F32, copies: int, radius_m: float, seed: Seed, visible: Visibility | None = None
) -> Generator[Working, None, tuple[NDArray[np.int64], F32]]:
    """Copies of samples on surfaces.

    Args:
        positions: (N, 3) metres.
        normals: (N, 3) unit.
        copies: Of each sample; fewer where no place is found in four tries.
        radius_m: At most so far, uniform over the disc.
        seed: Of the places.
        visible: Test by rays; by default the samples' own discs are asked.

    Yields:
        Progress.

    Returns:
        (M,) number of the sample and (M, 3) position of each copy.
    """
    from scipy.spatial import KDTree

    tree = KDTree(positions)

    def trial(chunk: slice) -> _Trial:
        start, normal = positions[chunk], normals[chunk]
        around = _surfels(tree, start, positions, normals)
        reach = np.minimum(np.float32(radius_m), np.float32(_REACH) * around.known)

        def attempt(row: NDArray[np.int64], rng: np.random.Generator) -> tuple[F32, NDArray[np.bool_]]:
            place = start[row] + _tangent_offsets(normal[row], reach[row], rng)
            near = around.of(row)
            good = _on_its_surface(place, normal[row], near)
            if visible is None:
                return place, good & _clear(start[row], place, near)
            # Rays along the surface itself would meet it.
            lift: F32 = np.multiply(normal[row], (_LIFT * reach)[row, None])
            return place, good & visible(start[row] + lift, place + lift)

        return attempt

    return (yield from _copied(len(positions), copies, seed, trial))


def jittered_in_space(
    positions: F32, normals: F32 | None, copies: int, radius_m: float, seed: Seed, visible: Visibility
) -> Generator[Working, None, tuple[NDArray[np.int64], F32]]:
    """Copies of samples in free space, within a ball, and of those on surfaces, within the half above.

    See :func:`jittered_on_surfaces`; samples without normals all lie in free space.
    """

    def trial(chunk: slice) -> _Trial:
        at = positions[chunk]
        normal = np.zeros_like(at) if normals is None else normals[chunk]
        start, on_surface = _above(at, normal, radius_m, visible)

        def attempt(row: NDArray[np.int64], rng: np.random.Generator) -> tuple[F32, NDArray[np.bool_]]:
            way: F32 = np.multiply(_in_unit_ball(len(row), rng), np.float32(radius_m))
            place = at[row] + way
            behind = on_surface[row] & (np.einsum("nc,nc->n", way, normal[row]) < 0.0)
            return place, ~behind & visible(start[row], place)

        return attempt

    return (yield from _copied(len(positions), copies, seed, trial))


def _above(at: F32, normal: F32, radius_m: float, visible: Visibility) -> tuple[F32, NDArray[np.bool_]]:
    """(n, 3) where rays from samples start, and (n,) whether these lie on surfaces."""
    height = np.maximum(
        np.float32(_LIFT_IN_SPACE * radius_m), np.float32(_LEAST_LIFT) * np.abs(at).max(axis=1)
    )
    lift: F32 = np.multiply(normal, height[:, None])
    return at + lift, ~visible(at + lift, at - lift)


def _copied(
    n: int, copies: int, seed: Seed, trial: Callable[[slice], _Trial]
) -> Generator[Working, None, tuple[NDArray[np.int64], F32]]:
    """Tries places for copies of n samples; each chunk has its own random stream."""
    source, position = [np.zeros(0, np.int64)], [np.zeros((0, 3), np.float32)]
    for first in range(0, n, _CHUNK_ROWS):
        yield Working("Jitter samples", first, n, "rows")
        chunk = slice(first, min(first + _CHUNK_ROWS, n))
        attempt, rng = trial(chunk), seed.child(f"rows-{first}").numpy()
        left = np.repeat(np.arange(chunk.stop - first), copies)
        for _ in range(_TRIES):
            place, good = attempt(left, rng)
            source.append(first + left[good])
            position.append(place[good])
            left = left[~good]
    return np.concatenate(source), np.concatenate(position)


def _surfels(tree: KDTree, at: F32, positions: F32, normals: F32) -> _Surfels:
    k = min(N_NEIGHBOURS + 1, len(positions))
    distance, index = tree.query(at, k, workers=-1)
    index = np.reshape(index, (len(at), k))
    known = np.reshape(distance, (len(at), k))[:, -1].astype(np.float32)
    return _Surfels(positions[index], normals[index], known)


def _clear(start: F32, end: F32, around: _Surfels) -> NDArray[np.bool_]:
    """Whether no disc lies between the points of each pair."""
    radius = _RADIUS * around.known[:, None]
    above = np.einsum("nkc,nkc->nk", start[:, None] - around.centre, around.normal)
    below = np.einsum("nkc,nkc->nk", end[:, None] - around.centre, around.normal)
    steep = np.maximum(np.abs(above), np.abs(below)) > 1e-4 * radius  # not along the plane
    share = above / np.where(above == below, 1.0, above - below)
    met = start[:, None] + share[..., None] * (end - start)[:, None]
    within = np.linalg.norm(met - around.centre, axis=-1) <= radius
    return ~np.any(steep & (above * below <= 0.0) & within, axis=1)


def _on_its_surface(place: F32, normal: F32, around: _Surfels) -> NDArray[np.bool_]:
    """Whether the sample nearest to each place faces as its own does, with the place in its plane."""
    row = np.arange(len(place))
    nearest = np.argmin(np.linalg.norm(place[:, None] - around.centre, axis=-1), axis=1)
    centre, facing = around.centre[row, nearest], around.normal[row, nearest]
    off_plane = np.abs(np.einsum("nc,nc->n", place - centre, facing))
    return (np.einsum("nc,nc->n", normal, facing) >= _SAME_FACING) & (
        off_plane <= _OFF_PLANE * _REACH * around.known
    )


def _tangent_offsets(normals: F32, reach: F32, rng: np.random.Generator) -> F32:
    """(n, 3) uniform over discs of those radii (n,) across the normals."""
    offset = rng.standard_normal(normals.shape, np.float32)
    offset -= np.einsum("nc,nc->n", offset, normals)[:, None] * normals
    length = np.maximum(np.linalg.norm(offset, axis=1), np.float32(1e-12))
    return offset * (reach * np.sqrt(rng.random(len(normals), np.float32)) / length)[:, None]


def _in_unit_ball(n: int, rng: np.random.Generator) -> F32:
    direction = rng.standard_normal((n, 3), np.float32)
    length = np.maximum(np.linalg.norm(direction, axis=1), np.float32(1e-12))
    return direction * (np.cbrt(rng.random(n, np.float32)) / length)[:, None]
