"""Training a field in Dr.Jit."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any

import drjit as dr
import numpy as np

from irradia.field.backend import Batch, Parameters, Rates, StepOptions, Stepper, TrainState
from irradia.field.backends.drjit_adam import Learned, StepScalars, adam_step, scalars_of
from irradia.field.backends.drjit_encoding import Constants, place_all
from irradia.field.backends.drjit_field import encode, points_of, precise
from irradia.field.backends.drjit_fixed_point import room_for, scale_of, total
from irradia.field.backends.drjit_network import backward, forward, loss_gradient, pack, unpack
from irradia.field.backends.drjit_tiles import F, Points, Shape, U, n_tiles, shape_of, upload, whole_rows
from irradia.field.spec import FieldSpec

_GROUPS = ("parameters", "first", "second", "average")  # of a TrainState, in the order of Learned


@dataclass
class StepInputs:
    """All that a step reads beside what it learns.

    Attributes:
        points: Positions and normals.
        targets: (n · n_outputs,).
        shape: Of the batch.
        factor: 2 / (n · n_outputs).
        room: Of fixed point.
        encoding, network: Adam's numbers.
        constants: Of each encoding.
        learns: By matrix, 0 where it is frozen; only of those that are in part.
    """

    points: dict[str, Points]
    targets: F
    shape: Shape
    factor: F
    room: U
    encoding: StepScalars
    network: StepScalars
    constants: list[Constants]
    learns: dict[str, F]


class DrJitStepper(Stepper):
    """A training in progress."""

    def __init__(self, spec: FieldSpec, state: TrainState, options: StepOptions, jit: ModuleType) -> None:
        self._spec, self._options, self._jit = spec, options, jit
        self._step = state.step
        self._placed = place_all(spec, jit)
        self._constants = [each.fast.constants() for each in self._placed]
        names = ("position", "direction")
        self._tables = {name: self._uploaded(state, name) for name in names if name in state.parameters}
        self._matrices = self._uploaded_matrices(state)
        self._learning = {name for name in self._tables if name not in options.frozen}
        self._learns = self._frozen_parts()
        self._recorded: dict[int, Any] = {}
        dr.sync_thread()  # copying has ended

    def step(self, batch: Batch, rates: Rates) -> float:
        """See the base class."""
        self._step += 1
        tiles = n_tiles(len(batch))
        if tiles not in self._recorded:
            self._recorded[tiles] = dr.freeze(lambda *arrays: self._traced(tiles, *arrays))
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

    def _traced(
        self, tiles: int, tables: dict[str, Learned], matrices: list[Learned], inputs: StepInputs
    ) -> tuple[dict[str, Learned], list[Learned], F]:
        """A step as Dr.Jit records it: everything that changes comes as an argument."""
        jit, spec, options = self._jit, self._spec, self._options
        values = {name: learned[0] for name, learned in tables.items()}
        weights = [learned[0] for learned in matrices]
        features = encode(
            jit, spec, self._placed, inputs.points, values, inputs.shape, inputs.constants, tiles
        )
        tape = forward(jit, spec, weights, features, tiles)
        losses, gradient = loss_gradient(
            jit, spec, options.loss, tape.raw[-1], inputs.targets, inputs.shape, inputs.factor
        )
        of_matrices, of_features = backward(jit, spec, weights, tape, gradient, bool(self._learning))
        tables = self._learn_tables(tables, of_features, inputs)
        matrices = [
            self._learn_matrix(i, *pair, inputs)
            for i, pair in enumerate(zip(matrices, of_matrices, strict=True))
        ]
        dr.eval(tables, matrices, losses)
        return tables, matrices, losses

    def _learn_tables(
        self, tables: dict[str, Learned], of_features: F | None, inputs: StepInputs
    ) -> dict[str, Learned]:
        if of_features is None:
            return tables
        jit, options = self._jit, self._options
        before, after = scale_of(jit, of_features, inputs.room)
        sums = {name: dr.zeros(jit.UInt64, dr.width(tables[name][0])) for name in sorted(self._learning)}
        n_rows = whole_rows(self._spec.n_inputs)
        for each, own in zip(self._placed, inputs.constants, strict=True):
            if each.name in sums:
                points = inputs.points[each.name]
                each.learn(of_features, n_rows, points, before, sums[each.name], inputs.shape, own)
        learned = {
            name: adam_step(
                tables[name], total(jit, own, after), inputs.encoding, options.encoding_adam, options.average
            )
            for name, own in sums.items()
        }
        return tables | learned

    def _learn_matrix(self, i: int, learned: Learned, gradient: F, inputs: StepInputs) -> Learned:
        options = self._options
        if {f"mlp.{i}.weight", f"mlp.{i}.bias"} <= options.frozen:
            return learned
        learns = inputs.learns.get(str(i))
        return adam_step(learned, gradient, inputs.network, options.network_adam, options.average, learns)

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
