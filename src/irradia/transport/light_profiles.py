"""Measured light distributions on the device."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from irradia.scene.light_profile import profile_frame
from irradia.scene.types import IesProfile, Light
from irradia.transport.backend import dr, mi


class LightProfiles:
    """The candela of lights that have a profile, interpolated as ``light_candela`` does it.

    Lights that share a profile share its table.
    """

    def __init__(self, lights: Sequence[Light]) -> None:
        tables: dict[int, tuple[int, IesProfile]] = {}
        ints, floats = np.zeros((len(lights), 4), np.uint32), np.zeros((len(lights), 4), np.float32)
        size = 0
        for index, light in enumerate(lights):
            if light.profile is None:
                continue
            if id(light.profile) not in tables:
                tables[id(light.profile)] = (size, light.profile)
                size += light.profile.candela.size
            first, profile = tables[id(light.profile)]
            ints[index] = (first, *profile.candela.shape, 1)
            floats[index, :3] = profile_frame(light)[1]
        self._candela = mi.Float(np.concatenate([p.candela.ravel() for _, p in tables.values()]))
        self._ints, self._floats = mi.UInt32(ints.ravel()), mi.Float(floats.ravel())

    def weigh(
        self, share: mi.Float, index: mi.UInt32, axis: mi.Vector3f, direction: mi.Vector3f, active: mi.Bool
    ) -> mi.Float:
        """The candela of ``index`` along a unit direction away from it; ``share`` where it has no profile."""
        row = dr.gather(mi.Vector4u, self._ints, index, active)
        first, n_rows, n_columns = row.x, row.y, row.z
        measured = active & (row.w != 0)
        row_f = dr.gather(mi.Vector4f, self._floats, index, measured)
        across = mi.Vector3f(row_f.x, row_f.y, row_f.z)

        # ---- angles, as places in the table ----
        vertical = dr.safe_acos(dr.dot(direction, axis)) * (1.0 / math.pi)
        turn = dr.atan2(dr.dot(direction, dr.cross(across, axis)), dr.dot(direction, across))
        horizontal = turn * (0.5 / math.pi)
        horizontal -= dr.floor(horizontal)
        last_row, last_column = mi.Float(n_rows) - 1.0, mi.Float(n_columns) - 1.0
        y, x = vertical * last_row, horizontal * last_column
        y0 = dr.clip(dr.floor(y), 0.0, dr.maximum(last_row - 1.0, 0.0))
        x0 = dr.clip(dr.floor(x), 0.0, dr.maximum(last_column - 1.0, 0.0))

        # ---- between four values ----
        corner = first + mi.UInt32(y0) * n_columns + mi.UInt32(x0)
        top = [dr.gather(mi.Float, self._candela, corner + i, measured) for i in (0, 1)]
        bottom = [dr.gather(mi.Float, self._candela, corner + n_columns + i, measured) for i in (0, 1)]
        candela = dr.lerp(dr.lerp(*top, x - x0), dr.lerp(*bottom, x - x0), y - y0)
        return dr.select(measured, candela, share)
