"""What a backend is given, checked once where it comes in."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean
from irradia.field.backend import StepOptions
from irradia.field.losses import check_loss
from irradia.field.spec import FieldSpec


def check_parameters(spec: FieldSpec, parameters: Mapping[str, NDArray[np.float32]]) -> None:
    """Raises InputError unless there is exactly what the spec asks for, of its shapes and finite."""
    shapes = spec.parameter_shapes()
    if extra := sorted(parameters.keys() - shapes.keys()):
        raise InputError(f"unknown parameters {', '.join(extra)}", fix=did_you_mean(extra[0], shapes))
    for name, shape in shapes.items():
        if name not in parameters:
            raise InputError(f"parameters {name!r} of shape {shape} are missing")
        if parameters[name].shape != shape:
            raise InputError(f"expected shape {shape}, found {parameters[name].shape}", where=name)
        if not np.isfinite(parameters[name]).all():
            raise InputError("some parameters are infinite or not numbers", where=name)


def check_options(spec: FieldSpec, options: StepOptions) -> None:
    """Raises InputError if a spec can't be trained with these options."""
    check_loss(options.loss, spec)
    if not 0.0 <= options.average < 1.0:
        raise InputError(f"expected a decay of the mean in [0, 1), found {options.average}", where="average")
    names = spec.parameter_shapes()
    for name in sorted(options.frozen):
        if name not in names:
            raise InputError(f"no parameters {name!r} to freeze", fix=did_you_mean(name, names))
