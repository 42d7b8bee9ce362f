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
    per_axis,
    read_only,
    same_length,
    scalar,
    shaped,
)
from kreisel.data.motion import Motion, Note
from kreisel.data.smoothing import Smoothing
from kreisel.data.trajectory import Poses
from kreisel.maths.derivatives import Interpolation, Signal
from kreisel.maths.following.carried import Carried
from kreisel.maths.following.course import Course
from kreisel.maths.following.tangent import Attitude
from kreisel.maths.kinematics import quaternion_motion
from kreisel.maths.rotations import (
    matrix_from_euler,
    matrix_from_quat_wxyz,
)
from kreisel.simulate.notes import AIMLESS, joint_notes
from kreisel.simulate.orientation import measured, quaternions
from kreisel.simulate.samples import FEWEST_SMOOTH, Behind, Columns, behind, gaps, known_rows

METHODS = ("auto", "spline", "smooth", "gradient")

MAX_GAP = 0.25
"""Seconds without samples that are bridged unless a user allows more."""

# Below, a spline has no third derivative to turn a tangent by; a smoother has nothing to average.
_FEWEST = {"spline": 6, "smooth": FEWEST_SMOOTH, "gradient": 3}


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
    position_noise: m, standard deviation of the noise of positions, one number or one per axis of N, where it is known;
        found from the samples where it is left out. attitude_noise: rad, the same about the axes of B.
    max_gap: s, longest time without samples that is bridged. Rows with NaN are missing samples, of position or of
        attitude alone.
    """

    t: Array
    position: Array
    orientation: Any = "tangent"
    method: str = "auto"
    order: str | None = None
    velocity: Array | None = None
    t0_ns: int = 0
    name: str = ""
    position_noise: Any = None
    attitude_noise: Any = None
    max_gap: float = MAX_GAP

    def __post_init__(self) -> None:
        put = object.__setattr__
        choice("method", self.method, METHODS)
        put(self, "max_gap", scalar("max_gap", self.max_gap, "in s", 0.0))
        if self.order is not None:
            choice("order", self.order, ("wxyz", "xyzw"))
        put(self, "t", increasing("t", shaped("t", self.t, ("n",))))
        put(self, "position", measured("position", shaped("position", self.position, ("n", 3))))
        if self.velocity is not None:
            put(self, "velocity", finite("velocity", shaped("velocity", self.velocity, ("n", 3))))
        same_length(self.t, position=self.position, velocity=self.velocity)
        if isinstance(self.orientation, str):
            choice("orientation", self.orientation, ("tangent", "transport"))
        else:
            put(self, "orientation", quaternions(self.orientation, self.order))
            same_length(self.t, orientation=self.orientation)
        self._check_noise()
        self._check_gaps()

    def _check_noise(self) -> None:
        for name, unit in (("position_noise", "in m"), ("attitude_noise", "in rad")):
            given = getattr(self, name)
            if given is None:
                continue
            if self.method in ("spline", "gradient"):
                raise ValueError(
                    f"{name} is for smoothing; method {self.method!r} takes the samples as they are."
                )
            sigma = per_axis(name, given, unit)
            if not (sigma > 0.0).all():
                raise ValueError(
                    f"{name} must be above 0, {unit}; got {given!r}. Leave it out to have it found."
                )
            object.__setattr__(self, name, sigma)
        if self.attitude_noise is not None and isinstance(self.orientation, str):
            raise ValueError(
                f"attitude_noise has no meaning with orientation {self.orientation!r}: no attitude is measured."
            )

    def _check_gaps(self) -> None:
        """Refuse too few samples, and gaps that are too long."""
        fewest = _FEWEST["spline" if self.method == "auto" else self.method]
        for what, t in self._stamps.items():
            if len(t) < fewest:
                raise ValueError(
                    f"method {self.method!r} needs at least {fewest} samples of {what}; got {len(t)}. "
                    "Give more samples, or functions to FunctionTrajectory."
                )
            if self.method != "gradient":
                gaps(what, t, self.max_gap)
            elif len(t) < len(self.t):
                k = int(np.argmin(np.isin(self.t, t)))
                raise ValueError(f'method "gradient" bridges no gaps: {what} must be finite; row {k} is not.')

    @classmethod
    def from_poses(
        cls,
        poses: Poses,
        orientation: Any = None,
        method: str = "auto",
        *,
        position_noise: Any = None,
        attitude_noise: Any = None,
        max_gap: float = MAX_GAP,
    ) -> SampledTrajectory:
        """From a file's poses; `orientation` takes the place of theirs, "tangent" that of missing ones."""
        if orientation is None:
            orientation = "tangent" if poses.R_NB is None else poses.R_NB
        return cls(
            poses.t,
            poses.p_NB,
            orientation,
            method,
            velocity=poses.v_NB,
            t0_ns=poses.t0_ns,
            name=poses.name,
            position_noise=position_noise,
            attitude_noise=attitude_noise,
            max_gap=max_gap,
        )

    @property
    def span(self) -> tuple[float, float]:
        """Time of the first and of the last sample, s, of what both position and attitude are known at."""
        first, last = zip(*((t[0], t[-1]) for t in self._stamps.values()), strict=True)
        return float(max(first)), float(min(last))

    @property
    def position_smoothing(self) -> Smoothing | None:
        """What was found in the positions; None where they are interpolated, or differenced."""
        return None if self.method == "gradient" else self._position.smoothing

    @property
    def attitude_smoothing(self) -> Smoothing | None:
        """What was found in the attitudes; None where they are interpolated, differenced, or follow the path."""
        follows = isinstance(self.orientation, str)
        return None if self.method == "gradient" or follows else self._attitude.smoothing

    def sample(self, t: Array | None = None) -> Motion:
        """Motion at times `t` (n,) s inside the span; at the samples' own times where `t` is left out.

        Where positions or attitudes are smoothed it has standard errors.
        """
        first, last = self.span
        own = self.t[(self.t >= first) & (self.t <= last)]
        times = own if t is None else increasing("t", shaped("t", t, ("n",)))
        self._inside(times)
        if self.method == "gradient":
            return self._gradient_motion(times)
        position = self._position
        p, v, a = position.signal(times, 2)
        if isinstance(self.orientation, str):
            attitude, notes = self._along(times)
        else:
            attitude = Attitude(*quaternion_motion(*self._attitude.signal(times, 2)))
            notes = self._attitude.notes
        p, v, a, R, omega, alpha = map(read_only, (p, v, a, *attitude))
        sigmas = {name: read_only(sigma) for name, sigma in self._sigmas(times, R).items()}
        notes = (*position.notes, *notes)
        return Motion(times, p, v, a, R, omega, alpha, self.t0_ns, self.name, notes, **sigmas)

    def _along(self, times: Array) -> tuple[Attitude, tuple[Note, ...]]:
        """Attitude of a body that follows the path, and notes on where its heading jumps."""
        kind = Carried if self.orientation == "transport" else Course
        position = self._position.signal
        course = kind(position, self._position.t, position.floor)
        lost = (AIMLESS,) if course.aimless else ()
        return course.attitude(times), (*_corner_notes(position), *joint_notes(course.joints()), *lost)

    def _sigmas(self, times: Array, R_NB: Array) -> dict[str, Array]:
        """Standard errors of a motion at `times`; none where nothing is smoothed."""
        position = self._position
        if isinstance(self.orientation, str):
            if position.smoothing is None:
                return {}
            variances = position.variances(times, range(4))
            turns = self._turns_along(times, R_NB, variances)
        elif position.smoothing is None and self._attitude.smoothing is None:
            return {}
        else:
            variances = position.variances(times, range(2, 3))
            turns = tuple(np.sqrt(self._attitude.variances(times, range(3))))
        a_sigma = np.sqrt(variances[0 if len(variances) == 1 else 2])
        return dict(zip(("theta_sigma", "omega_sigma", "alpha_sigma"), turns, strict=True)) | {
            "a_sigma": a_sigma
        }

    def _turns_along(self, times: Array, R_NB: Array, variances: Array) -> tuple[Array, Array, Array]:
        from kreisel.maths.following.uncertainty import carried_sigmas, course_sigmas

        derivatives = self._position.signal(times, 3)
        if self.orientation == "transport":
            return carried_sigmas(R_NB, derivatives, variances)
        return course_sigmas(times, derivatives, variances)

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
    def _stamps(self) -> dict[str, Array]:
        """Times of the samples that are there, by what they are of."""
        columns = {"positions": self.position}
        if not isinstance(self.orientation, str):
            columns["attitudes"] = self.orientation
        return {what: self.t[known_rows(x)] for what, x in columns.items()}

    @cached_property
    def _position(self) -> Behind:
        known = known_rows(self.position)
        rate = None if self.velocity is None else self.velocity[known]
        return self._behind("positions", self.position[known], self.position_noise, rate)

    @cached_property
    def _attitude(self) -> Behind:
        # Sign-continuous quaternions have no wraps, and a penalty on them is the same in all frames.
        known = known_rows(self.orientation)
        return self._behind("attitudes", self.orientation[known], self.attitude_noise)

    def _behind(self, what: str, x: Array, noise: Array | None, rate: Array | None = None) -> Behind:
        t = self._stamps[what]
        return behind(Columns(what, t, x, self.method, noise, rate), gaps(what, t, self.max_gap))

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
