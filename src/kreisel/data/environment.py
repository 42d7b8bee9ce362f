"""What surrounds the body: gravity and the magnetic field in the navigation frame N."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kreisel.data.checks import Array, finite, shaped

STANDARD_GRAVITY = 9.80665
"""m/s^2; BIPM, SI brochure, conventional value of the acceleration due to gravity."""


@dataclass(frozen=True, slots=True, eq=False)
class Environment:
    """Surroundings of the body, in N (east, north, up)."""

    g_N: Array = field(default_factory=lambda: np.array([0.0, 0.0, -STANDARD_GRAVITY]))  # (3,) m/s^2
    field_N_uT: Array | None = None  # (3,) microtesla; None where nobody asks for a magnetometer

    def __post_init__(self) -> None:
        object.__setattr__(self, "g_N", finite("g_N", shaped("g_N", self.g_N, (3,))))
        if self.field_N_uT is not None:
            field_N_uT = finite("field_N_uT", shaped("field_N_uT", self.field_N_uT, (3,)))
            object.__setattr__(self, "field_N_uT", field_N_uT)
