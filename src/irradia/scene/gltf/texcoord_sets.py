"""Fits a material to the texcoords that a primitive has, and to the two sets that transport carries."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from irradia.scene.types import Material, TextureRef

N_CARRIED_SETS = 2
"""Texcoord sets that a merged mesh holds for each vertex."""

_TEXTURE_FIELDS = tuple(f.name for f in fields(Material) if f.name.endswith("_texture"))


@dataclass(frozen=True)
class FittedMaterial:
    """A material for one primitive.

    Attributes:
        order: The primitive's texcoord sets in their new order; those that are read come first.
        dropped: Textures that are left out, by field, with the set that they wanted.
    """

    material: Material
    order: tuple[int, ...]
    dropped: tuple[tuple[str, int], ...]


def fit_texcoords(material: Material, n_sets: int) -> FittedMaterial:
    """Moves the texcoord sets that ``material`` reads to the front, where they are not already.

    Textures that read a set which the primitive lacks, or more than two sets, are left out; the
    first fields of :class:`Material`, base colour foremost, keep theirs.
    """
    wanted = list(dict.fromkeys(ref.texcoord for _, ref in _textures(material)))
    kept = [texcoord for texcoord in wanted if texcoord < n_sets][:N_CARRIED_SETS]
    order = _swapped_to_front(kept, n_sets)
    slot = {texcoord: order.index(texcoord) for texcoord in kept}
    changed: dict[str, TextureRef | None] = {}
    dropped = []
    for name, ref in _textures(material):
        if ref.texcoord not in slot:
            changed[name] = None
            dropped.append((name, ref.texcoord))
        elif slot[ref.texcoord] != ref.texcoord:
            changed[name] = replace(ref, texcoord=slot[ref.texcoord])
    fitted = replace(material, **changed) if changed else material
    return FittedMaterial(fitted, order, tuple(dropped))


def _swapped_to_front(kept: list[int], n_sets: int) -> tuple[int, ...]:
    """All sets, each kept one beyond the front swapped with the first that isn't kept."""
    order = list(range(n_sets))
    for texcoord in kept:
        if texcoord >= N_CARRIED_SETS:
            slot = next(i for i in range(N_CARRIED_SETS) if order[i] not in kept)
            position = order.index(texcoord)
            order[slot], order[position] = order[position], order[slot]
    return tuple(order)


def _textures(material: Material) -> list[tuple[str, TextureRef]]:
    found = ((name, getattr(material, name)) for name in _TEXTURE_FIELDS)
    return [(name, ref) for name, ref in found if ref is not None]
