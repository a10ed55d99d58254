"""Training a field in Dr.Jit."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import drjit as dr
import numpy as np

from irradia.field.backend import Batch, Parameters, Rates, StepOptions, Stepper, TrainState
from irradia.field.backends.drjit_adam import Learned, scalars_of
from irradia.field.backends.drjit_encoding import place_all
from irradia.field.backends.drjit_field import points_of, precise
from irradia.field.backends.drjit_fixed_point import room_for
from irradia.field.backends.drjit_network import pack, unpack
from irradia.field.backends.drjit_step import StepInputs, StepProgram
from irradia.field.backends.drjit_tiles import F, n_tiles, shape_of, upload
from irradia.field.spec import FieldSpec

_GROUPS = ("parameters", "first", "second", "average")  # of a TrainState, in the order of Learned


class DrJitStepper(Stepper):
    """A training in progress."""

    def __init__(self, spec: FieldSpec, state: TrainState, options: StepOptions, jit: ModuleType) -> None:
        self._spec, self._options, self._jit = spec, options, jit
        self._step = state.step
        placed = place_all(spec, jit)
        self._constants = [each.fast.constants() for each in placed]
        names = ("position", "direction")
        self._tables = {name: self._uploaded(state, name) for name in names if name in state.parameters}
        self._matrices = self._uploaded_matrices(state)
        self._learns = self._frozen_parts()
        self._program = StepProgram(spec, options, jit, placed, set(self._tables))
        self._recorded: dict[int, Any] = {}
        dr.sync_thread()  # copying has ended

    def step(self, batch: Batch, rates: Rates) -> float:
        """See the base class."""
        self._step += 1
        tiles = n_tiles(len(batch))
        if tiles not in self._recorded:
            self._recorded[tiles] = self._program.recorded(tiles)
        inputs = self._inputs(batch, rates)
        with precise():
            self._tables, self._matrices, losses = self._recorded[tiles](self._tables, self._matrices, inputs)
        loss = float(losses.numpy().sum(dtype=np.float64)) / batch.target.size
        dr.sync_thread()  # the batch is the caller's again
        return loss

    def state(self) -> TrainState:
        """See the base class."""
        groups = [self._collect(i) for i in range(4 if self._options.average else 3)]
        average = groups[3] if self._options.average else {}
        return TrainState(groups[0], average, groups[1], groups[2], self._step)

    def _inputs(self, batch: Batch, rates: Rates) -> StepInputs:
        jit, options, n = self._jit, self._options, len(batch)
        shape = shape_of(jit, n)
        return StepInputs(
            points_of(jit, batch.x, batch.normal, shape),
            upload(jit, batch.target),
            shape,
            dr.opaque(jit.Float, 2.0 / batch.target.size),
            dr.opaque(jit.UInt, room_for(n)),
            scalars_of(jit, options.encoding_adam, self._step, rates.encoding),
            scalars_of(jit, options.network_adam, self._step, rates.network),
            self._constants,
            self._learns,
        )

    def _uploaded(self, state: TrainState, name: str) -> Learned:
        groups = _GROUPS if self._options.average else _GROUPS[:3]
        return [upload(self._jit, getattr(state, group)[name]) for group in groups]

    def _uploaded_matrices(self, state: TrainState) -> list[Learned]:
        groups = _GROUPS if self._options.average else _GROUPS[:3]
        packed = (pack(self._spec, getattr(state, group)) for group in groups)
        return [[upload(self._jit, array) for array in arrays] for arrays in zip(*packed, strict=True)]

    def _frozen_parts(self) -> dict[str, F]:
        frozen, shapes = self._options.frozen, self._spec.parameter_shapes()
        learns: Parameters = {
            name: np.full(shape, name not in frozen, np.float32) for name, shape in shapes.items()
        }
        return {
            str(i): upload(self._jit, packed)
            for i, packed in enumerate(pack(self._spec, learns))
            if len({f"mlp.{i}.weight", f"mlp.{i}.bias"} & frozen) == 1
        }

    def _collect(self, group: int) -> Parameters:
        """One kind of arrays, such as first moments, by the names of parameters."""
        found = {name: learned[group].numpy().copy() for name, learned in self._tables.items()}
        return found | unpack(self._spec, [learned[group].numpy() for learned in self._matrices])
