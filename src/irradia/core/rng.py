"""Named random streams: one root seed, children by name, so that adding one never shifts another."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Seed:
    """A node in the tree of random streams.

    Attributes:
        root: The user's ``--seed``.
        path: Names from the root down, such as ``("bake", "epoch-3")``.
    """

    root: int
    path: tuple[str, ...] = ()

    def child(self, name: str) -> Seed:
        """The stream called ``name`` below this one."""
        return Seed(self.root, (*self.path, name))

    def uint32(self) -> int:
        """A 32-bit number that depends on root and path alone."""
        text = "/".join((str(self.root), *self.path))
        return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "little")

    def numpy(self) -> np.random.Generator:
        """A NumPy generator for this stream."""
        return np.random.default_rng(self.uint32())
