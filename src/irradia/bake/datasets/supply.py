"""Places on demand: supplies that drop what is unfit, mixed, and dealt out by the number."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol

from irradia.core.errors import InputError
from irradia.core.rng import Seed

if TYPE_CHECKING:
    from irradia.transport.receivers import Receivers

N_AT_ONCE = 1 << 14  # candidates
_HOPELESS = 256  # candidates for each place that was found, and then there is next to no free space
_TURN = "Check that the scene's surfaces face the space that is lit."


class Places(Protocol):
    """A supply of places."""

    def draw(self, n: int) -> Receivers:
        """Those of the next ``n`` candidates that are fit; none where the supply has run dry."""
        ...

    @property
    def n_left(self) -> int | None:
        """Candidates still to come; None without end."""
        ...


class MixedPlaces:
    """Places of two supplies, a fixed share of each, shuffled.

    Args:
        first: One supply, without end.
        second: The other, likewise.
        share: Of the second.
        seed: Of the shuffle.
    """

    n_left = None

    def __init__(self, first: Places, second: Places, share: float, seed: Seed) -> None:
        self._supplies = Buffer(first), Buffer(second)
        self._share, self._rng = share, seed.numpy()

    def draw(self, n: int) -> Receivers:
        """See :class:`Places`; here all are fit."""
        from irradia.transport.receivers import Receivers

        n_second = round(n * self._share)
        parts = [self._supplies[0].take(n - n_second), self._supplies[1].take(n_second)]
        return Receivers.join(parts).take(self._rng.permutation(n))


class Buffer:
    """Gives as many places as one asks for.

    Candidates are drawn by N_AT_ONCE, so that the places don't depend on how many are asked for at once.

    Args:
        places: The supply.
    """

    def __init__(self, places: Places) -> None:
        self._places = places
        self._ready: list[Receivers] = []
        self._n_ready = self._n_found = self._n_tried = 0

    def take(self, n: int) -> Receivers:
        """The next ``n``; fewer only where the supply has run dry.

        Raises:
            InputError: There is next to no free space.
        """
        from irradia.transport.receivers import Receivers

        while self._n_ready < n and self._places.n_left != 0:
            found = self._places.draw(N_AT_ONCE)
            self._n_tried += N_AT_ONCE
            self._n_found += len(found)
            self._n_ready += len(found)
            self._ready.append(found)
            if self._n_tried > _HOPELESS * (self._n_found + N_AT_ONCE):
                raise InputError("expected free space, found next to none", where="SCENE", fix=_TURN)
        everything = Receivers.join(self._ready)
        self._ready = [everything.take(slice(n, None))]
        self._n_ready = len(self._ready[0])
        return everything.take(slice(0, n))


def batches(places: Places, size: int, count: int | None) -> Iterator[Receivers]:
    """Places in batches of ``size``, the last one smaller.

    Args:
        places: The supply.
        size: Of a batch.
        count: How many places in all; None until the supply runs dry.
    """
    buffer, n_taken = Buffer(places), 0
    while count is None or n_taken < count:
        wanted = size if count is None else min(size, count - n_taken)
        batch = buffer.take(wanted)
        if len(batch):
            yield batch
        n_taken += len(batch)
        if len(batch) < wanted:
            return
