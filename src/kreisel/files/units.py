"""Turns a unit as people write it into the factor to ours: SI, radians and microtesla."""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass

from kreisel.data.checks import Array
from kreisel.data.environment import STANDARD_GRAVITY


@dataclass(frozen=True, slots=True)
class Scale:
    """value * times / over, kept apart because dividing by 1000 rounds once and times 0.001 twice."""

    times: float = 1.0
    over: float = 1.0

    def __call__(self, values: Array) -> Array:
        return values if self == Scale() else values * self.times / self.over


_DEGREE = Scale(math.pi, 180.0)
_ARC_SECOND = Scale(math.pi, 648_000.0)

UNITS: dict[str, dict[str, Scale]] = {
    "time": {"s": Scale(), "ms": Scale(1, 1e3), "us": Scale(1, 1e6), "ns": Scale(1, 1e9)},
    "length": {"m": Scale(), "mm": Scale(1, 1e3), "cm": Scale(1, 1e2), "km": Scale(1e3)},
    "angle": {
        "rad": Scale(),
        "deg": _DEGREE,
        "mrad": Scale(1, 1e3),
        "urad": Scale(1, 1e6),
        "arcsec": _ARC_SECOND,
    },
    "speed": {
        "m/s": Scale(),
        "mm/s": Scale(1, 1e3),
        "cm/s": Scale(1, 1e2),
        "km/h": Scale(1, 3.6),
        "g*s": Scale(STANDARD_GRAVITY),
    },
    "acceleration": {
        "m/s^2": Scale(),
        "g": Scale(STANDARD_GRAVITY),
        "mg": Scale(STANDARD_GRAVITY, 1e3),
        "mm/s^2": Scale(1, 1e3),
        "cm/s^2": Scale(1, 1e2),
    },
    "rate": {"rad/s": Scale(), "deg/s": _DEGREE, "mrad/s": Scale(1, 1e3), "mdeg/s": Scale(math.pi, 180e3)},
    "angular acceleration": {"rad/s^2": Scale(), "deg/s^2": _DEGREE},
    "field": {
        "uT": Scale(),
        "T": Scale(1e6),
        "mT": Scale(1e3),
        "nT": Scale(1, 1e3),
        "gauss": Scale(1e2),
        "mgauss": Scale(1, 10),
    },
    "temperature": {"degC": Scale()},
    "number": {"": Scale(), "1": Scale()},
}
"""Units of each kind of quantity; ours comes first."""

_OTHER_SPELLINGS = {
    "dps": "deg/s",
    "C": "degC",
    "degc": "degC",
    "celsius": "degC",
    "mdps": "mdeg/s",
    "microtesla": "uT",
    "arcs": "arcsec",
    "gs": "g*s",
    "G": "gauss",
    "Gs": "gauss",
    "mG": "mgauss",
}

_SIGNS = str.maketrans({"²": "2", "¹": "1", "⁻": "-", "°": "deg", "µ": "u", "μ": "u", "·": " ", "*": " "})

# In turn: powers without a hat, words to symbols, s^-1 and /s/s to quotients.
_REWRITES = (
    (r"\^", ""),
    (r"deg(rees?)?", "deg"),
    (r"rad(ians?)?", "rad"),
    (r"sec(onds?)?|\bsecs?\b", "s"),
    (r" +s-1$", "/s"),
    (r" +s-2$|/s/s$|/s2$", "/s^2"),
    (r"\s+", ""),
)


def scale(unit: str, quantity: str) -> Scale:
    """The factor from `unit` to ours; ValueError naming the units this quantity may have."""
    known = UNITS[quantity]
    plain = _plain(unit)
    for candidate in (plain, _OTHER_SPELLINGS.get(plain, ""), *_relaxed(plain, quantity)):
        if candidate in known and (candidate or not plain):
            return known[candidate]
    near = difflib.get_close_matches(plain, [*known, *_OTHER_SPELLINGS], n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    listed = ", ".join(name for name in known if name) or "none"
    raise ValueError(f"{unit!r} is no unit of {quantity}.{hint} Known: {listed}.")


def _plain(unit: str) -> str:
    """One spelling of powers, products and quotients: m s^-2, m/s², m/s/s and m/s2 are m/s^2."""
    text = unit.strip().translate(_SIGNS)
    for pattern, replacement in _REWRITES:
        text = re.sub(pattern, replacement, text, flags=re.IGNORECASE)
    return text


def _relaxed(plain: str, quantity: str) -> list[str]:
    """Capitals people use where they cannot be mistaken: [S], [Deg], [G] for an acceleration."""
    lowered = plain.lower()
    if quantity == "field":
        return [{"ut": "uT", "mt": "mT", "nt": "nT", "t": "T", "g": "gauss"}.get(lowered, lowered)]
    return [lowered, _OTHER_SPELLINGS.get(lowered, "")]
