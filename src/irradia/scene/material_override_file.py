"""How material overrides are written.

``--material-override FILE.json`` with

    {
      "Leaves": {"albedo": "leaves.png", "opacity": "leaves-mask.png", "alphaMode": "mask"},
      "Screen": {"emission": {"image": "film.png", "factor": 40, "texcoord": 1}},
      "Wall*": {"albedo": [0.8, 0.75, 0.7]}
    }

where image files lie beside the JSON; or ``--material-override NAME:CHANNEL=VALUE``, once for each
channel, with an image file, a number, or three separated by commas. Numbers are linear.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, cast

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean
from irradia.scene.gltf.images import decode_image
from irradia.scene.gltf.view import JsonView
from irradia.scene.material_override import CHANNELS, Channel, ChannelOverride, MaterialOverride
from irradia.scene.types import AlphaMode, Image, Rgb, WrapMode

OPTION = "--material-override"
_MATERIAL_KEYS = (*CHANNELS, "alphaMode", "alphaCutoff")
_VALUE_KEYS = ("image", "factor", "texcoord", "wrap")
_ALPHA_MODES = ("opaque", "mask", "blend")
_WRAP_MODES = ("repeat", "clamp", "mirror")


def read_material_overrides(arguments: Sequence[str]) -> list[MaterialOverride]:
    """Reads the option's arguments.

    Raises:
        InputError: A file can't be read, a key is unknown (the nearest is suggested), or a value is
            neither an image nor a number.
    """
    return [override for argument in arguments for override in _read_argument(argument)]


def _read_argument(argument: str) -> Iterator[MaterialOverride]:
    target, equals, value = argument.partition("=")
    if not equals:
        yield from _read_file(Path(argument))
        return
    name, colon, channel = target.rpartition(":")
    if not colon or not name:
        raise InputError(
            f"expected a .json file or NAME:CHANNEL=VALUE, found {argument!r}",
            where=OPTION,
            fix=f"For example: {OPTION} 'Leaves:albedo=leaves.png'",
        )
    _check_key(channel, CHANNELS, OPTION)
    override = _from_text(value)
    yield MaterialOverride(name, {cast(Channel, channel): override}, where=f"{OPTION} {argument}")


def _from_text(value: str) -> ChannelOverride:
    """An image's path, a number, or three."""
    try:
        numbers = [float(part) for part in value.split(",")]
    except ValueError:
        return ChannelOverride(image=_read_image(Path(value), OPTION))
    return ChannelOverride(factor=_rgb(numbers, OPTION))


def _read_file(path: Path) -> Iterator[MaterialOverride]:
    try:
        root: Any = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"can't read this file: {error.strerror}", where=str(path)) from error
    except ValueError as error:
        raise InputError(f"expected JSON: {error}", where=str(path)) from error
    for name, view in JsonView(root, str(path)).entries():
        for key, _ in view.entries():
            _check_key(key, _MATERIAL_KEYS, f"{view.pointer}/{key}")
        channels: dict[Channel, ChannelOverride] = {
            c: _channel(view, c, path.parent) for c in CHANNELS if view.has(c)
        }
        mode = view.choice("alphaMode", _ALPHA_MODES) if view.has("alphaMode") else None
        cutoff = view.number("alphaCutoff", 0.5) if view.has("alphaCutoff") else None
        yield MaterialOverride(name, channels, cast("AlphaMode | None", mode), cutoff, view.pointer)


def _channel(material: JsonView, key: Channel, folder: Path) -> ChannelOverride:
    """A path, a number, a list of three, or an object of image and factor."""
    value, where = material.value[key], f"{material.pointer}/{key}"
    if not isinstance(value, dict):
        return _plain(value, where, folder)
    view = material.object(key)
    for name, _ in view.entries():
        _check_key(name, _VALUE_KEYS, f"{view.pointer}/{name}")
    image = _read_image(folder / view.string("image"), f"{where}/image") if view.has("image") else None
    factor = _plain(value["factor"], f"{where}/factor", None).factor if "factor" in value else (1.0, 1.0, 1.0)
    texcoord = view.index("texcoord", 2)
    wrap = view.choice("wrap", _WRAP_MODES, "repeat")
    return ChannelOverride(factor, image, texcoord, cast(WrapMode, wrap))


def _plain(value: Any, where: str, folder: Path | None) -> ChannelOverride:
    if isinstance(value, str) and folder is not None:
        return ChannelOverride(image=_read_image(folder / value, where))
    values: list[Any] = value if isinstance(value, list) else [value]
    if not all(isinstance(v, int | float) and not isinstance(v, bool) for v in values):
        raise InputError(f"expected an image or numbers, found {str(value)[:60]!r}", where=where)
    return ChannelOverride(factor=_rgb(values, where))


def _rgb(values: Sequence[float], where: str) -> Rgb:
    """One grey number or three."""
    if len(values) not in (1, 3) or not all(0.0 <= v < 1e9 for v in values):
        raise InputError(f"expected one number or three, each at least 0, found {list(values)}", where=where)
    red, green, blue = (float(v) for v in (values if len(values) == 3 else [values[0]] * 3))
    return (red, green, blue)


def _read_image(path: Path, where: str) -> Image:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"can't read the image {path}: {error.strerror}", where=where) from error
    return decode_image(data, path.stem, str(path))


def _check_key(key: str, known: Collection[str], where: str) -> None:
    if key not in known:
        raise InputError(
            f"expected one of {', '.join(known)}, found {key!r}", where=where, fix=did_you_mean(key, known)
        )
