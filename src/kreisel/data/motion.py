"""The motion of a rigid body, complete up to accelerations, and the place of a sensor on it."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array, finite, increasing, read_only, rotations, same_length, shaped
from kreisel.maths.kinematics import Uncertainty, acceleration_at, acceleration_sigma_at, velocity_at
from kreisel.maths.rotations import euler_from_matrix, quat_wxyz_from_matrix

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation


@dataclass(frozen=True, slots=True)
class Note:
    """Something a user should know about how a motion came to be: the method chosen, a jump and its time."""

    kind: str  # "method", "heading-jump", "rate-step", "rest", "gap", "outlier", "jump", "rough"
    text: str  # one sentence
    t: float | None = None  # s, where it happened


@dataclass(frozen=True, slots=True, eq=False)
class Mount:
    """Where a sensor sits on the body and how it is turned."""

    p_BS: Array = field(default_factory=lambda: np.zeros(3))  # (3,) m, lever arm in B
    R_BS: Array = field(default_factory=lambda: np.eye(3))  # (3, 3) sensor axes in B
    name: str = "imu"

    def __post_init__(self) -> None:
        object.__setattr__(self, "p_BS", finite("p_BS", shaped("p_BS", self.p_BS, (3,))))
        object.__setattr__(self, "R_BS", rotations("R_BS", shaped("R_BS", self.R_BS, (3, 3))))


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Motion of a body B in N at time stamps; every field is exact to the method that made it.

    Where noisy samples were smoothed, the standard errors of what an IMU feels come along; NaN where they are not
    known. Their axes are taken for independent, and so are the four.
    """

    t: Array  # (n,) s after t0_ns, strictly increasing
    p_NB: Array  # (n, 3) m
    v_NB: Array  # (n, 3) m/s
    a_NB: Array  # (n, 3) m/s^2
    R_NB: Array  # (n, 3, 3)
    omega_NB_B: Array  # (n, 3) rad/s
    alpha_NB_B: Array  # (n, 3) rad/s^2
    t0_ns: int = 0  # epoch of t = 0, ns
    name: str = ""
    notes: tuple[Note, ...] = ()
    theta_sigma: Array | None = None  # (n, 3) rad, of rotations about the axes of B
    a_sigma: Array | None = None  # (n, 3) m/s^2, along the axes of N
    omega_sigma: Array | None = None  # (n, 3) rad/s
    alpha_sigma: Array | None = None  # (n, 3) rad/s^2

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", increasing("t", shaped("t", self.t, ("n",))))
        for name in ("p_NB", "v_NB", "a_NB", "omega_NB_B", "alpha_NB_B"):
            column = finite(name, shaped(name, getattr(self, name), ("n", 3)))
            same_length(self.t, **{name: column})
            put(self, name, column)
        put(self, "R_NB", rotations("R_NB", shaped("R_NB", self.R_NB, ("n", 3, 3))))
        same_length(self.t, R_NB=self.R_NB)
        for name in ("theta_sigma", "a_sigma", "omega_sigma", "alpha_sigma"):
            if getattr(self, name) is not None:
                column = shaped(name, getattr(self, name), ("n", 3))
                same_length(self.t, **{name: column})
                put(self, name, column)
        put(self, "t0_ns", int(self.t0_ns))

    def __len__(self) -> int:
        return len(self.t)

    @property
    def uncertainty(self) -> Uncertainty | None:
        """The four standard errors together, where all are known."""
        found = (self.theta_sigma, self.a_sigma, self.omega_sigma, self.alpha_sigma)
        return None if any(sigma is None for sigma in found) else Uncertainty(*found)  # type: ignore[arg-type]

    @property
    def quat_wxyz(self) -> Array:
        """(n, 4) unit quaternions of R_NB, sign-continuous from row to row, the first with w >= 0."""
        return quat_wxyz_from_matrix(self.R_NB)

    @property
    def euler(self) -> Array:
        """(n, 3) rad, (phi_x, phi_y, phi_z) with R_NB = Rz(phi_z) Ry(phi_y) Rx(phi_x)."""
        return euler_from_matrix(self.R_NB)

    @property
    def rotation(self) -> Rotation:
        """R_NB as a SciPy Rotation."""
        from scipy.spatial.transform import Rotation

        return Rotation.from_matrix(self.R_NB)

    def rows(self, rows: slice | npt.NDArray[np.int64]) -> Motion:
        """The samples that `rows` picks, which must keep them in order; notes are kept as they are."""
        part = object.__new__(Motion)
        for column in fields(Motion):
            value = getattr(self, column.name)
            # Rows of what was checked need no second look, which would cost more than most uses of them.
            picked = read_only(value[rows]) if isinstance(value, np.ndarray) else value
            object.__setattr__(part, column.name, picked)
        return part

    def at(self, mount: Mount) -> Motion:
        """Motion of the sensor at `mount`, in sensor axes (frame S in place of B).

        Standard errors that a lever arm or a turn makes depend on each other keep no memory of it.
        """
        R_SB = mount.R_BS.T
        v_lever, a_lever = (
            velocity_at(mount.p_BS, self.R_NB, self.omega_NB_B),
            acceleration_at(mount.p_BS, self.R_NB, self.omega_NB_B, self.alpha_NB_B),
        )
        return Motion(
            t=self.t,
            p_NB=read_only(self.p_NB + self.R_NB @ mount.p_BS),
            v_NB=read_only(self.v_NB + v_lever),
            a_NB=read_only(self.a_NB + a_lever),
            R_NB=read_only(self.R_NB @ mount.R_BS),
            omega_NB_B=read_only(self.omega_NB_B @ R_SB.T),
            alpha_NB_B=read_only(self.alpha_NB_B @ R_SB.T),
            t0_ns=self.t0_ns,
            name=self.name,
            notes=self.notes,
            **self._sigmas_at(mount),
        )

    def _sigmas_at(self, mount: Mount) -> dict[str, Array | None]:
        known = self.uncertainty
        if known is None:
            return {}
        a_sigma = acceleration_sigma_at(mount.p_BS, self.R_NB, self.omega_NB_B, known)
        turned = (
            np.sqrt(np.square(s) @ np.square(mount.R_BS)) for s in (known.theta, known.omega, known.alpha)
        )
        theta, omega, alpha = map(read_only, turned)
        return {
            "theta_sigma": theta,
            "a_sigma": read_only(a_sigma),
            "omega_sigma": omega,
            "alpha_sigma": alpha,
        }
