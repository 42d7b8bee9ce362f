"""Turns differences of samples into differences along the axes in which their noise is measured."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def along_axes(value: Array, x: Array) -> Array:
    """Components (n, k) of differences `x` (n, c) from values (n, c): the columns themselves, k = c.

    Those of unit quaternions (c = 4) are halves of small rotations about the three axes of B, k = 3.
    """
    if x.shape[1] != 4:
        return x
    return multiplied(value * [1.0, -1.0, -1.0, -1.0], x)[:, 1:]


def multiplied(p: Array, q: Array) -> Array:
    """Products (n, 4) of quaternions (n, 4) and (n, 4) or (4,), w first."""
    w = p[:, 0] * q[..., 0] - np.sum(p[:, 1:] * q[..., 1:], axis=1)
    v = p[:, :1] * q[..., 1:] + q[..., :1] * p[:, 1:] + np.cross(p[:, 1:], q[..., 1:])
    return np.column_stack([w, v])


def spread(components: Array) -> Array:
    """(k,) size of noise along each axis, per that of their mean square."""
    squares = np.mean(np.square(components), axis=0)
    return np.sqrt(squares / squares.mean()) if squares.all() else np.ones(components.shape[1])
