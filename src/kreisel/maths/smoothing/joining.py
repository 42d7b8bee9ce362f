"""Turns a recording that jumps into one that does not: its parts are moved to join the longest, which stays.

A body keeps its velocity where a marker is taken for another: joined, both sides say how it moves there.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

from kreisel.maths.smoothing.axes import multiplied
from kreisel.maths.smoothing.bands import basis_rows, knots_at, product
from kreisel.maths.smoothing.likelihood import Choice
from kreisel.maths.smoothing.outliers import Division
from kreisel.maths.smoothing.system import Samples, System

Array = npt.NDArray[np.float64]

# Samples on either side that say how far a jump goes.
_AROUND = 160


def joined(samples: Samples, choice: Choice, division: Division) -> tuple[Samples, Array]:
    """The samples without the jumps at the breaks of `division`, and how far (m, c) these went."""
    sizes = np.zeros((len(division.breaks), samples.x.shape[1]))
    # Unit quaternions turn about the axes of B, as if it had been defined anew.
    moves: _Moves = _Turns() if samples.dimensions == 3 else _Shifts()
    x = samples.x.copy()
    for k, (place, end) in enumerate(division.edges[1:]):
        first = max(0, place - _AROUND)
        rows = first + np.flatnonzero(division.kept[first : min(end, place + _AROUND)])
        before, sizes[k] = _jump(samples._replace(x=x).part(rows), choice, int(np.searchsorted(rows, place)))
        x[place:] = moves.back(x[place:], before, before + sizes[k])
    longest = max(division.edges, key=lambda edges: edges[1] - edges[0])[0]
    return samples._replace(x=moves.back(x, samples.x[longest], x[longest])), sizes


class _Moves(Protocol):
    """A way to move samples."""

    def back(self, x: Array, before: Array, after: Array) -> Array:
        """Samples `x` (n, c), so that what was `after` is `before`."""
        ...


class _Shifts:
    def back(self, x: Array, before: Array, after: Array) -> Array:
        """Shifted."""
        return np.asarray(x + (before - after))


class _Turns:
    def back(self, x: Array, before: Array, after: Array) -> Array:
        """Quaternions q after^-1 before."""
        turn = multiplied((after * [1.0, -1.0, -1.0, -1.0])[None], before)[0]
        return multiplied(x, turn / np.linalg.norm(turn))


def _jump(samples: Samples, choice: Choice, place: int) -> tuple[Array, Array]:
    """(c,) value before the jump that comes before row `place`, and its size: generalised least squares."""
    step = (np.arange(len(samples.t)) >= place).astype(np.float64)
    centre = samples.x.mean(axis=0)
    both = samples._replace(x=np.column_stack([samples.x - centre, step]), rate=None)
    system = System(both, knots_at(both.t, choice.spacing), choice.spacing)
    c = system.solve(choice.smoothness).coefficients
    news, left = system.news(c, choice.smoothness.memory)
    size = left[:, -1] @ news[:, :-1] / (left[:, -1] @ news[:, -1])
    middle = 0.5 * (both.t[place - 1 : place] + both.t[place : place + 1])
    without = c[:, :-1] - c[:, -1:] * size
    return centre + product(basis_rows(system.knots, middle), without)[0], size
