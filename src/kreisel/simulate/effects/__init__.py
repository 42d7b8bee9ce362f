"""One file per effect; each turns readings into what an imperfect sensor makes of them.

A plug-in is a module with `example()`, its effect with sensible parameters, and `zero()`, the same effect
with parameters at which it changes nothing; the contract tests use both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar, Protocol, runtime_checkable

from kreisel.data.checks import Array
from kreisel.maths.random import Stream, Words
from kreisel.simulate.context import Context


class Effect(Protocol):
    """A frozen dataclass of parameters in SI units, the unit of the sensor for readings (a magnetometer's: uT)."""

    is_bias: ClassVar[bool]
    """Whether what it adds is part of the bias that a filter may estimate."""

    @property
    def name(self) -> str:
        """Key of its random stream and of its error term; unlike that of any other effect on the sensor."""
        ...

    @property
    def idle(self) -> bool:
        """True when these parameters change nothing; the effect is then left out."""
        ...

    def start(self, context: Context, stream: Stream) -> Array:
        """State, an array of any shape, before the first sample; `context` is that of the first block.

        Raises ValueError where the effect does not suit the sensor or its surroundings.
        """
        ...

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Readings (n, 3) with the effect, from `block` (n, 3), which is left as it is; updates `state`.

        Random numbers are addressed by the number of the sample, so that blocks give the bits of the whole.
        """
        ...


PutAbreast = Callable[[Words, int, Array], None]


@runtime_checkable
class LaneEffect(Protocol):
    """An Effect without state that can also make the readings of many runs, abreast, of the one that all share."""

    def abreast(self, block: Array, context: Context) -> PutAbreast:
        """What puts `apply` of `block` (n, 3), with the stream of each lane, into its places, for any streams.

        Its arguments: words (4, LANES) of the streams (`words_abreast`) at the first sample of the context, and
        rows from which number on of which readings (n, 9, LANES).
        """
        ...


class EffectPlugin(Protocol):
    """What a module in this folder offers beside its public names."""

    def example(self) -> Effect:
        """The effect with sensible parameters."""
        ...

    def zero(self) -> Effect:
        """The effect with parameters at which it changes nothing."""
        ...
