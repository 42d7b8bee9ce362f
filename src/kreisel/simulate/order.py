"""Turns the effects of a sensor and one more into the same in physical order, from the outer world to the output."""

from __future__ import annotations

from collections.abc import Sequence

from kreisel.data.checks import choice
from kreisel.simulate.effects import Effect

ORDER = (
    "vibration_lines",
    "vibration_noise",
    "hard_soft_iron",
    "misalignment",
    "scale_factor",
    "temperature_scale",
    "nonlinearity",
    "g_sensitivity",
    "turn_on_bias",
    "temperature_bias",
    "bias_instability",
    "bias_random_walk",
    "gauss_markov",
    "white_noise",
    "bandwidth",
    "range",
    "quantisation",
    "increment_quantisation",
)
"""Plug-ins from what shakes the sensor, through what it makes of that, to how it puts it out."""

# Of plug-ins that are not in the list: behind the noise, so that filter, range and steps act on them.
_ELSEWHERE = ORDER.index("bandwidth") - 0.5


def placed(
    effects: Sequence[Effect], effect: Effect, before: str | None = None, after: str | None = None
) -> tuple[Effect, ...]:
    """`effects` with `effect` at its place in physical order, or next to the one whose name is given.

    Raises ValueError with the nearest name where there is none of that name.
    """
    names = [each.name for each in effects]
    if before is not None and after is not None:
        raise ValueError(f"before {before!r} and after {after!r} are two places; give one of them.")
    if before is not None:
        k = names.index(_known("before", before, names))
    elif after is not None:
        k = names.index(_known("after", after, names)) + 1
    else:
        k = next((k for k, other in enumerate(effects) if _rank(other) > _rank(effect)), len(names))
    return (*effects[:k], effect, *effects[k:])


def _known(key: str, name: str, names: Sequence[str]) -> str:
    if not names:
        raise ValueError(f"{key} {name!r} is no place: this sensor has no other effects.")
    return choice(key, name, names)


def _rank(effect: Effect) -> float:
    plugin = type(effect).__module__.rsplit(".", 1)[-1]
    return ORDER.index(plugin) if plugin in ORDER else _ELSEWHERE
