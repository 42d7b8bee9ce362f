"""One file per disturbance; each turns times and places into the magnetic field that something in the world adds.

The world's own, before the sensor's: what a magnetometer makes of it, and of iron fixed to the sensor, is the
business of effects. A plug-in is a module with `DISTURBANCE`, a frozen dataclass that meets
`kreisel.data.environment.Disturbance`, and `example()`, one with sensible values; the file name is the `kind` that
scenarios name, and the parameters are their keys.
"""

from __future__ import annotations

from typing import Protocol

from kreisel.data.environment import Disturbance


class DisturbancePlugin(Protocol):
    """What a module in this folder offers."""

    DISTURBANCE: type[Disturbance]

    def example(self) -> Disturbance:
        """One with sensible values."""
        ...
