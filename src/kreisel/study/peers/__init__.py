"""One file per attitude filter of others; each turns a complete recording into attitude by its defaults.

The name a user types is the file name with dashes: ``ahrs_mahony.py`` is ``ahrs-mahony``.
"""

from __future__ import annotations

from typing import Protocol

from kreisel.data.checks import Array


class Peer(Protocol):
    """What a module in this folder offers; it loads the other's package when it is called, not before."""

    PACKAGE: str  # the package it imports, part of the extra `compare`
    SETTINGS: str  # for tables: what runs, and with which tuning

    def estimate(self, gyro: Array, accel: Array, mag_uT: Array, step: float) -> Array:
        """R_NS (n, 3, 3), east north up, of readings (n, 3) in rad/s, m/s^2 and uT, `step` s apart.

        ImportError where the package is not installed.
        """
        ...
