"""Fields as safetensors: specs, frames and tensors in, :class:`StoredField` out; docs/field-files.md."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field as attribute
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.field.field import Field
from irradia.field.quantised import QuantisedField, QuantisedTensor, unquantised
from irradia.field.registry import spec_from_dict, spec_to_dict
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.field.tensors import from_tensors, tensor_shapes, to_halves, to_tensors
from irradia.formats.field_safetensors import FieldTensors, decode_tensors, encode_tensors

Precision = Literal["fp16", "fp32"]
MAX_BLOCK = 1 << 32


@dataclass(frozen=True)
class StoredField:
    """What a file holds.

    Attributes:
        field: Ready to evaluate.
        tensors: Those of its tensors that are codes, by name.
        precision: Of all others.
        provenance: What the file says of its making; empty in a ``.bin``.
        n_bytes: As shipped.
    """

    field: Field
    tensors: Mapping[str, QuantisedTensor] = attribute(default_factory=dict)
    precision: Precision = "fp16"
    provenance: Mapping[str, Any] = attribute(default_factory=dict)
    n_bytes: int = 0


def encode_field(
    saved: Field | QuantisedField,
    provenance: Mapping[str, Any] | None = None,
    *,
    precision: Precision = "fp16",
    compress: bool = False,
) -> bytes:
    """The bytes of a ``.safetensors``, or of a ``.safetensors.zst``; see :func:`save_field`."""
    plain, codes = (saved.field, saved.tensors) if isinstance(saved, QuantisedField) else (saved, {})
    tensors: dict[str, NDArray[Any]] = {}
    for name, values in to_tensors(plain.spec, plain.parameters).items():
        if name in codes:
            tensors[f"{name}.codes"] = codes[name].stored_codes()
            tensors[f"{name}.scales"] = codes[name].scales
        else:
            tensors[name] = values if precision == "fp32" else to_halves(values, name)
    about: dict[str, Any] = {
        "spec": spec_to_dict(plain.spec),
        "frame": _frame_to_dict(plain.frame),
        "quantised": {name: {"bits": part.bits, "block": part.block} for name, part in codes.items()},
        "provenance": dict(provenance or {}),
    }
    return encode_tensors(FieldTensors(about, tensors), compress=compress)


def decode_field(data: bytes, where: str = "field") -> StoredField:
    """Reads what :func:`encode_field` gave.

    Raises:
        InputError: Cut short, damaged, of another version; tensors that are missing, unknown, of another
            shape or type; numbers that aren't finite.
    """
    content = decode_tensors(data, where)
    unknown = content.about.keys() - {"spec", "frame", "quantised", "provenance"}
    if unknown:
        raise InputError(f"unknown key {sorted(unknown)[0]!r} in its metadata", where=where)
    spec = spec_from_dict(_object(content.about, "spec", where), where=f"{where}: spec")
    frame = _frame_from_dict(_object(content.about, "frame", where), f"{where}: frame")
    codes = _codes(spec, content, where)
    plain, precision = _plain(spec, content, codes.keys(), where)
    values = plain | {name: tensor.values() for name, tensor in codes.items()}
    trained = Field(spec, frame, from_tensors(spec, values))
    return StoredField(trained, codes, precision, _object(content.about, "provenance", where), len(data))


def _frame_to_dict(frame: FieldFrame) -> dict[str, Any]:
    return {"aabb": frame.aabb.tolist(), "scale": float(frame.scale), "quantity": frame.quantity}


def _frame_from_dict(values: Mapping[str, Any], where: str) -> FieldFrame:
    if values.keys() != {"aabb", "scale", "quantity"}:
        raise InputError(f"expected aabb, scale and quantity, found {', '.join(values)}", where=where)
    try:
        with np.errstate(over="ignore"):
            aabb, scale = np.array(values["aabb"], np.float32), float(values["scale"])
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"expected numbers: {error}", where=where) from error
    if aabb.shape != (2, 3) or not np.isfinite(aabb).all() or np.any(aabb[0] > aabb[1]):
        raise InputError(f"expected an AABB, found {values['aabb']}", where=where)
    if not (np.isfinite(scale) and scale > 0.0 and np.log2(scale).is_integer()):
        raise InputError(f"expected a power of two as scale, found {scale}", where=where)
    if values["quantity"] not in ("full", "indirect"):
        raise InputError(f"expected full or indirect, found {values['quantity']!r}", where=where)
    return FieldFrame(aabb, scale, values["quantity"])


def _codes(spec: FieldSpec, content: FieldTensors, where: str) -> dict[str, QuantisedTensor]:
    """The tensors that the metadata says are codes."""
    shapes = tensor_shapes(spec)
    found: dict[str, QuantisedTensor] = {}
    for name, entry in _object(content.about, "quantised", where).items():
        at = f"{where}: {name}"
        if name not in shapes:
            raise InputError("the field has no such tensor to be quantised", where=at)
        bits, block = (entry.get("bits"), entry.get("block")) if isinstance(entry, dict) else (None, None)
        if bits not in (4, 8) or not (isinstance(block, int) and 1 <= block <= MAX_BLOCK):
            raise InputError(f"expected 4 or 8 bits in blocks of at least 1, found {entry}", where=at)
        codes, scales = (_take(content, f"{name}.{part}", where) for part in ("codes", "scales"))
        found[name] = unquantised(codes, scales, bits, block, shapes[name], at)
    return found


def _plain(
    spec: FieldSpec, content: FieldTensors, coded: Any, where: str
) -> tuple[dict[str, NDArray[np.float32]], Precision]:
    """All other tensors, and the largest precision among them."""
    shapes = {name: shape for name, shape in tensor_shapes(spec).items() if name not in coded}
    known = shapes.keys() | {f"{name}.{part}" for name in coded for part in ("codes", "scales")}
    if extra := sorted(content.tensors.keys() - known):
        raise InputError(f"unknown tensor {extra[0]!r}", where=where)
    found: dict[str, NDArray[np.float32]] = {}
    precision: Precision = "fp16"
    for name, shape in shapes.items():
        values = _take(content, name, where)
        if values.shape != shape or values.dtype.kind != "f":
            raise InputError(
                f"expected {name} of shape {shape} in halves or floats, "
                f"found {values.shape} of {values.dtype}",
                where=where,
            )
        precision = "fp32" if values.dtype == np.float32 else precision
        found[name] = values.astype(np.float32)
    return found, precision


def _take(content: FieldTensors, name: str, where: str) -> NDArray[Any]:
    if name not in content.tensors:
        raise InputError(f"the tensor {name!r} is missing", where=where)
    return content.tensors[name]


def _object(about: Mapping[str, Any], key: str, where: str) -> dict[str, Any]:
    value = about.get(key)
    if not isinstance(value, dict):
        raise InputError(f"expected an object as {key!r} in its metadata, found {value!r}", where=where)
    return value
