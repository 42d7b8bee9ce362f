"""Attitude over time: as a filter estimates it, and as a reference system measured it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array, finite, increasing, read_only, rotations, same_length, shaped
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.motion import Mount
from kreisel.data.tables import Tabular
from kreisel.maths.kinematics import linear_acceleration
from kreisel.maths.rotations import euler_from_matrix, quat_wxyz_from_matrix

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Mask = npt.NDArray[np.bool_]


class _MadeLater:
    """Keeps what the acceleration of a history is made of."""

    __slots__ = ("_accel",)


@dataclass(frozen=True, slots=True, eq=False)
class AttitudeHistory(_MadeLater, Tabular):
    """Attitude of a sensor (or body) in N over time; everything after R_NS is optional.

    A user's own answer is `AttitudeHistory(t=t, R_NS=R)`.
    """

    t: Array  # (n,) s after t0_ns, strictly increasing
    R_NS: Array  # (n, 3, 3)
    gyro_bias: Array | None = None  # (n, 3) rad/s, in S
    a_N: Array | None = None  # (n, 3) m/s^2, acceleration in N without gravity
    sigma: Array | None = None  # (n, 3) rad, standard deviation of the attitude error about N axes
    rest: Mask | None = None  # (n,) the sensor was taken to be at rest
    disturbed: Mask | None = None  # (n,) the magnetometer was not trusted
    held: Mask | None = None  # (n,) a gyro sample was missing and the last rate was held
    t0_ns: int = 0  # epoch of t = 0, ns
    name: str = ""

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", increasing("t", shaped("t", self.t, ("n",))))
        put(self, "R_NS", rotations("R_NS", shaped("R_NS", self.R_NS, ("n", 3, 3))))
        for name in ("gyro_bias", "a_N", "sigma"):
            if getattr(self, name) is not None:
                put(self, name, shaped(name, getattr(self, name), ("n", 3)))
        for name in ("rest", "disturbed", "held"):
            if getattr(self, name) is not None:
                put(self, name, mask(name, getattr(self, name)))
        columns = ("R_NS", "gyro_bias", "a_N", "sigma", "rest", "disturbed", "held")
        same_length(self.t, **{name: getattr(self, name) for name in columns})
        put(self, "t0_ns", int(self.t0_ns))

    @classmethod
    def trusted(
        cls,
        t: Array,
        R_NS: Array,
        gyro_bias: Array,
        accel: Array,
        flags: tuple[Mask, Mask, Mask],
        t0_ns: int,
        name: str,
        sigma: Array | None = None,
    ) -> AttitudeHistory:
        """What a filter made of a recording, taken as it is: the checks would cost as much as a third of its steps.

        The arrays are what they must be by construction: read-only, of one length, rotations to 1e-12, the stamps of
        a recording. accel (n, 3) m/s^2 is the recording's, from which a_N is made when it is first asked for.
        """
        history, put = object.__new__(cls), object.__setattr__
        put(history, "t", t)
        put(history, "R_NS", R_NS)
        put(history, "gyro_bias", gyro_bias)
        put(history, "sigma", sigma)
        for mask, values in zip(("rest", "disturbed", "held"), flags, strict=True):
            put(history, mask, values)
        put(history, "t0_ns", t0_ns)
        put(history, "name", name)
        put(history, "_accel", accel)
        return history

    # Python asks here for what is nowhere else: the place of a_N, which `trusted` leaves empty.
    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Array:
            if name != "a_N":
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            a_N = read_only(linear_acceleration(self.R_NS, self._accel, STANDARD_GRAVITY))
            object.__setattr__(self, "a_N", a_N)
            return a_N

    def __len__(self) -> int:
        return len(self.t)

    @property
    def quat_wxyz(self) -> Array:
        """(n, 4) unit quaternions of R_NS, sign-continuous from row to row, the first with w >= 0."""
        return quat_wxyz_from_matrix(self.R_NS)

    @property
    def euler(self) -> Array:
        """(n, 3) rad, (phi_x, phi_y, phi_z) with R_NS = Rz(phi_z) Ry(phi_y) Rx(phi_x)."""
        return euler_from_matrix(self.R_NS)

    @property
    def rotation(self) -> Rotation:
        """R_NS as a SciPy Rotation."""
        from scipy.spatial.transform import Rotation

        return Rotation.from_matrix(self.R_NS)

    def body(self, mount: Mount) -> AttitudeHistory:
        """Attitude of the body that carries the sensor at `mount`: R_NB = R_NS R_SB."""
        return AttitudeHistory(self.t, self.R_NS @ mount.R_BS.T, t0_ns=self.t0_ns, name=self.name)


@dataclass(frozen=True, slots=True, eq=False)
class Reference(Tabular):
    """Attitude from a reference system, and which of its samples count."""

    t: Array  # (n,) s after t0_ns, strictly increasing
    R_NS: Array  # (n, 3, 3); anything, NaN too, in rows that do not count
    counts: Mask  # (n,)
    t0_ns: int = 0  # epoch of t = 0, ns
    name: str = ""

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", increasing("t", shaped("t", self.t, ("n",))))
        put(self, "R_NS", shaped("R_NS", self.R_NS, ("n", 3, 3)))
        put(self, "counts", mask("counts", self.counts))
        same_length(self.t, R_NS=self.R_NS, counts=self.counts)
        rotations("R_NS", finite("R_NS", self.R_NS[self.counts]))
        put(self, "t0_ns", int(self.t0_ns))

    def __len__(self) -> int:
        return len(self.t)


def mask(name: str, value: Any) -> Mask:
    """`value` as a read-only (n,) array of booleans; a TypeError where it holds anything but yes and no."""
    array = np.array(value)
    if array.ndim != 1 or (array.dtype != np.bool_ and not np.isin(array, (0, 1)).all()):
        raise TypeError(f"{name} must be (n,) booleans; got {array.dtype} of shape {array.shape}.")
    array = array.astype(np.bool_)
    array.flags.writeable = False
    return array
