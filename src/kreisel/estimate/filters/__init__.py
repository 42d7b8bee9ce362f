"""One file or folder per filter; each turns gyro, accelerometer and magnetometer samples into attitude.

The name a user types is the file name with dashes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from kreisel.estimate.answers import Columns

Array = npt.NDArray[np.float64]

# A filter's state is one flat float64 array that begins with its answer, in these places.
R_NS = 0  # 9: row by row; the first two of unit length, the third their product, all nearly at right angles
GYRO_BIAS = 9  # 3: in S, rad/s
FLAGS = 12  # REST + DISTURBED + HELD of the latest sample
HEADING = 13  # rad: what the magnetometer has turned the answer by, about up
ANSWER = 14  # the number of these places

# Bits of the flags.
REST = 1  # the sensor is taken to be at rest
DISTURBED = 2  # the magnetometer is not trusted
HELD = 4  # the gyro's sample is missing, or nothing has shown yet which way is up


class AttitudeFilter(Protocol):
    """A frozen dataclass of tuning, in seconds and hertz rather than gains; a module offers it as FILTER.

    Beside FILTER stands STATE_VERSION, a number raised whenever places of the state change their meaning.
    """

    @property
    def needs_mag(self) -> bool:
        """Whether a recording without a magnetometer is refused."""
        ...

    @property
    def learns_bias(self) -> bool:
        """False where gyro_bias is zero always; `batch` leaves that column alone then."""
        ...

    def parameters(self) -> Array:
        """The tuning as the flat array that the kernels read."""
        ...

    def start(self, R_NS: Array | None = None) -> Array:
        """A fresh state; R_NS (3, 3) where the first attitude is known, else the first samples tell it."""
        ...

    def update(self, state: Array, parameters: Array, sample: Array, dt: float) -> None:
        """Move `state` in place over the `dt` seconds that end with `sample`: gyro, accel, mag (9,).

        A missing sensor is NaN; dt = 0 changes nothing but a state that has not begun.
        """
        ...

    def batch(
        self,
        state: Array,
        parameters: Array,
        t: Array,
        gyro: Array,
        accel: Array,
        mag: Array,
        out: Columns,
    ) -> None:
        """The same through all samples, t (n,) s and the others (n, 3), the first with dt = 0; fills `out`."""
        ...


@runtime_checkable
class KnowingFilter(Protocol):
    """An AttitudeFilter that knows how well it knows; its `batch` fills `sigma` too."""

    @property
    def sigma(self) -> int:
        """Where its state has three standard deviations of the attitude error about N axes, rad."""
        ...


@runtime_checkable
class SmoothingFilter(KnowingFilter, Protocol):
    """A KnowingFilter that can look at a whole recording."""

    def smoothed(
        self, t: Array, gyro: Array, accel: Array, mag: Array, out: Columns, R_NS: Array | None = None
    ) -> None:
        """Fill `out` with answers that each know all samples, t (n,) s and the others (n, 3).

        R_NS : (3, 3), the first attitude where it is known.
        """
        ...


@runtime_checkable
class LaneFilter(Protocol):
    """An AttitudeFilter that can also take several recordings abreast, in the lanes of vector instructions."""

    @property
    def lanes(self) -> int:
        """How many: LANES of `kreisel.maths.kernels`, as all that goes abreast; 1 where this tuning cannot."""
        ...

    def batch_of_lanes(
        self, states: Array, parameters: Array, dt: Array, readings: Array, answers: Array
    ) -> None:
        """The steps of `batch` for LANES states (LANES, STATE), with the same bits; may be called block by block.

        dt : (n,) s, since the sample before; 0 for the first of all. readings : (n, 9, LANES), gyro, accel and mag.
        answers : (n, 9, LANES), takes R_NS row by row, or (n, 13, LANES), takes bias and flags as well.
        """
        ...

    def batch_of_rows(
        self,
        states: Array,
        parameters: Array,
        dt: Array,
        gyro: Array,
        accel: Array,
        mag: Array,
        out: Columns,
    ) -> None:
        """The same of recordings (lanes, n, 3) that lie one after the other, into columns whose flags are all False."""
        ...
