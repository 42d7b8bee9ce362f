"""The five functions of the MATLAB tool of document 000, to the letter: trajectories in, IMU data out.

Names, argument orders and return orders are the tool's; time may be a row or a column, 3-vectors are (n, 3),
and where MATLAB takes a cell of three functions, a tuple or list of three Python functions does.

    s, v, a = my_lin((sx, sy, sz), "sym", t)
    phi_tz, phi_ty, phi_tx, ta = my_tang(v, t)
    phi = np.column_stack([phi_tx, phi_ty, phi_tz])
    phi, omega, alpha = my_ang(phi, "num", t)
    aB = my_rotate(phi, a, t)
    aIMU = my_imu(aB, omega, alpha, r, t)

What they give differs from the core of kreisel (`Motion`, `Imu.ideal`) in five ways, each pinned by a test:

* `my_rotate` multiplies by R where physics has R^T: eq. (3) contradicts (2) with (10)-(13), by which R takes
  vectors from B to N.
* `my_ang` gives omega and alpha in N, eq. (7), where a gyro measures in B.
* Gravity is left to the caller, who adds (0, 0, +9.80665) to `a` before `my_rotate` to have specific force.
* "num" differentiates as MATLAB's ``gradient(x, t)``: its error falls with the square of the step, at the two
  ends of the data with the step. On figure 1's loop at 200 Hz the accelerometer is 1.5 m/s^2 off inside and
  148 at the ends (1.4 and 61 where the angles are exact).
* `my_tang` refuses zero speed, which has no tangent and is NaN in MATLAB; ``orientation="tangent"`` of the
  core holds the heading there.

``convention="physical"`` of `my_rotate` and `my_ang` cures the first two; with functions and gravity
the chain then equals `Imu.ideal` to round-off. Prefer the core for new work.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from kreisel.data.checks import (
    Array,
    choice,
    finite,
    increasing,
    row_or_column,
    same_length,
    shaped,
    three_functions,
)
from kreisel.maths.gradient import gradient, gradient_rotation
from kreisel.maths.jets import differentiate
from kreisel.maths.kinematics import euler_motion
from kreisel.maths.rotations import matrix_from_euler

Function: TypeAlias = Callable[[Any], Any]
Option: TypeAlias = Literal["num", "sym"]
Convention: TypeAlias = Literal["document", "physical"]


def my_lin(s: Any, option: Option, t_: Any) -> tuple[Array, Array, Array]:
    """`s_calc`, `v_calc`, `a_calc` (n, 3): position, velocity, acceleration in N, eq. (5) and (6).

    s: samples (n, 3) m with option "num", three functions of time in s with "sym".
    t_: (n,), (n, 1) or (1, n) s, strictly increasing; n >= 2 with "num".
    """
    t = _time("t_", t_, option)
    if option == "sym":
        position, velocity, acceleration = differentiate(_joined("s", s), t, 2)
        return position, velocity, acceleration
    samples = _samples("s", s, t)
    v = gradient(samples, t)
    return samples.copy(), v, gradient(v, t)


def my_tang(v: Any, t: Any) -> tuple[Array, Array, Array, Array]:
    """`phi_tz`, `phi_ty`, `phi_tx` (n,) rad and the unit tangent `ta` (n, 3) of `v` (n, 3), eq. (10)-(13).

    v: velocity in N. Angles are those of atan2 and asin: phi_z jumps by 2 pi where the heading passes west.
    Raises ValueError where the speed is zero.
    """
    velocity = _samples("v", v, _time("t", t))
    speed = np.linalg.norm(velocity, axis=1)
    if not speed.all():
        k = int(np.argmin(speed))
        raise ValueError(
            f"v must not be zero: row {k} is, and (10) has no tangent there (MATLAB gives NaN). "
            'Leave such rows out, or use orientation="tangent" of kreisel, which holds the heading at rest.'
        )
    ta = velocity / speed[:, None]
    phi_tz = np.arctan2(ta[:, 1], ta[:, 0])
    phi_ty = -np.arcsin(ta[:, 2] / np.linalg.norm(ta, axis=1))
    return phi_tz, phi_ty, np.zeros_like(phi_tz), ta


def my_ang(
    phi: Any, option: Option, t_: Any, *, convention: Convention = "document"
) -> tuple[Array, Array, Array]:
    """`phi_calc` (n, 3) rad, `omega_calc` (n, 3) rad/s, `alpha_calc` (n, 3) rad/s^2, eq. (7) and (8).

    phi: (phi_x, phi_y, phi_z), samples (n, 3) rad with option "num", three functions of time with "sym".
    t_: as in `my_lin`.
    convention: "document" takes Omega = dR/dt R^-1, omega in N; "physical" Omega = R^-1 dR/dt, omega in B as
        a gyro measures it. omega = (Omega[2, 1], Omega[0, 2], Omega[1, 0]) either way.
    """
    choice("convention", convention, ("document", "physical"))
    t = _time("t_", t_, option)
    if option == "num":
        samples = _samples("phi", phi, t)
        axes: Literal["B", "N"] = "N" if convention == "document" else "B"
        return samples.copy(), *gradient_rotation(t, matrix_from_euler(samples), axes)
    angles, rates, accelerations = differentiate(_joined("phi", phi), t, 2)
    R_NB, omega, alpha = euler_motion(angles, rates, accelerations)
    if convention == "document":
        # d(R omega)/dt = R (alpha + omega x omega): the derivative turns like the rate itself.
        omega, alpha = _turned(R_NB, omega), _turned(R_NB, alpha)
    return angles, omega, alpha


def my_rotate(phi: Any, aN: Any, t: Any, *, convention: Convention = "document") -> Array:
    """`aB` (n, 3): vectors `aN` (n, 3) turned by the Euler angles `phi` (n, 3) rad.

    convention: "document" is eq. (3), aB = R(phi) aN; "physical" aB = R(phi)^T aN, which takes vectors from N
        to the axes of a body whose nose R e_x lies along the tangent of `my_tang`.
    """
    choice("convention", convention, ("document", "physical"))
    times = _time("t", t)
    R = matrix_from_euler(_samples("phi", phi, times))
    return _turned(R if convention == "document" else R.swapaxes(1, 2), _samples("aN", aN, times))


def my_imu(aB: Any, omega: Any, alpha: Any, r: Any, t: Any) -> Array:
    """`aIMU` (n, 3) m/s^2: acceleration at lever arm `r` from the centre of mass, eq. (9), in B.

    aB, omega, alpha: (n, 3) m/s^2, rad/s, rad/s^2 in B; r: (3,) m in B. The document's `my_ang` gives omega
    and alpha in N instead: then the result is right only while the axes of N and B agree.
    """
    times = _time("t", t)
    lever = finite("r", row_or_column("r", r, 3))
    a, w, dw = _samples("aB", aB, times), _samples("omega", omega, times), _samples("alpha", alpha, times)
    return a + np.cross(w, np.cross(w, lever)) + np.cross(dw, lever)


def _time(name: str, t: Any, option: str = "sym") -> Array:
    """(n,) s; differences need two stamps or more."""
    choice("option", option, ("num", "sym"))
    times = increasing(name, row_or_column(name, t))
    if option == "num" and len(times) < 2:
        raise ValueError(f"{name} must hold two stamps or more to take differences; got {len(times)}.")
    return times


def _samples(name: str, value: Any, t: Array) -> Array:
    if isinstance(value, Sequence) and any(callable(part) for part in value):
        raise TypeError(f'{name} holds functions; option "num" takes samples (n, 3). Use option "sym".')
    array = finite(name, shaped(name, value, ("n", 3)))
    same_length(t, **{name: array})
    return array


def _joined(name: str, functions: Any) -> Function:
    x, y, z = three_functions(name, functions)
    return lambda t: (x(t), y(t), z(t))


def _turned(R: Array, v: Array) -> Array:
    return np.einsum("nij,nj->ni", R, v)
