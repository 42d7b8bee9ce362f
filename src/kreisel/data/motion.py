"""The motion of a rigid body, complete up to accelerations, and the place of a sensor on it."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from kreisel.data.cards import Shown
from kreisel.data.checks import Array, finite, increasing, read_only, rotations, same_length, shaped
from kreisel.data.tables import Tabular
from kreisel.maths.kinematics import Uncertainty, acceleration_sigma_at, motion_at
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
class Mount(Shown):
    """Where a sensor sits on the body and how it is turned."""

    p_BS: Array = field(default_factory=lambda: np.zeros(3))  # (3,) m, lever arm in B
    R_BS: Array = field(default_factory=lambda: np.eye(3))  # (3, 3) sensor axes in B
    name: str = "imu"

    def __post_init__(self) -> None:
        object.__setattr__(self, "p_BS", finite("p_BS", shaped("p_BS", self.p_BS, (3,))))
        object.__setattr__(self, "R_BS", rotations("R_BS", shaped("R_BS", self.R_BS, (3, 3))))


@dataclass(frozen=True, slots=True, eq=False)
class Motion(Tabular):
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

    def at(self, mount: Mount) -> Motion:
        """Motion of the sensor at `mount`, in sensor axes (frame S in place of B).

        Standard errors that a lever arm or a turn makes depend on each other keep no memory of it.
        """
        names = ("p_NB", "v_NB", "a_NB", "R_NB", "omega_NB_B", "alpha_NB_B")
        moved = motion_at(mount.p_BS, mount.R_BS, *(getattr(self, name) for name in names))
        return self._with(dict(zip(names, moved, strict=True)) | self._sigmas_at(mount))

    def _sigmas_at(self, mount: Mount) -> dict[str, Array]:
        known = self.uncertainty
        if known is None:
            return {}
        a_sigma = acceleration_sigma_at(mount.p_BS, self.R_NB, self.omega_NB_B, known)
        turned = (
            np.sqrt(np.square(s) @ np.square(mount.R_BS)) for s in (known.theta, known.omega, known.alpha)
        )
        theta, omega, alpha = turned
        return {"theta_sigma": theta, "a_sigma": a_sigma, "omega_sigma": omega, "alpha_sigma": alpha}

    def rows(self, rows: slice | npt.NDArray[np.int64]) -> Motion:
        """The samples that `rows` picks, which must keep them in order; notes are kept as they are."""
        columns = {c.name: getattr(self, c.name) for c in fields(Motion)}
        return self._with({name: x[rows] for name, x in columns.items() if isinstance(x, np.ndarray)})

    def _with(self, columns: dict[str, Array]) -> Motion:
        """This motion with other columns: what was made of checked ones needs no second look, dearer than most uses."""
        other = object.__new__(Motion)
        for column in fields(Motion):
            value = columns.get(column.name)
            given = getattr(self, column.name) if value is None else read_only(value)
            object.__setattr__(other, column.name, given)
        return other
