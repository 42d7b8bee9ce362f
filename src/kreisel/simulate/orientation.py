"""Turns any description of attitude that a user may hold into unit quaternions."""

from __future__ import annotations

from typing import Any

import numpy as np

from kreisel.data.checks import Array, as_array, finite, radians, rotations, shaped, unit_quaternions
from kreisel.maths.rotations import continuous_signs, matrix_from_euler, quat_wxyz_from_matrix
from kreisel.simulate.samples import known_rows


def quaternions(orientation: Any, order: str | None) -> Array:
    """q_NB_wxyz (n, 4) from any of the descriptions of attitude a user may hold.

    Sign-continuous from row to row; NaN where a row has NaN.
    """
    if hasattr(orientation, "as_matrix"):
        orientation = orientation.as_matrix()
    if np.ndim(orientation) < 2 or not len(orientation):
        return _complete_quaternions(orientation, order)
    rows = measured("orientation", as_array("orientation", orientation))
    known = known_rows(rows)
    if known.all():
        return _complete_quaternions(orientation, order)
    q = np.full((len(rows), 4), np.nan)
    q[known] = _complete_quaternions(rows[known], order)
    return q


def measured(name: str, x: Array) -> Array:
    """`x` itself, or a ValueError for a number that is infinite; NaN is a missing sample."""
    finite(name, np.where(np.isnan(x), 0.0, x))
    return x


def _complete_quaternions(orientation: Any, order: str | None) -> Array:
    shape = np.shape(orientation)
    if shape[1:] == (3, 3):
        R = rotations("orientation", shaped("orientation", orientation, ("n", 3, 3)))
        return quat_wxyz_from_matrix(R)
    if shape[1:] == (3,):
        phi = radians("orientation", finite("orientation", shaped("orientation", orientation, ("n", 3))))
        return quat_wxyz_from_matrix(matrix_from_euler(phi))
    if shape[1:] == (4,):
        if order is None:
            raise ValueError(
                f'quaternions need order="wxyz" or order="xyzw"; got {order!r}. '
                "ROS, TUM files and SciPy write xyzw; MATLAB, EuRoC and Eigen's constructor wxyz."
            )
        q = unit_quaternions("orientation", shaped("orientation", orientation, ("n", 4)))
        return continuous_signs(q if order == "wxyz" else q[:, [3, 0, 1, 2]])
    raise ValueError(
        "orientation must be Euler angles (n, 3), quaternions (n, 4), matrices (n, 3, 3), a SciPy Rotation, "
        f'"tangent" or "transport"; got shape {shape}.'
    )
