"""Turns the ideal reading of one sensor into its real one, by effects that act one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from kreisel.data.checks import Array
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context
from kreisel.simulate.effects import Effect

BLOCK = 8192
"""Samples per block: a block and its copies fit the second-level cache."""


class Sensed(NamedTuple):
    """What one sensor reads, and its bias."""

    reading: Array  # (n, 3)
    bias: Array  # (n, 3) sum of what the effects that are biases added


def sense(
    effects: Sequence[Effect],
    ideal: Array,
    contexts: Iterable[Context],
    stream_of: Callable[[str], Stream],
    errors: Mapping[str, Array] | None = None,
) -> Sensed:
    """Send `ideal` (n, 3) through `effects`, block by block; `contexts` are those of all blocks, in order.

    errors: name of the effect -> array (n, 3) that takes what it added; of effects not in it nothing is kept.
    """
    kept = errors or {}
    sensed = Sensed(np.empty_like(ideal), np.zeros_like(ideal))
    acting = [(effect, stream_of(effect.name)) for effect in effects if not effect.idle]
    states: list[Array] = []
    for context in contexts:
        states = states or [effect.start(context, stream) for effect, stream in acting]
        rows = slice(context.first, context.first + len(context.t))
        block = unbiased = ideal[rows]
        bias = sensed.bias[rows]
        for k, (effect, stream) in enumerate(acting):
            after = effect.apply(states[k], block, context, stream)
            if effect.name in kept:
                np.subtract(after, block, out=kept[effect.name][rows])
            unbiased = unbiased if effect.is_bias else after
            if effect.is_bias and not _bias_follows(acting, k):
                _add_difference(argument(after), argument(unbiased), bias)
            block = after
        sensed.reading[rows] = block
    return sensed


def read(
    effects: Sequence[Effect],
    ideal: Array,
    contexts: Iterable[Context],
    stream_of: Callable[[str], Stream],
    out: Array,
) -> None:
    """The reading that `sense` gives of the same, into `out` (n, 3), and nothing beside it."""
    acting = [(effect, stream_of(effect.name)) for effect in effects if not effect.idle]
    states: list[Array] = []
    for context in contexts:
        states = states or [effect.start(context, stream) for effect, stream in acting]
        rows = slice(context.first, context.first + len(context.t))
        block = ideal[rows]
        for state, (effect, stream) in zip(states, acting, strict=True):
            block = effect.apply(state, block, context, stream)
        out[rows] = block


@kernel
def _add_difference(after: Array, before: Array, total: Array) -> None:
    for k in range(total.shape[0]):
        for a in range(3):
            total[k, a] += after[k, a] - before[k, a]


def _bias_follows(acting: Sequence[tuple[Effect, Stream]], k: int) -> bool:
    """Whether the next effect is a bias too: those that follow each other are taken together."""
    return k + 1 < len(acting) and acting[k + 1][0].is_bias
