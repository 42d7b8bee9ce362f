"""Turns the magnetic field of the Earth into that beside magnets and iron fixed to the sensor."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, finite, regular, shaped
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class HardSoftIron:
    """soft_iron @ field + hard_iron_uT: iron near the sensor bends the field, magnets add their own.

    hard_iron_uT: (3,) microtesla in S; soft_iron: (3, 3), without unit.
    Source: Vasconcelos et al. 2011, "Geometric approach to strapdown magnetometer calibration", section II.
    """

    hard_iron_uT: Any = (0.0, 0.0, 0.0)
    soft_iron: Any = field(default_factory=lambda: np.eye(3))
    name: str = field(default="hard_soft_iron", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "hard_iron_uT", finite("hard_iron_uT", shaped("hard_iron_uT", self.hard_iron_uT, (3,))))
        put(self, "soft_iron", regular("soft_iron", self.soft_iron, "without unit"))

    @property
    def idle(self) -> bool:
        """True far from magnets and iron."""
        return not self.hard_iron_uT.any() and bool((self.soft_iron == np.eye(3)).all())

    def start(self, context: Context, stream: Stream) -> Array:
        """Nothing to remember; ValueError for any sensor but a magnetometer."""
        if context.sensor != "mag_uT":
            raise ValueError("hard and soft iron bend magnetic fields; put HardSoftIron into mag_effects.")
        return np.zeros(0)

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) microtesla, bent."""
        out = np.empty_like(block)
        _bend(argument(block), self.soft_iron, self.hard_iron_uT, out)
        return out


@kernel
def _bend(block: Array, soft: Array, hard: Array, out: Array) -> None:
    for k in range(block.shape[0]):
        x, y, z = block[k, 0], block[k, 1], block[k, 2]
        for a in range(3):
            out[k, a] = soft[a, 0] * x + soft[a, 1] * y + soft[a, 2] * z + hard[a]


def example() -> HardSoftIron:
    """A phone."""
    soft = np.array([[1.05, 0.02, -0.01], [0.02, 0.97, 0.03], [-0.01, 0.03, 1.01]])
    return HardSoftIron(hard_iron_uT=(12.0, -30.0, 7.0), soft_iron=soft)


def zero() -> HardSoftIron:
    """No magnets, no iron."""
    return HardSoftIron()
