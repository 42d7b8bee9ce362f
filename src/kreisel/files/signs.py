"""Turns quaternions that come block by block into one sign-continuous sequence."""

from __future__ import annotations

import numpy as np

from kreisel.data.checks import Array
from kreisel.maths.rotations import continuous_signs


class Signs:
    """Remembers the last quaternion, whose hemisphere the next block begins in."""

    def __init__(self) -> None:
        self._last: Array | None = None

    def continued(self, q: Array) -> Array:
        """A block (n, 4), itself sign-continuous, with the signs it has in the whole; NaN rows are passed over."""
        known = np.flatnonzero(np.isfinite(q).all(axis=1))
        if not known.size:
            return q
        first = q[known[0]]
        if self._last is not None and (continuous_signs(np.stack([self._last, first]))[1] != first).any():
            q = np.negative(q)
        self._last = q[known[-1]].copy()
        return q
