"""Bytes behind a uri: a data URI, or a file beside the glTF."""

from __future__ import annotations

import base64
import binascii
from pathlib import Path, PureWindowsPath
from urllib.parse import unquote, unquote_to_bytes, urlsplit

from irradia.core.errors import InputError


def resolve_uri(uri: str, base: Path | None, pointer: str) -> bytes:
    """The bytes that ``uri`` stands for.

    Args:
        uri: A data URI, or a path relative to ``base``, percent-encoded.
        base: Folder of the glTF; None where there is none, and only data URIs work.
        pointer: JSON pointer of the uri, for errors.

    Raises:
        InputError: The URI is malformed, remote or absolute, or its file can't be read.
    """
    if uri[:5].lower() == "data:":
        return _decode_data_uri(uri, pointer)
    relative = unquote(uri)
    if len(urlsplit(uri).scheme) > 1 or PureWindowsPath(relative).anchor:
        raise InputError(
            f"expected a data URI or a relative path, found '{uri[:80]}'",
            where=pointer,
            fix="Put the file beside the glTF and refer to it by a relative path.",
        )
    if base is None:
        raise InputError(f"'{uri[:80]}' is relative, but this document has no folder", where=pointer)
    try:
        return (base / relative).read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            f"can't read '{relative[:200]}': {reason}",
            where=pointer,
            fix="Copy the file to where the glTF looks for it, or export the scene again as .glb.",
        ) from error


def _decode_data_uri(uri: str, pointer: str) -> bytes:
    header, comma, payload = uri.partition(",")
    if not comma:
        raise InputError("this data URI has no comma, so no data", where=pointer)
    if not header.lower().endswith(";base64"):
        return unquote_to_bytes(payload)
    try:
        return base64.b64decode(unquote_to_bytes(payload), validate=True)
    except binascii.Error as error:
        raise InputError(f"this data URI is not base64: {error}", where=pointer) from error
