"""Turns sampled poses, clean or noisy, into a trajectory that can be sampled at any time between them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from kreisel.data.checks import (
    Array,
    choice,
    finite,
    increasing,
    radians,
    read_only,
    rotations,
    same_length,
    shaped,
    unit_quaternions,
)
from kreisel.data.motion import Motion, Note
from kreisel.data.trajectory import Poses
from kreisel.maths.derivatives import (
    SECOND_DERIVATIVE_GAIN,
    Interpolation,
    Signal,
    interpolating_spline,
    noise_level,
)
from kreisel.maths.following.carried import Carried
from kreisel.maths.following.course import Course
from kreisel.maths.following.tangent import Attitude
from kreisel.maths.kinematics import quaternion_motion
from kreisel.maths.rotations import (
    continuous_signs,
    matrix_from_euler,
    matrix_from_quat_wxyz,
    quat_wxyz_from_matrix,
)
from kreisel.simulate.notes import AIMLESS, joint_notes

METHODS = ("auto", "spline", "smooth", "gradient")

# Interpolating is as good as the samples when their noise stays under a tenth of a milli-g in the
# acceleration (and 1e-3 rad/s^2 in the angular one): an accelerometer's own noise hides it.
CLEAN_BELOW = 1e-3

# Below, a spline has no third derivative to turn a tangent by; a smoother has nothing to average.
_FEWEST = {"spline": 6, "smooth": 20, "gradient": 3}


@dataclass(frozen=True, eq=False)
class SampledTrajectory:
    """A trajectory through, or where they are noisy behind, sampled poses.

    t: (n,) s, strictly increasing; steps may be uneven.
    position: (n, 3) m in N.
    orientation: Euler angles (n, 3) rad (phi_x, phi_y, phi_z), quaternions (n, 4) with `order` "wxyz" or
        "xyzw", matrices R_NB (n, 3, 3), a SciPy Rotation, or "tangent" (nose along the path) or "transport"
        (along the path without twisting about it). Wraps of angles and signs of quaternions do not matter.
    method: "spline" interpolates; "smooth" takes noise out, as much as the samples show; "gradient" is the
        MATLAB scheme of document 000 and gives values at the sample times only; "auto" smooths what is
        noisy, with the help of `velocity` where it is given, interpolates what is clean, and says which in
        the notes of the motion.
    velocity: (n, 3) m/s in N, where the source has it.
    """

    t: Array
    position: Array
    orientation: Any = "tangent"
    method: str = "auto"
    order: str | None = None
    velocity: Array | None = None
    t0_ns: int = 0
    name: str = ""

    def __post_init__(self) -> None:
        put = object.__setattr__
        choice("method", self.method, METHODS)
        if self.order is not None:
            choice("order", self.order, ("wxyz", "xyzw"))
        put(self, "t", increasing("t", shaped("t", self.t, ("n",))))
        put(self, "position", finite("position", shaped("position", self.position, ("n", 3))))
        if self.velocity is not None:
            put(self, "velocity", finite("velocity", shaped("velocity", self.velocity, ("n", 3))))
        same_length(self.t, position=self.position, velocity=self.velocity)
        fewest = _FEWEST["spline" if self.method == "auto" else self.method]
        if len(self.t) < fewest:
            raise ValueError(
                f"method {self.method!r} needs at least {fewest} samples; got {len(self.t)}. "
                "Give more samples, or functions to FunctionTrajectory."
            )
        if isinstance(self.orientation, str):
            choice("orientation", self.orientation, ("tangent", "transport"))
        else:
            put(self, "orientation", _quaternions(self.orientation, self.order))
            same_length(self.t, orientation=self.orientation)

    @classmethod
    def from_poses(cls, poses: Poses, orientation: Any = None, method: str = "auto") -> SampledTrajectory:
        """From a file's poses; `orientation` takes the place of theirs, "tangent" that of missing ones."""
        if orientation is None:
            orientation = "tangent" if poses.R_NB is None else poses.R_NB
        return cls(
            poses.t, poses.p_NB, orientation, method, velocity=poses.v_NB, t0_ns=poses.t0_ns, name=poses.name
        )

    @property
    def span(self) -> tuple[float, float]:
        """Time of the first and of the last sample, s."""
        return float(self.t[0]), float(self.t[-1])

    def sample(self, t: Array | None = None) -> Motion:
        """Motion at times `t` (n,) s inside the span; at the samples' own times where `t` is left out."""
        times = self.t if t is None else increasing("t", shaped("t", t, ("n",)))
        self._inside(times)
        if self.method == "gradient":
            return self._gradient_motion(times)
        position, position_note = self._position
        if isinstance(self.orientation, str):
            (R, omega, alpha), notes = self._along(position, times)
        else:
            attitude, attitude_note = self._attitude
            R, omega, alpha = quaternion_motion(*attitude(times, 2))
            notes = (attitude_note,)
        p, v, a = position(times, 2)
        p, v, a, R, omega, alpha = map(read_only, (p, v, a, R, omega, alpha))
        return Motion(times, p, v, a, R, omega, alpha, self.t0_ns, self.name, (position_note, *notes))

    def _along(self, position: Signal, times: Array) -> tuple[Attitude, tuple[Note, ...]]:
        """Attitude of a body that follows the path, and notes on where its heading jumps."""
        kind = Carried if self.orientation == "transport" else Course
        course = kind(position, self.t, position.floor)
        lost = (AIMLESS,) if course.aimless else ()
        return course.attitude(times), (*_corner_notes(position), *joint_notes(course.joints()), *lost)

    def _inside(self, times: Array) -> None:
        first, last = self.span
        outside = (times < first) | (times > last)
        if outside.any():
            k = int(np.argmax(outside))
            raise ValueError(
                f"t must lie between the first and the last sample, {first:.9g} to {last:.9g} s; "
                f"row {k} is {times[k]:.9g}. Samples are not extrapolated."
            )

    @cached_property
    def _position(self) -> tuple[Signal, Note]:
        return self._signal("positions", "m", self.position, rate=self.velocity)

    @cached_property
    def _attitude(self) -> tuple[Signal, Note]:
        # Sign-continuous quaternions have no wraps, and their noise is the same in every component.
        return self._signal("attitude", "", self.orientation, shared=True)

    def _signal(
        self, what: str, unit: str, x: Array, rate: Array | None = None, shared: bool = False
    ) -> tuple[Signal, Note]:
        """The signal behind samples `x`, and a note on how it was found."""
        sigma = float(np.max(noise_level(self.t, x))) if self.method == "auto" else 0.0
        step = float(np.median(np.diff(self.t)))
        noisy = SECOND_DERIVATIVE_GAIN * sigma / step**2 > CLEAN_BELOW and len(self.t) >= _FEWEST["smooth"]
        if self.method == "smooth" or noisy:
            # Loaded here: its sparse algebra costs half a second that clean samples need not wait for.
            from kreisel.maths.smoothing import smoothing_spline

            smooth = smoothing_spline(self.t, x, rate=rate, shared=shared)
            # A unit quaternion carries half the rotation angle.
            level = _readable(float(np.max(smooth.sigma)), unit)
            helped = " with the velocities given" if rate is not None else ""
            return smooth, Note("method", f"{what} smoothed{helped}: noise of {level} found")
        return interpolating_spline(self.t, x), Note("method", f"{what} interpolated: no noise to speak of")

    def _gradient_motion(self, times: Array) -> Motion:
        from kreisel.maths.gradient import gradient, gradient_rotation

        if len(times) != len(self.t) or (times != self.t).any():
            raise ValueError(
                'method "gradient" gives values at the sample times only, as the MATLAB tool does; '
                'call sample() without times, or use method="spline".'
            )
        v = gradient(self.position, self.t)
        a = gradient(v, self.t)
        if isinstance(self.orientation, str):
            R = _tangents(v, self.orientation)
        else:
            R = matrix_from_quat_wxyz(self.orientation)
        omega, alpha = gradient_rotation(self.t, R)
        note = Note("method", "central differences at the samples, as MATLAB's gradient")
        return Motion(times, self.position, v, a, R, omega, alpha, self.t0_ns, self.name, (note,))


