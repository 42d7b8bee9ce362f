"""Parallel transport: no twist, no jumps, whatever the path does."""

from collections.abc import Callable

import mpmath
import numpy as np
import numpy.typing as npt
import pytest

from kreisel.maths.following.tangent import Path
from kreisel.maths.following.transport import follow_without_twist
from kreisel.maths.jets import differentiate

Array = npt.NDArray[np.float64]
Function = Callable[[Array], Array]
W = 2.0 * np.pi


def path(x: Function, y: Function, z: Function) -> Path:
    return lambda t, order: differentiate(lambda u: (x(u), y(u), z(u)), t, order)


LOOP = path(lambda t: 0.8 * np.cos(W * t), lambda t: 0.8 * np.sin(W * t), lambda t: 0.3 * np.cos(3.0 * W * t))
CUSP = path(  # reverses at t = 0, bending in three dimensions
    lambda t: t**2 + 0.3 * t**4, lambda t: 0.2 * t**2 + t**3, lambda t: 0.7 * t**4 - 0.3 * t**2
)


def angle_between(A: Array, B: Array) -> float:
    return float(np.linalg.norm(A - B) / np.sqrt(2.0))


def twist_of_level_frame(start: float, end: float) -> float:
    """Integral of omega_x of the tangential attitude on the loop of figure 1, to 20 digits."""

    def rate(t: mpmath.mpf) -> mpmath.mpf:
        w = 2 * mpmath.pi
        c, s, third = mpmath.cos(w * t), mpmath.sin(w * t), mpmath.sin(3 * w * t)
        v = (-0.8 * w * s, 0.8 * w * c, -mpmath.mpf(0.3) * 3 * w * third)
        size = mpmath.sqrt(sum(x * x for x in v))
        return w * v[2] / size  # the heading turns at w; omega_x = -phi_z' sin(phi_y)

    with mpmath.workdps(25):
        return float(mpmath.quad(rate, mpmath.linspace(start, end, 12 * int(np.ceil(end - start)) + 1)))


@pytest.mark.parametrize("end", [0.37, 1.3, 4.9])
def test_roll_equals_the_twist_of_the_level_frame_taken_back(end: float) -> None:
    found = follow_without_twist(LOOP, np.array([0.0, end])).attitude.R_NB[1]
    x = found[:, 0]
    y = np.array([-x[1], x[0], 0.0]) / np.hypot(x[0], x[1])
    roll = np.arctan2(found[:, 1] @ np.cross(x, y), found[:, 1] @ y)
    expected = -twist_of_level_frame(0.0, end)
    # 1e-12 rad over 5 s.
    assert abs(np.remainder(roll - expected + np.pi, W) - np.pi) < 1e-12


def test_the_nose_is_on_the_tangent_and_the_matrix_orthonormal() -> None:
    t = np.arange(0, 1001) / 200.0
    found = follow_without_twist(LOOP, t)
    R, v = found.attitude.R_NB, found.v_NB
    np.testing.assert_allclose(R[:, :, 0], v / np.linalg.norm(v, axis=1)[:, None], atol=1e-15)
    np.testing.assert_allclose(np.einsum("nji,njk->nik", R, R), np.tile(np.eye(3), (1001, 1, 1)), atol=2e-15)


@pytest.mark.parametrize("curve", [LOOP, CUSP], ids=["loop", "cusp"])
def test_rates_are_those_of_the_matrix_and_have_no_twist(curve: Path) -> None:
    t, h = np.array([-0.41, -0.1, -1e-2, 0.0, 3e-3, 0.2, 0.777]), 2e-5
    rows = np.sort(np.concatenate([t - h, t, t + h]))
    found = follow_without_twist(curve, rows).attitude
    middle = found.R_NB[1::3]
    spin = np.einsum("nji,njk->nik", middle, (found.R_NB[2::3] - found.R_NB[::3]) / (2.0 * h))
    # Central differences: h^2 / 6 times the third derivative, which reaches 1e5 and 3e6 on the loop.
    np.testing.assert_allclose(
        found.omega_NB_B[1::3], np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1), atol=2e-5
    )
    slope = (found.omega_NB_B[2::3] - found.omega_NB_B[::3]) / (2.0 * h)
    np.testing.assert_allclose(found.alpha_NB_B[1::3], slope, atol=4e-4)
    np.testing.assert_array_equal(found.omega_NB_B[:, 0], 0.0)


def test_a_reversal_makes_the_body_run_backwards_without_a_jump() -> None:
    t = np.arange(-200, 201) / 200.0
    found = follow_without_twist(CUSP, t, (-1.0, 1.0))
    assert found.joints.t.size == 0
    along = np.einsum("ni,ni->n", found.v_NB, found.attitude.R_NB[:, :, 0])
    assert (along[:200] > 0.0).all() and (along[201:] < 0.0).all()


def test_a_vertical_loop_keeps_its_axis() -> None:
    t = np.arange(0, 401) / 200.0
    found = follow_without_twist(path(lambda u: np.cos(W * u), lambda u: 0.0 * u, lambda u: np.sin(W * u)), t)
    assert found.joints.t.size == 0
    sideways = found.attitude.R_NB[:, :, 1]
    np.testing.assert_allclose(sideways, np.tile(sideways[0], (401, 1)), atol=1e-14)
    np.testing.assert_allclose(np.abs(found.attitude.omega_NB_B[:, 1]), W, rtol=1e-12)


def test_the_answer_does_not_depend_on_the_rows_asked_for() -> None:
    t = np.arange(0, 1001) / 200.0
    whole = follow_without_twist(LOOP, t - 2.0).attitude.R_NB
    for rows in (slice(0, 1), slice(730, 760), slice(0, None, 91), slice(1000, 1001)):
        part = follow_without_twist(LOOP, (t - 2.0)[rows]).attitude.R_NB
        # Cells are summed from another start: a few round-offs.
        np.testing.assert_allclose(part, whole[rows], atol=1e-13)


def test_after_a_rest_the_body_turns_by_the_smallest_angle() -> None:
    def move(t: Array) -> Array:
        u = np.clip(t, 0.0, 1.0)
        return u**3 * (10.0 - 15.0 * u + 6.0 * u**2)

    t = np.arange(-100, 800) / 200.0
    bend = path(move, lambda u: move(u - 2.0), lambda u: 0.0 * u)
    found = follow_without_twist(bend, t)
    np.testing.assert_allclose(found.joints.t, [2.0], atol=1e-5)
    np.testing.assert_allclose(found.joints.turns, [0.5 * np.pi])
    np.testing.assert_allclose(
        found.attitude.R_NB[:490, :, 0], np.tile([1.0, 0.0, 0.0], (490, 1)), atol=1e-12
    )
    np.testing.assert_allclose(
        found.attitude.R_NB[510:, :, 0], np.tile([0.0, 1.0, 0.0], (390, 1)), atol=1e-12
    )
    np.testing.assert_allclose(found.attitude.R_NB[:, :, 2], np.tile([0.0, 0.0, 1.0], (900, 1)), atol=1e-12)


def test_it_starts_level_at_the_start_of_the_span() -> None:
    found = follow_without_twist(LOOP, np.array([0.3, 0.9]), (0.3, 5.0)).attitude.R_NB
    assert abs(found[0, 2, 1]) < 1e-15
    assert angle_between(found[0], found[1]) > 0.1
