"""Fields on disk: :func:`save_field` and :func:`load_field` choose the format by the name.

=======================  ============================================================================
``.safetensors``         the native format: :mod:`irradia.formats.field_safetensors`
``.safetensors.zst``     the same, packed by zstd
``.bin``                 the Unity project's, which lacks much: :mod:`irradia.formats.field_bin`
=======================  ============================================================================
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.field.bin_conventions import BinConventions
from irradia.field.bin_reader import decode_bin
from irradia.field.bin_writer import check_bin, encode_bin
from irradia.field.field import Field
from irradia.field.native_fields import Precision, StoredField, decode_field, encode_field
from irradia.field.quantised import QuantisedField
from irradia.field.spec import FieldSpec

FORMATS = (".safetensors", ".safetensors.zst", ".bin")


def save_field(
    path: Path | str,
    saved: Field | QuantisedField,
    provenance: Mapping[str, Any] | None = None,
    *,
    precision: Precision = "fp16",
) -> int:
    """Writes a field, whole or not at all; the same field and provenance give the same bytes.

    Args:
        path: Its end, one of ``FORMATS``, chooses the format.
        saved: Codes of a quantised field go into safetensors as they are.
        provenance: Anything that JSON holds.
        precision: Of what isn't codes. A ``.bin`` is always of halves.

    Returns:
        Bytes written.

    Raises:
        InputError: The name has another end, or the format can't hold the field.
    """
    kind = _format(path)
    if kind == ".bin":
        data = encode_bin(saved.field if isinstance(saved, QuantisedField) else saved)
    else:
        data = encode_field(saved, provenance, precision=precision, compress=kind.endswith(".zst"))
    with write_atomic(path) as stream:
        stream.write(data)
    return len(data)


def check_format(
    path: Path | str, spec: FieldSpec, *, precision: Precision = "fp16", finish: str | None = None
) -> None:
    """Refuses before any work what a file of that name couldn't hold after it.

    Args:
        path: Where a field is to be written.
        spec: Its architecture.
        precision: That is asked for.
        finish: How its tables are to be quantised, as on the command line.

    Raises:
        InputError: The name has another end than those of ``FORMATS``, or the format can't hold the field.
    """
    if _format(path) != ".bin":
        return
    if finish is not None or precision != "fp16":
        asked = f"--precision {precision}" if finish is None else f"--finish {finish}"
        raise InputError("a .bin holds halves", where=asked, fix="Save as .safetensors.")
    check_bin(spec)


def load_field(path: Path | str, conventions: BinConventions | None = None) -> Field:
    """Reads a field of any of the formats.

    Args:
        path: The file.
        conventions: What a ``.bin`` doesn't say of itself; None takes those that we write.

    Raises:
        InputError: It can't be read, is damaged, or is no field.
    """
    return read_field(path, conventions).field


def read_field(path: Path | str, conventions: BinConventions | None = None) -> StoredField:
    """Like :func:`load_field`, with all else that the file says."""
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(
            f"it can't be read: {error.strerror}", where=str(path), fix="Make one with `irradia train`."
        ) from error
    if _format(path) == ".bin":
        return StoredField(decode_bin(data, conventions, str(path)), n_bytes=len(data))
    return decode_field(data, str(path))


def _format(path: Path | str) -> str:
    name = Path(path).name.lower()
    for end in FORMATS:
        if name.endswith(end):
            return end
    raise InputError(f"expected a name that ends in {', '.join(FORMATS)}", where=str(path))
