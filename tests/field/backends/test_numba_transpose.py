"""Eight vectors turned over in registers."""

from __future__ import annotations

import numpy as np

from irradia.field.backends.numba_compile import inner
from irradia.field.backends.numba_transpose import transpose8
from irradia.field.backends.numba_vector import load8, store8


@inner
def transposed(source, target):
    a, b, c, d = load8(source, (0, 0)), load8(source, (1, 0)), load8(source, (2, 0)), load8(source, (3, 0))
    e, f, g, h = load8(source, (4, 0)), load8(source, (5, 0)), load8(source, (6, 0)), load8(source, (7, 0))
    for i, row in enumerate(transpose8(a, b, c, d, e, f, g, h)):
        store8(target, (i, 0), row)


def test_rows_become_columns():
    source = np.arange(64, dtype=np.float32).reshape(8, 8)
    target = np.zeros_like(source)
    transposed(source, target)
    np.testing.assert_array_equal(target, source.T)
