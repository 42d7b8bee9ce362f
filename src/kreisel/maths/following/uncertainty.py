"""Turns the uncertainty of a path into that of the attitude, rate and angular acceleration of a body along it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.following.tangent import Stillness, tangent_motion

Array = npt.NDArray[np.float64]

_ALWAYS = Stillness(speed=0.0, instant=0.0)


def course_sigmas(t: Array, derivatives: Array, variances: Array) -> tuple[Array, Array, Array]:
    """Standard errors (n, 3) about the axes of B of attitude (rad), rate and angular acceleration, nose along the path.

    derivatives (4, n, 3): position to jerk in N; variances (4, n, 3) of these. Each is moved both ways by its standard
    error, one at a time. NaN where nothing gives the body a heading.
    """
    _, v, a, j = derivatives
    _, headless = tangent_motion(t, v, a, j, _ALWAYS)
    squares = np.zeros((3, len(t), 3))
    for order in (1, 2, 3):
        for axis in range(3):
            step = np.sqrt(variances[order, :, axis])
            sides = []
            for sign in (-1.0, 1.0):
                moved = derivatives.copy()
                moved[order, :, axis] += sign * step
                sides.append(tangent_motion(t, moved[1], moved[2], moved[3], _ALWAYS)[0])
            turned = np.swapaxes(sides[0].R_NB, 1, 2) @ sides[1].R_NB
            # Of the small turn between both sides; a large one is as good as unknown.
            turn = np.stack([turned[:, 2, 1], turned[:, 0, 2], turned[:, 1, 0]], axis=1)
            squares[0] += np.square(0.5 * turn)
            squares[1] += np.square(0.5 * (sides[1].omega_NB_B - sides[0].omega_NB_B))
            squares[2] += np.square(0.5 * (sides[1].alpha_NB_B - sides[0].alpha_NB_B))
    squares[:, headless] = np.nan
    theta, omega, alpha = np.sqrt(squares)
    return theta, omega, alpha


def carried_sigmas(R_NB: Array, derivatives: Array, variances: Array) -> tuple[Array, Array, Array]:
    """The same for a body with R_NB (n, 3, 3) that is carried along the path without twisting about it.

    To leading order: the nose turns by dv / v, its rate is a / v and the derivative of that j / v, across the path.
    """
    speed = np.linalg.norm(derivatives[1], axis=1)[:, None]
    along = np.where(speed > 0.0, derivatives[1] / np.maximum(speed, 1e-300), np.nan)
    out = []
    for order in (1, 2, 3):
        # Of the axis e the part of kappa = v x (.) / v^2, component by component.
        turned = np.zeros((len(speed), 3))
        for axis in range(3):
            unit = np.zeros(3)
            unit[axis] = 1.0
            kappa = np.cross(along, unit) / speed
            turned += np.square(np.einsum("nji,nj->ni", R_NB, kappa)) * variances[order, :, axis, None]
        out.append(np.sqrt(turned))
    return out[0], out[1], out[2]
