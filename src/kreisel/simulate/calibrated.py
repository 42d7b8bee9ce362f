"""Turns the calibration of a real sensor into the effects that give a simulated one the same errors."""

from __future__ import annotations

from typing import NamedTuple

from kreisel.data.calibration import Calibration
from kreisel.simulate.effects import Effect
from kreisel.simulate.effects.hard_soft_iron import HardSoftIron
from kreisel.simulate.effects.misalignment import Misalignment
from kreisel.simulate.effects.turn_on_bias import TurnOnBias


class Effects(NamedTuple):
    """What each sensor of an `Imu` takes."""

    gyro: tuple[Effect, ...] = ()
    accel: tuple[Effect, ...] = ()
    mag: tuple[Effect, ...] = ()


def effects_of(calibration: Calibration) -> Effects:
    """Effects whose readings `calibration.apply` turns back into the truth."""
    gyro, accel = (
        () if triad is None else (Misalignment(triad.matrix), TurnOnBias(fixed=triad.bias))
        for triad in (calibration.gyro, calibration.accel)
    )
    mag = calibration.mag
    return Effects(gyro, accel, () if mag is None else (HardSoftIron(mag.bias, mag.matrix),))
