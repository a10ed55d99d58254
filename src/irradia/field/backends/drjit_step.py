"""One step of training: forward, backward, Adam."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType

import drjit as dr

from irradia.field.backend import StepOptions
from irradia.field.backends.drjit_adam import Learned, StepScalars, adam_step
from irradia.field.backends.drjit_encoding import Constants, Placed
from irradia.field.backends.drjit_field import encode
from irradia.field.backends.drjit_fixed_point import scale_of, total
from irradia.field.backends.drjit_network import backward, forward, loss_gradient
from irradia.field.backends.drjit_tiles import F, Points, Shape, U, whole_rows
from irradia.field.spec import FieldSpec

Tables = dict[str, Learned]  # by name: position, direction
Matrices = list[Learned]


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


class StepProgram:
    """A step as Dr.Jit traces it. It holds no array: everything that changes is an argument."""

    def __init__(
        self, spec: FieldSpec, options: StepOptions, jit: ModuleType, placed: list[Placed], tables: set[str]
    ) -> None:
        self._spec, self._options, self._jit, self._placed = spec, options, jit, placed
        self._learning = sorted(tables - options.frozen)

    def recorded(self, tiles: int) -> Callable[[Tables, Matrices, StepInputs], tuple[Tables, Matrices, F]]:
        """:meth:`run` for batches of so many tiles: traced the first time, then replayed."""
        return dr.freeze(lambda *arguments: self.run(tiles, *arguments))

    def run(
        self, tiles: int, tables: Tables, matrices: Matrices, inputs: StepInputs
    ) -> tuple[Tables, Matrices, F]:
        """What is learnt after the step, and the loss before it: sums of penalties, tile by tile."""
        jit, spec = self._jit, self._spec
        values = {name: learned[0] for name, learned in tables.items()}
        weights = [learned[0] for learned in matrices]
        features = encode(
            jit, spec, self._placed, inputs.points, values, inputs.shape, inputs.constants, tiles
        )
        tape = forward(jit, spec, weights, features, tiles)
        losses, gradient = loss_gradient(
            jit, spec, self._options.loss, tape.raw[-1], inputs.targets, inputs.shape, inputs.factor
        )
        of_matrices, of_features = backward(jit, spec, weights, tape, gradient, bool(self._learning))
        if of_features is not None:
            tables = tables | self._learn_tables(tables, of_features, inputs)
        pairs = zip(matrices, of_matrices, strict=True)
        matrices = [self._learn_matrix(i, *pair, inputs) for i, pair in enumerate(pairs)]
        dr.eval(tables, matrices, losses)
        return tables, matrices, losses

    def _learn_tables(self, tables: Tables, of_features: F, inputs: StepInputs) -> Tables:
        jit, options = self._jit, self._options
        before, after = scale_of(jit, of_features, inputs.room)
        sums = {name: dr.zeros(jit.UInt64, dr.width(tables[name][0])) for name in self._learning}
        n_rows = whole_rows(self._spec.n_inputs)
        for each, own in zip(self._placed, inputs.constants, strict=True):
            if each.name in sums:
                points = inputs.points[each.name]
                each.learn(of_features, n_rows, points, before, sums[each.name], inputs.shape, own)
        gradients = {name: total(jit, own, after) for name, own in sums.items()}
        return {
            name: adam_step(tables[name], gradient, inputs.encoding, options.encoding_adam, options.average)
            for name, gradient in gradients.items()
        }

    def _learn_matrix(self, i: int, learned: Learned, gradient: F, inputs: StepInputs) -> Learned:
        options = self._options
        if {f"mlp.{i}.weight", f"mlp.{i}.bias"} <= options.frozen:
            return learned
        learns = inputs.learns.get(str(i))
        return adam_step(learned, gradient, inputs.network, options.network_adam, options.average, learns)
