"""Turns a recording and where it began into the motion of the sensor, by integration alone."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import SAME_INSTANT, Array, finite, rotations, shaped
from kreisel.data.environment import Environment
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion, Note
from kreisel.data.recording import SOURCE, ImuRecording
from kreisel.maths import magnus
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.kinematics import quaternion_motion
from kreisel.maths.rotations import matrix_from_quat_wxyz, quat_wxyz_from_matrix
from kreisel.maths.stencils import between, derivatives
from kreisel.maths.turning import State, acceleration_in_N, falls, rates_in_N, standing_still, turning_along

Initial = Motion | tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike]

# A step this many times the usual one is worth a word: what happened within it can only be guessed.
_LONG_STEP = 3.5

# Five Gauss points integrate the polynomial of degree 9 through ten samples of the velocity exactly.
_SHARES, _WEIGHTS = (0.5 * x for x in np.polynomial.legendre.leggauss(5))


def integrate(
    recording: ImuRecording | ImuIncrements, initial: Initial, environment: Environment | None = None
) -> Motion:
    """Motion of the sensor S in N (as frame B of the result) at the stamps of `recording`.

    initial : p_NS (3,) m, v_NS (3,) m/s and R_NS (3, 3) at the first stamp, or a Motion of the sensor
        (`motion.at(mount)`) with a row at that time.
    environment : gravity, and the rate at which N turns; the standard one, and none, by default.

    Steps may be uneven; a step much longer than the others is bridged and noted. From rates the method is of
    sixth order: coning and sculling are in it (kreisel.maths.magnus). Where N turns, all is added up in axes that
    stand still and then seen from N (kreisel.maths.turning). From increments attitude and
    velocity are exact, and so is position where the unit delivers dp; without, velocity is interpolated.
    Rates and accelerations of the result are the recording's own; alpha_NB_B, and for increments also
    omega_NB_B and a_NB, are slopes of local polynomials, and as noisy as slopes are.

    Raises TypeError for other types, ValueError for an empty recording, a NaN row (named) and a Motion without
    a row at the first stamp.
    """
    world = environment or Environment()
    if isinstance(recording, ImuIncrements):
        return _from_increments(recording, initial, world)
    if isinstance(recording, ImuRecording):
        return _from_rates(recording, initial, world)
    raise TypeError(
        f"recording must be ImuRecording or ImuIncrements; got {type(recording).__name__}. {SOURCE}"
    )


def _from_rates(recording: ImuRecording, initial: Initial, world: Environment) -> Motion:
    t, gyro, accel = recording.t, recording.gyro, recording.accel
    if not len(recording):
        raise ValueError("the recording has no samples; there is nothing to integrate.")
    cure = "Leave such rows out: steps may be uneven."
    _whole("gyro", gyro, cure)
    _whole("accel", accel, cure)
    start, fall = _start(recording, initial, world), falls(t, world.g_N, world.omega_IN_N)
    values = between(t, np.hstack([gyro, accel]), magnus.GAUSS)
    dtheta, dv, dp = magnus.increments(np.diff(t), values)
    q, v_I = _turns_and_velocities(dtheta, dv, fall[0], start)
    R_IS = matrix_from_quat_wxyz(q)
    p_I = _positions(t, R_IS, v_I, dp, fall[1], start)
    p, v, R = turning_along(t, State(p_I, v_I, R_IS), world.omega_IN_N)
    a = acceleration_in_N(np.einsum("nij,nj->ni", R, accel) + world.g_N, v, p, world.omega_IN_N)
    omega, alpha = rates_in_N(gyro, derivatives(t, gyro, 1)[1], R, world.omega_IN_N)
    return Motion(t, p, v, a, R, omega, alpha, recording.t0_ns, recording.name, _long_steps(t))


def _from_increments(recording: ImuIncrements, initial: Initial, world: Environment) -> Motion:
    t, dp = recording.t, recording.dp
    cure = "What happened in a missing interval is lost: integrate what lies before and after it apart."
    for name in ("dtheta", "dv", "dp"):
        if getattr(recording, name) is not None:
            _whole(name, getattr(recording, name), cure)
    start, fall = _start(recording, initial, world), falls(t, world.g_N, world.omega_IN_N)
    q, v_I = _turns_and_velocities(recording.dtheta, recording.dv, fall[0], start)
    R_IS, omega_I, alpha_I = quaternion_motion(*derivatives(t, q, 2))
    p_I = _positions(t, R_IS, v_I, dp, fall[1], start) if dp is not None else _integral(t, v_I, start.p_XS[0])
    p, v, R = turning_along(t, State(p_I, v_I, R_IS), world.omega_IN_N)
    omega, alpha = rates_in_N(omega_I, alpha_I, R, world.omega_IN_N)
    a = derivatives(t, v, 1)[1]
    return Motion(t, p, v, a, R, omega, alpha, recording.t0_ns, recording.name, _long_steps(t))


def _start(recording: ImuRecording | ImuIncrements, initial: Initial, world: Environment) -> State:
    """The state at the first stamp, one row, in the axes that stand still where N is then."""
    p_NS, v_NS, R_NS = _given(recording, initial)
    return standing_still(recording.t[:1], State(p_NS[None], v_NS[None], R_NS[None]), world.omega_IN_N)


def _given(recording: ImuRecording | ImuIncrements, initial: Initial) -> tuple[Array, Array, Array]:
    """p_NS (3,), v_NS (3,) and R_NS (3, 3) at the first stamp."""
    if isinstance(initial, Motion):
        k = _row_at(initial, recording)
        return initial.p_NB[k], initial.v_NB[k], initial.R_NB[k]
    try:
        p_NS, v_NS, R_NS = initial
    except (TypeError, ValueError):
        raise TypeError(
            f"initial must be a Motion or (p_NS, v_NS, R_NS); got {type(initial).__name__}."
        ) from None
    return (
        finite("p_NS", shaped("p_NS", p_NS, (3,))),
        finite("v_NS", shaped("v_NS", v_NS, (3,))),
        rotations("R_NS", shaped("R_NS", R_NS, (3, 3))),
    )


def _row_at(initial: Motion, recording: ImuRecording | ImuIncrements) -> int:
    # Epochs are subtracted as integers: as floats they would be rounded to 128 ns.
    first = recording.t[0] + (recording.t0_ns - initial.t0_ns) / 1e9
    near = int(np.argmin(np.abs(initial.t - first))) if len(initial) else None
    if near is None or abs(initial.t[near] - first) > SAME_INSTANT:
        span = f"{initial.t[0]:.9g} to {initial.t[-1]:.9g} s" if len(initial) else "nothing"
        raise ValueError(
            f"initial must have a row at the recording's first stamp, {first:.9g} s after its t0_ns; "
            f"it spans {span}, none within {SAME_INSTANT:g} s. Sample it there, or give (p_NS, v_NS, R_NS)."
        )
    return near


def _whole(name: str, x: Array, cure: str) -> None:
    good = np.isfinite(x).all(axis=1)
    if not good.all():
        k = int(np.argmin(good))
        raise ValueError(f"{name} must be finite to be integrated; row {k} is {x[k]}. {cure}")


def _long_steps(t: Array) -> tuple[Note, ...]:
    steps = np.diff(t)
    long = np.flatnonzero(steps > _LONG_STEP * np.median(steps)) if len(steps) else steps
    return tuple(
        Note("gap", f"no sample for {steps[k]:.4g} s: what happened is interpolated", float(t[k]))
        for k in long
    )


def _turns_and_velocities(dtheta: Array, dv: Array, fall: Array, start: State) -> tuple[Array, Array]:
    """q_IS_wxyz (n, 4), sign-continuous, and v_I (n, 3); `fall` (n - 1, 3) m/s is what gravity adds."""
    q, v = np.empty((len(dtheta) + 1, 4)), np.empty((len(dtheta) + 1, 3))
    v[0] = start.v_XS[0]
    q[0] = quat_wxyz_from_matrix(start.R_XS[0])
    _accumulate(argument(dtheta), argument(dv), argument(fall), q, v)
    return q, v


@kernel
def _accumulate(dtheta: Array, dv: Array, fall: Array, q: Array, v: Array) -> None:
    for k in range(dtheta.shape[0]):
        w, x, y, z = q[k]
        a, b, c = dv[k]
        # R v = v + 2 w (u x v) + 2 u x (u x v) with u the vector part.
        i, j, l = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
        v[k + 1, 0] = v[k, 0] + (fall[k, 0] + (a + w * i + y * l - z * j))
        v[k + 1, 1] = v[k, 1] + (fall[k, 1] + (b + w * j + z * i - x * l))
        v[k + 1, 2] = v[k, 2] + (fall[k, 2] + (c + w * l + x * j - y * i))
        a, b, c = dtheta[k]
        angle = np.sqrt(a * a + b * b + c * c)
        half = 0.5 if angle == 0.0 else np.sin(0.5 * angle) / angle
        a, b, c, r = half * a, half * b, half * c, np.cos(0.5 * angle)
        w, x, y, z = (
            w * r - x * a - y * b - z * c,
            w * a + x * r + y * c - z * b,
            w * b - x * c + y * r + z * a,
            w * c + x * b - y * a + z * r,
        )
        scale = 1.0 / np.sqrt(w * w + x * x + y * y + z * z)
        q[k + 1, 0], q[k + 1, 1], q[k + 1, 2], q[k + 1, 3] = scale * w, scale * x, scale * y, scale * z


def _positions(t: Array, R: Array, v: Array, dp: Array, fall: Array, start: State) -> Array:
    gains = np.diff(t)[:, None] * v[:-1] + fall + np.einsum("nij,nj->ni", R[:-1], dp)
    return _summed(start.p_XS[0], gains)


def _integral(t: Array, v: Array, p_NS: Array) -> Array:
    gains = np.einsum("g,ngc->nc", _WEIGHTS, between(t, v, 0.5 + _SHARES)) * np.diff(t)[:, None]
    return _summed(p_NS, gains)


def _summed(first: Array, gains: Array) -> Array:
    return np.asarray(np.cumsum(np.vstack([first, gains]), axis=0))
