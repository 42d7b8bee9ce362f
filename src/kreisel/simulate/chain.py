"""Turns the ideal reading of one sensor into its real one, by effects that act one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context
from kreisel.simulate.effects import Effect

BLOCK = 4096
"""Samples per block: a block and its copies fit the second-level cache."""


class Sensed(NamedTuple):
    """What one sensor reads, and why."""

    reading: Array  # (n, 3)
    errors: dict[str, Array]  # name of the effect -> (n, 3) what it added
    bias: Array  # (n, 3) sum of the errors that are biases

    def spread(self, rows: npt.NDArray[np.int64], n: int) -> Sensed:
        """The same with n rows: these at `rows`, NaN in between."""
        errors = {name: _spread(added, rows, n) for name, added in self.errors.items()}
        return Sensed(_spread(self.reading, rows, n), errors, _spread(self.bias, rows, n))


def _spread(x: Array, rows: npt.NDArray[np.int64], n: int) -> Array:
    out = np.full((n, 3), np.nan)
    out[rows] = x
    return out


def sense(
    effects: Sequence[Effect],
    ideal: Array,
    contexts: Iterable[Context],
    stream_of: Callable[[str], Stream],
) -> Sensed:
    """Send `ideal` (n, 3) through `effects`, block by block; `contexts` are those of all blocks, in order."""
    sensed = Sensed(
        np.empty_like(ideal), {e.name: np.zeros_like(ideal) for e in effects}, np.zeros_like(ideal)
    )
    acting = [(effect, stream_of(effect.name)) for effect in effects if not effect.idle]
    states: list[Array] = []
    for context in contexts:
        states = states or [effect.start(context, stream) for effect, stream in acting]
        rows = slice(context.first, context.first + len(context.t))
        block = ideal[rows]
        for (effect, stream), state in zip(acting, states, strict=True):
            after = effect.apply(state, block, context, stream)
            added = np.subtract(after, block, out=sensed.errors[effect.name][rows])
            if effect.is_bias:
                sensed.bias[rows] += added
            block = after
        sensed.reading[rows] = block
    return sensed
