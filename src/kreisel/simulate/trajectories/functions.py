"""Turns functions of time, written with NumPy, into a trajectory that is differentiated exactly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from numbers import Real
from typing import Any

import numpy as np

from kreisel.data.checks import Array, choice, increasing, shaped
from kreisel.data.motion import Motion
from kreisel.maths.following.exact import BLOCK, follow
from kreisel.maths.following.transport import follow_without_twist
from kreisel.maths.jets import differentiate
from kreisel.maths.kinematics import euler_motion
from kreisel.simulate.notes import path_notes

Function = Callable[[Any], Any]

_DERIVATIVES = ("value", "first derivative", "second derivative", "third derivative")


@dataclass(frozen=True, eq=False)
class FunctionTrajectory:
    """A trajectory given by functions of time in s.

    position: x, y, z in m in N: three functions, or one that returns (n, 3); plain numbers are constants.
    orientation: phi_x, phi_y, phi_z in rad in the same ways; or "tangent", x axis along the path and y axis
        level; or "transport", x axis along the path without ever twisting about it.
    span: first and last time at which the functions hold, s.
    t0_ns: epoch of t = 0, ns.

    Derivatives are exact to round-off; `kreisel.maths.jets` says what is taken at kinks. Along a path a row
    is what holds just after its time, and at rest the last attitude is held. The notes of a motion name every
    instant at which attitude or rate step.
    """

    position: Any
    orientation: Any = "tangent"
    span: tuple[float, float] = field(default=(-np.inf, np.inf), kw_only=True)
    t0_ns: int = field(default=0, kw_only=True)
    name: str = field(default="", kw_only=True)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "position", _one_function("position", self.position))
        if isinstance(self.orientation, str):
            choice("orientation", self.orientation, ("tangent", "transport"))
        else:
            put(self, "orientation", _one_function("orientation", self.orientation))
        try:
            first, last = (float(end) for end in self.span)
        except (TypeError, ValueError):
            first = last = np.nan
        if not first < last:
            raise ValueError(f"span must be (first, last) with first < last, s; got {self.span!r}.")
        put(self, "span", (first, last))

    def sample(self, t: Array) -> Motion:
        """Motion at times t (n,) s, increasing and inside the span.

        TypeError: a function uses what cannot be differentiated; the message says what to write instead.
        ValueError: t is not increasing or leaves the span; a function or a derivative is not finite.
        """
        times = increasing("t", shaped("t", t, ("n",)))
        _check_inside(times, self.span)
        if not isinstance(self.orientation, str):
            p, v, a = self._position(times, 2)
            _check_finite("position", times, (p, v, a))
            return Motion(times, p, v, a, *self._attitude(times), self.t0_ns, self.name)
        along = follow if self.orientation == "tangent" else follow_without_twist
        found = along(self._position, times, self.span)
        _check_finite("position", times, (found.p_NB, found.v_NB, found.a_NB))
        return Motion(
            times,
            found.p_NB,
            found.v_NB,
            found.a_NB,
            *found.attitude,
            self.t0_ns,
            self.name,
            path_notes(found),
        )

    def _position(self, t: Array, order: int) -> Array:
        return _differentiated("position", self.position, t, order)

    def _attitude(self, times: Array) -> tuple[Array, Array, Array]:
        """R_NB, omega_NB_B and alpha_NB_B, block by block to bound the memory."""
        n = len(times)
        out = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3))
        for low in range(0, n, BLOCK):
            rows = slice(low, low + BLOCK)
            phi = _differentiated("orientation", self.orientation, times[rows], 2)
            _check_finite("orientation", times[rows], phi)
            for whole, piece in zip(out, euler_motion(*phi), strict=True):
                whole[rows] = piece
        return out


def _one_function(name: str, given: Any) -> Function:
    """One function that returns three quantities, from any of the ways to write it."""
    if callable(given):
        return given
    parts = tuple(given) if isinstance(given, list | tuple | np.ndarray) else ()
    if len(parts) != 3 or not all(callable(part) or isinstance(part, Real) for part in parts):
        held = (
            f"{len(parts)} of {', '.join(sorted({type(p).__name__ for p in parts}))}"
            if parts
            else repr(given)
        )
        raise TypeError(
            f"{name} must be three functions of time (or numbers), or one function that returns (n, 3); "
            f"got {held}. Samples go to SampledTrajectory."
        )
    return lambda t: tuple(part(t) if callable(part) else float(part) for part in parts)


def _differentiated(name: str, function: Function, t: Array, order: int) -> Array:
    out = differentiate(function, t, order)
    if out.ndim != 3:
        raise ValueError(f"{name} must return three quantities, as (n, 3); it returned one.")
    return out


def _check_inside(times: Array, span: tuple[float, float]) -> None:
    outside = (times < span[0]) | (times > span[1])
    if outside.any():
        k = int(np.argmax(outside))
        raise ValueError(
            f"t must lie inside the span of the trajectory, {span[0]:.9g} to {span[1]:.9g} s; "
            f"row {k} is {times[k]:.9g}."
        )


def _check_finite(name: str, times: Array, derivatives: Any) -> None:
    for k, rows in enumerate(derivatives):
        bad = ~np.isfinite(rows).all(axis=1)
        if bad.any():
            row = int(np.argmax(bad))
            t = times[row]
            raise ValueError(
                f"the {_DERIVATIVES[k]} of {name} is not finite at t = {t:.9g} s. "
                f"{_cause(rows[row])}, or end the span before it."
            )


def _cause(row: Array) -> str:
    if np.isinf(row).any():
        return "It is infinite: look for a division by zero or the root of zero there"
    return (
        "It is undefined: look for 0 / 0 or for an exp that overflows there (1 / (1 + np.exp(-x)) can be written "
        "0.5 + 0.5 * np.tanh(x / 2))"
    )


def example() -> FunctionTrajectory:
    """A ship that rolls and pitches while it turns."""
    return FunctionTrajectory(
        (lambda t: 20.0 * np.cos(0.1 * t), lambda t: 20.0 * np.sin(0.1 * t), lambda t: 0.5 * np.sin(0.8 * t)),
        (
            lambda t: 0.2 * np.sin(0.9 * t),
            lambda t: 0.1 * np.sin(0.7 * t + 1.0),
            lambda t: 0.1 * t + np.pi / 2.0,
        ),
        name="ship",
    )
