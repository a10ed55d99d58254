"""Any picture that a person may hand to ``irradia compare``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError


def read_image(path: Path | str) -> NDArray[np.float32]:
    """Reads .exr and .hdr as they are, .png and .jpg through the sRGB curve: (H, W, 3) linear Rec.709.

    Raises:
        InputError: The ending is none of these, or the file can't be read.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix == ".exr":
        from irradia.formats.exr import read_exr

        return read_exr(file)
    if suffix in (".hdr", ".pic"):
        from irradia.formats.hdr import read_hdr

        return read_hdr(file)
    if suffix in (".png", ".jpg", ".jpeg"):
        from irradia.formats.png import read_png_linear

        return read_png_linear(file)
    raise InputError(
        f"expected an image ending in .exr, .hdr, .png or .jpg, found {suffix or 'no ending'!r}",
        where=str(file),
    )
