"""Turns the readings of a gyro into those of a gyro that feels specific force too."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, finite, per_axis, shaped
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class GSensitivity:
    """Adds sensitivity @ specific force at the mount to a gyro.

    sensitivity: rad/s per m/s^2; (3, 3), or one number or three for the diagonal. 0.1 deg/s per g are
        1.78e-4. To each of the nine elements comes one draw of deviation `sigma` per run, one or per axis of the gyro:
        a datasheet says how much a force makes it read, and neither from where nor with which sign.
    """

    sensitivity: Any = 0.0
    sigma: Any = 0.0
    name: str = field(default="g_sensitivity", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        unit, value = "rad/s per m/s^2", self.sensitivity
        if np.ndim(value) == 2:
            matrix = finite("sensitivity", shaped("sensitivity", value, (3, 3)))
        else:
            matrix = shaped("sensitivity", np.diag(per_axis("sensitivity", value, unit)), (3, 3))
        object.__setattr__(self, "sensitivity", matrix)
        object.__setattr__(self, "sigma", per_axis("sigma", self.sigma, unit, 0.0))

    @property
    def idle(self) -> bool:
        """True for a gyro that feels rotation alone."""
        return not (self.sensitivity.any() or self.sigma.any())

    def start(self, context: Context, stream: Stream) -> Array:
        """The sensitivity of this run, row by row (9,); ValueError for any sensor but a gyro."""
        if context.sensor != "gyro":
            raise ValueError("sensitivity to specific force is a gyro's; put GSensitivity into gyro_effects.")
        return np.asarray((self.sensitivity + self.sigma[:, None] * stream.normals(0, 3)).ravel())

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) rad/s with what the specific force adds."""
        out = np.empty_like(block)
        _add_product(argument(block), argument(state.reshape(3, 3)), argument(context.specific_force), out)
        return out


@kernel
def _add_product(block: Array, matrix: Array, force: Array, out: Array) -> None:
    for k in range(block.shape[0]):
        x, y, z = force[k, 0], force[k, 1], force[k, 2]
        for a in range(3):
            out[k, a] = block[k, a] + (matrix[a, 0] * x + matrix[a, 1] * y + matrix[a, 2] * z)


def example() -> GSensitivity:
    """0.1 deg/s per g along every axis, and a tenth of it, drawn, across."""
    return GSensitivity(sensitivity=1.78e-4, sigma=1.78e-5)


def zero() -> GSensitivity:
    """A gyro that feels rotation alone."""
    return GSensitivity()
