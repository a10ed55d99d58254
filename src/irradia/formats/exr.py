"""OpenEXR: any channels, half, float or uint, with text and number attributes (the OpenEXR wheel)."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.formats.limits import check_image_size

Metadata = Mapping[str, str | int | float]
_REPAIR = "The file is incomplete or damaged: copy it, or make it, again."


@dataclass(frozen=True)
class ExrImage:
    """One single-part image.

    Attributes:
        channels: Name to (H, W) float16, float32 or uint32; row 0 is the top.
        metadata: Attributes that are text or numbers (floats are 32-bit in the file).
    """

    channels: Mapping[str, NDArray]
    metadata: Metadata = field(default_factory=dict)


def write_exr(path: Path | str, channels: Mapping[str, NDArray], metadata: Metadata | None = None) -> None:
    """Writes channels, losslessly compressed (ZIP), whole or not at all.

    Args:
        path: The file.
        channels: Name to (H, W) array, all of one size; float16, float32 or uint32 is kept.
        metadata: Attributes beside the standard ones.
    """
    import OpenEXR

    header: dict[str, Any] = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    header.update(metadata or {})
    planes = {name: np.ascontiguousarray(plane) for name, plane in channels.items()}
    stream = io.BytesIO()
    OpenEXR.File(header, planes).write(stream)
    with write_atomic(path) as file:
        file.write(stream.getbuffer())


def write_exr_rgb(path: Path | str, rgb: NDArray, metadata: Metadata | None = None) -> None:
    """Writes (H, W, 3) as channels R, G and B in the precision that it has."""
    write_exr(path, {name: rgb[..., index] for index, name in enumerate("RGB")}, metadata)


def read_exr_image(path: Path | str) -> ExrImage:
    """Reads all channels of a file's first part.

    Raises:
        InputError: No such file, not OpenEXR, cut short, absurdly large, or with subsampled channels.
    """
    file = Path(path)
    _check_header(file)
    part = _open(file, header_only=False)
    channels = {name: channel.pixels for name, channel in part.channels.items()}
    if len({plane.shape for plane in channels.values()}) != 1:
        raise InputError("expected channels of one size, found subsampled ones", where=str(file))
    return ExrImage(channels, _metadata(part))


def read_exr_metadata(path: Path | str) -> Metadata:
    """Reads the text and number attributes alone; errors as :func:`read_exr_image`."""
    file = Path(path)
    if not file.is_file():
        raise InputError("there is no such file", where=str(file))
    return _metadata(_open(file, header_only=True))


def read_exr(path: Path | str) -> NDArray[np.float32]:
    """Reads an image's colour as (H, W, 3) float32; see :func:`rgb_from_channels`."""
    return rgb_from_channels(read_exr_image(path).channels, str(path))


def rgb_from_channels(channels: Mapping[str, NDArray], where: str) -> NDArray[np.float32]:
    """Picks colour: R, G, B; else the first layer that has them; else luminance as grey.

    The file's ``chromaticities`` are not applied: colours are taken for Rec.709.

    Raises:
        InputError: There is neither.
    """
    layers = sorted({name[:-1] for name in channels if name[-1:] in "RGB"}, key=lambda s: (s != "", s))
    for layer in layers:
        names = [layer + c for c in "RGB"]
        if all(name in channels for name in names):
            return np.stack([channels[name].astype(np.float32) for name in names], axis=-1)
    if "Y" in channels:
        return np.repeat(channels["Y"].astype(np.float32)[..., None], 3, axis=-1)
    raise InputError(f"expected channels R, G and B or Y, found {', '.join(sorted(channels))}", where=where)


def _metadata(part: Any) -> Metadata:
    return {key: value for key, value in part.header.items() if isinstance(value, str | int | float)}


def _check_header(file: Path) -> None:
    if not file.is_file():
        raise InputError("there is no such file", where=str(file))
    low, high = _open(file, header_only=True).header["dataWindow"]
    width, height = (int(high[axis]) - int(low[axis]) + 1 for axis in (0, 1))
    check_image_size(width, height, str(file))


def _open(file: Path, *, header_only: bool) -> Any:
    """The first part. The library prints a warning and drops a part that it can't decode."""
    import OpenEXR

    try:
        with contextlib.redirect_stdout(io.StringIO()), file.open("rb") as stream:
            parts = OpenEXR.File(stream, separate_channels=True, header_only=header_only).parts
    except (RuntimeError, ValueError, TypeError, OSError) as error:
        raise InputError(f"expected an OpenEXR image: {error}", where=str(file), fix=_REPAIR) from error
    if not parts:
        raise InputError("its pixels can't be decoded", where=str(file), fix=_REPAIR)
    return parts[0]
