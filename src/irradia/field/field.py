"""A trained field: light at any place of a scene."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.sh import light_on
from irradia.field.backend import Evaluator, Parameters
from irradia.field.backends import backend
from irradia.field.checks import check_parameters
from irradia.field.spec import FieldFrame, FieldSpec


@dataclass(frozen=True, eq=False)
class Field:
    """What files hold and everything that shows light asks.

    Attributes:
        spec: Architecture.
        frame: The scene's box, scale and quantity.
        parameters: By the names of ``spec.parameter_shapes()``.
        backend_name: What computes it; see :func:`irradia.field.backends.backend`.

    Raises:
        InputError: If the parameters aren't the spec's.
    """

    spec: FieldSpec
    frame: FieldFrame
    parameters: Parameters
    backend_name: str = "auto"

    def __post_init__(self) -> None:
        check_parameters(self.spec, self.parameters)

    def irradiance(self, positions: NDArray[np.float32], normals: NDArray[np.float32]) -> NDArray[np.float32]:
        """E (N, 3) in W·m⁻², linear Rec.709, never negative.

        Args:
            positions: (N, 3) metres; those outside the frame's box are clamped to it.
            normals: (N, 3) unit.
        """
        if self.spec.mode == "irradiance":
            return np.maximum(self._evaluate(positions, normals), 0.0)
        return light_on(self.coefficients(positions), normals).astype(np.float32)

    def coefficients(self, positions: NDArray[np.float32]) -> NDArray[np.float32]:
        """SH coefficients of radiance (N, 4 or 9, 3), in the order of docs/conventions.md.

        Raises:
            InputError: If the field gives irradiance, which can't be taken back to coefficients.
        """
        if self.spec.mode == "irradiance":
            raise InputError("this field gives irradiance, not SH coefficients")
        return self._evaluate(positions, None).reshape(len(positions), -1, 3)

    @cached_property
    def _evaluator(self) -> Evaluator:
        return backend(self.backend_name, self.spec).evaluator(self.spec, self.parameters)

    def _evaluate(
        self, positions: NDArray[np.float32], normals: NDArray[np.float32] | None
    ) -> NDArray[np.float32]:
        x = self.frame.to_unit(np.asarray(positions, np.float32))
        normals = None if normals is None else np.asarray(normals, np.float32)
        return self._evaluator(x, normals) * np.float32(self.frame.scale)
