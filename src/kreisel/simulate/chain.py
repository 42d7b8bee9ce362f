"""Turns the ideal reading of one sensor into its real one, by effects that act one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from kreisel.data.checks import Array
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.clock import Rows
from kreisel.simulate.context import Context
from kreisel.simulate.effects import Effect

BLOCK = 8192
"""Samples per block: a block and its copies fit the second-level cache."""


class Felt(NamedTuple):
    """What a perfect sensor hands on to its effects."""

    reading: Array  # (n, 3)
    rows: Rows  # of the motion, at whose times it reads so
    dt: Array  # (n,) s, since the reading before
    force: Array  # (n, 3) m/s^2, specific force at the mount
    averaged: bool = False  # whether each reading is the mean over its dt


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
    states: list[Array] | None = None,
) -> Sensed:
    """Send `ideal` (n, 3) through `effects`, block by block; `contexts` are those of all blocks, in order.

    errors: name of the effect -> array (n, 3) that takes what it added; of effects not in it nothing is kept.
    states: those of the effects where `ideal` goes on from an earlier call, changed in place; an empty list is filled.
    """
    kept = errors or {}
    sensed = Sensed(np.empty_like(ideal), np.zeros_like(ideal))
    acting = [(effect, stream_of(effect.name)) for effect in effects if not effect.idle]
    states = [] if states is None else states
    begin = 0
    for context in contexts:
        if not states:
            states += [effect.start(context, stream) for effect, stream in acting]
        rows = slice(begin, begin + len(context.t))
        begin = rows.stop
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
    """The readings that `sense` gives, into `out` (n, 3), and nothing beside them."""
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


def checked_effects(field_name: str, given: Any) -> tuple[Effect, ...]:
    """The effects in `given`; TypeError for anything else in it, such as a class that nobody made an effect of."""
    each = tuple(given) if isinstance(given, Iterable) else (given,)
    strange = [x for x in each if isinstance(x, type) or not callable(getattr(x, "apply", None))]
    if strange or not isinstance(given, Iterable):
        x = strange[0] if strange else given
        got = f"the class {x.__name__}" if isinstance(x, type) else type(x).__name__
        raise TypeError(f"{field_name} must be a list of effects, such as [WhiteNoise(1e-4)]; got {got}.")
    _check_names(field_name, [effect.name for effect in each])
    return each


def _check_names(field_name: str, names: list[str]) -> None:
    repeated = sorted({name for name in names if names.count(name) > 1})
    if repeated:
        raise ValueError(
            f"{field_name} has two effects called {repeated[0]!r}, which would draw the same numbers; "
            f'give one another name, as in name="{repeated[0]}_2".'
        )
