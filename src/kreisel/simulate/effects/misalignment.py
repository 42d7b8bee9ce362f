"""Turns readings along true axes into readings along axes that are turned and not square."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, finite, per_axis, regular, shaped
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.maths.rotations import exp_so3
from kreisel.simulate.context import Context

LARGEST_ANGLE = 0.1
"""Deviation of the draws at most, rad: a radian of them could leave no axes at all."""


@dataclass(frozen=True, slots=True, eq=False)
class Misalignment:
    """matrix @ reading: the rows of `matrix` (3, 3) are the sensitive axes, in S; see `from_angles`.

    Lengths of the rows other than one are scale factors. To each element off the diagonal comes one draw of
    deviation `sigma` per run, rad, one or per sensitive axis: the cross-axis sensitivity of a datasheet.
    """

    matrix: Any = field(default_factory=lambda: np.eye(3))
    sigma: Any = 0.0
    name: str = field(default="misalignment", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "matrix", regular("matrix", self.matrix, "without unit"))
        object.__setattr__(self, "sigma", per_axis("sigma", self.sigma, "rad", 0.0, LARGEST_ANGLE))

    @classmethod
    def from_angles(
        cls, turn: Any = (0.0, 0.0, 0.0), skew: Any = (0.0, 0.0, 0.0), *, name: str = "misalignment"
    ) -> Misalignment:
        """The triad turned as a whole by the rotation vector `turn` (3,), rad, and out of square by `skew` (3,), rad.

        skew: (xy, xz, yz); y leans towards x by xy, z towards x by xz and towards y by yz; each lean is an angle
        to first order, and no axis changes its length by more than second order.
        """
        v = finite("turn", shaped("turn", turn, (3,)))
        xy, xz, yz = finite("skew", shaped("skew", skew, (3,)))
        lean = np.array([[1.0, 0.0, 0.0], [xy, 1.0, 0.0], [xz, yz, 1.0]])
        return cls(lean @ exp_so3(v).T, name=name)

    @property
    def idle(self) -> bool:
        """True when the axes are the true ones."""
        return bool((self.matrix == np.eye(3)).all() and not self.sigma.any())

    def start(self, context: Context, stream: Stream) -> Array:
        """The sensitive axes of this run, row by row (9,)."""
        drawn = self.sigma[:, None] * stream.normals(0, 3) * (1.0 - np.eye(3))
        return np.asarray((self.matrix + drawn).ravel())

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) along the sensitive axes."""
        out = np.empty_like(block)
        _turn(argument(block), argument(state.reshape(3, 3)), out)
        return out


@kernel
def _turn(block: Array, matrix: Array, out: Array) -> None:
    for k in range(block.shape[0]):
        x, y, z = block[k, 0], block[k, 1], block[k, 2]
        for a in range(3):
            out[k, a] = matrix[a, 0] * x + matrix[a, 1] * y + matrix[a, 2] * z


def example() -> Misalignment:
    """Half a degree here and there."""
    return Misalignment.from_angles(turn=(0.008, -0.005, 0.003), skew=(0.004, -0.002, 0.006))


def zero() -> Misalignment:
    """The true axes."""
    return Misalignment()
