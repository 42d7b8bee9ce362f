"""Turns noise coefficients in SI units into those of datasheets: deg/s/sqrt(Hz), deg/h, ug, nT and their like."""

from __future__ import annotations

import math
from dataclasses import dataclass

from kreisel.data.environment import STANDARD_GRAVITY

_DEG = 180.0 / math.pi
_UG = 1e6 / STANDARD_GRAVITY


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit and the number that SI values are multiplied by."""

    name: str
    factor: float


READING = {
    "gyro": (Unit("deg/s", _DEG), Unit("deg/h", 3600.0 * _DEG)),
    "accel": (Unit("m/s^2", 1.0), Unit("ug", _UG)),
    "mag": (Unit("uT", 1.0), Unit("nT", 1e3)),
}
"""Units of readings, and of their Allan deviation, by sensor."""

COEFFICIENT = {
    "gyro": {
        "N": (Unit("deg/s/sqrt(Hz)", _DEG), Unit("deg/sqrt(h)", 60.0 * _DEG)),
        "B": (Unit("deg/h", 3600.0 * _DEG),),
        "K": (Unit("deg/h/sqrt(h)", 3600.0 * 60.0 * _DEG), Unit("deg/s/sqrt(s)", _DEG)),
    },
    "accel": {
        "N": (Unit("ug/sqrt(Hz)", _UG), Unit("m/s/sqrt(h)", 60.0)),
        "B": (Unit("ug", _UG),),
        "K": (Unit("ug/sqrt(s)", _UG), Unit("ug/sqrt(h)", 60.0 * _UG)),
    },
    "mag": {
        "N": (Unit("uT/sqrt(Hz)", 1.0), Unit("nT/sqrt(Hz)", 1e3)),
        "B": (Unit("nT", 1e3),),
        "K": (Unit("nT/sqrt(s)", 1e3),),
    },
}
"""Units of N, B and K by sensor, the commonest first."""