def example() -> SampledTrajectory:
    """The loop of figure 1, sampled at 200 Hz."""
    t = np.arange(0.0, 5.0025, 0.005)
    angle = 2.0 * np.pi * t
    return SampledTrajectory(
        t, np.stack([0.8 * np.cos(angle), 0.8 * np.sin(angle), 0.3 * np.cos(3.0 * angle)], axis=1)
    )


def _quaternions(orientation: Any, order: str | None) -> Array:
    """Sign-continuous q_NB_wxyz (n, 4) from any of the descriptions of attitude a user may hold."""
    if hasattr(orientation, "as_matrix"):
        orientation = orientation.as_matrix()
    shape = np.shape(orientation)
    if shape[1:] == (3, 3):
        R = rotations("orientation", shaped("orientation", orientation, ("n", 3, 3)))
        return quat_wxyz_from_matrix(R)
    if shape[1:] == (3,):
        phi = radians("orientation", finite("orientation", shaped("orientation", orientation, ("n", 3))))
        return quat_wxyz_from_matrix(matrix_from_euler(phi))
    if shape[1:] == (4,):
        if order is None:
            raise ValueError(
                f'quaternions need order="wxyz" or order="xyzw"; got {order!r}. '
                "ROS, TUM files and SciPy write xyzw; MATLAB, EuRoC and Eigen's constructor wxyz."
            )
        q = unit_quaternions("orientation", shaped("orientation", orientation, ("n", 4)))
        return continuous_signs(q if order == "wxyz" else q[:, [3, 0, 1, 2]])
    raise ValueError(
        "orientation must be Euler angles (n, 3), quaternions (n, 4), matrices (n, 3, 3), a SciPy Rotation, "
        f'"tangent" or "transport"; got shape {shape}.'
    )


def _corner_notes(position: Signal) -> tuple[Note, ...]:
    if not isinstance(position, Interpolation) or not position.corners.size:
        return ()
    first = ", ".join(f"{t:.4g}" for t in position.corners[:5])
    more = " and later" if len(position.corners) > 5 else ""
    text = (
        f"the samples have corners, or are too far apart, around t = {first}{more} s: the path is interpolated "
        "smoothly there, and rings"
    )
    return (Note("method", text, float(position.corners[0])),)


def _tangents(v: Array, orientation: str) -> Array:
    """R_NB (n, 3, 3) by eqs. (10)-(13); a row at rest keeps the last direction, or has the first to come."""
    if orientation == "transport":
        raise ValueError(
            'the MATLAB scheme knows orientation "tangent" only; use method="spline" for "transport".'
        )
    moving = np.flatnonzero(np.any(v != 0.0, axis=1))
    if moving.size == 0:
        return np.tile(np.eye(3), (len(v), 1, 1))
    last = np.searchsorted(moving, np.arange(len(v)), side="right") - 1
    v = v[moving[np.maximum(last, 0)]]
    phi_y = -np.arctan2(v[:, 2], np.hypot(v[:, 0], v[:, 1]))
    return matrix_from_euler(np.stack([np.zeros(len(v)), phi_y, np.arctan2(v[:, 1], v[:, 0])], axis=1))


def _readable(level: float, unit: str) -> str:
    if unit == "m":
        return f"{level * 1e3:.2g} mm"
    return f"{np.rad2deg(2.0 * level):.2g} deg"
