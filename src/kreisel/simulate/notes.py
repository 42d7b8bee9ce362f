"""Turns what happened to a body along its path into notes that a user can read and look up by time."""

from __future__ import annotations

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.motion import Note
from kreisel.maths.following.exact import Followed, Joints
from kreisel.maths.following.joints import TURN

AIMLESS = Note("rest", "nothing gives the body a heading, as it never moves horizontally: heading 0 is taken")


def path_notes(followed: Followed) -> tuple[Note, ...]:
    """One note for every step of attitude or rate, and one where nothing gave the body a heading."""
    return (*joint_notes(followed.joints), *([AIMLESS] if followed.aimless else []))


def joint_notes(joints: Joints) -> tuple[Note, ...]:
    """One note for every joint, of kind "heading-jump" or "rate-step"."""
    rows = zip(
        joints.t,
        joints.turns,
        joints.rate_steps,
        joints.before.R_NB[:, :, 0],
        joints.after.R_NB[:, :, 0],
        joints.before.omega_NB_B,
        joints.after.omega_NB_B,
        strict=True,
    )
    return tuple(_note(*row) for row in rows)


def _note(t: float, turn: float, step: float, x0: Array, x1: Array, omega0: Array, omega1: Array) -> Note:
    rates = f"from {_vector(omega0)} to {_vector(omega1)} rad/s"
    if turn > TURN:
        angle = f"{np.rad2deg(turn):.4g} deg"
        text = f"{_cause(x0, x1)}: the body turns by {angle} in an instant; its rate goes {rates}"
        return Note("heading-jump", text, float(t))
    text = (
        f"the rate steps by {step:.4g} rad/s, {rates}; with a lever arm this is an impulse of angular "
        "acceleration, which no finite sample can carry"
    )
    return Note("rate-step", text, float(t))


def end_note(number: int, what: str, t: float, position: Array, heading: float, speed: float) -> Note:
    """How a motion that was told as a `number` of segments or commands ends: s, m in N, rad, m/s."""
    # A billionth is round-off, and reads badly.
    x, y, z, angle, v = np.round([*position, np.rad2deg(heading), speed], 9) + 0.0
    many = f"{number} {what}" + ("" if number == 1 else "s")
    text = f"{many} in {t:.6g} s; at their end {v:.4g} m/s at ({x:.6g}, {y:.6g}, {z:.6g}) m, heading {angle:.6g} deg"
    return Note("method", text)


def _cause(x_before: Array, x_after: Array) -> str:
    """Why a body along the path turns: from its nose on either side."""
    same = float(x_before @ x_after)
    if same < -1.0 + 1e-6:
        return "the path reverses"
    return "the path passes through the vertical" if same > 1.0 - 1e-6 else "the path has a corner"


def _vector(v: Array) -> str:
    return "(" + ", ".join(f"{x + 0.0:.4g}" for x in np.where(np.abs(v) < 1e-6, 0.0, v)) + ")"
