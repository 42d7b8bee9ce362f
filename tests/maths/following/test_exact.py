"""A body along its path, through rest, reversal, the vertical, corners and seams."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

from kreisel.maths.following.exact import Followed, follow
from kreisel.maths.following.tangent import Path
from kreisel.maths.jets import differentiate

Array = npt.NDArray[np.float64]
Function = Callable[[Array], Array]

EVERYWHERE = (-np.inf, np.inf)


def path(x: Function, y: Function, z: Function) -> Path:
    return lambda t, order: differentiate(lambda u: (x(u), y(u), z(u)), t, order)


def nothing(t: Array) -> Array:
    return 0.0 * t


def wave(t: Array) -> Array:
    return np.cos(2.0 * np.pi * t)


def move(t: Array) -> Array:
    """From 0 to 1 within [0, 1] with the least jerk, at rest before and after."""
    u = np.clip(t, 0.0, 1.0)
    return u**3 * (10.0 - 15.0 * u + 6.0 * u**2)


def heading(found: Followed) -> Array:
    return np.rad2deg(np.arctan2(found.attitude.R_NB[:, 1, 0], found.attitude.R_NB[:, 0, 0]))


TIMES = np.arange(-400, 800) / 200.0


def test_a_line_back_and_forth_turns_round_at_every_end() -> None:
    t = np.arange(0, 1001) / 200.0
    found = follow(path(wave, lambda u: 2.0 * wave(u), nothing), t)
    np.testing.assert_allclose(found.joints.t, np.arange(0.5, 5.01, 0.5), atol=1e-11)
    np.testing.assert_allclose(found.joints.turns, np.pi)
    # The first row is after the reversal at t = 0 already, and each row belongs to what follows it.
    ahead = np.rad2deg(np.arctan2(2.0, 1.0))
    expected = np.where(np.floor(t / 0.5 + 1e-9) % 2 == 0, ahead - 180.0, ahead)
    np.testing.assert_allclose(heading(found), expected, atol=1e-9)
    assert np.abs(found.attitude.omega_NB_B).max() < 1e-9


@pytest.mark.parametrize("rate", [7.0, 13.0, 71.0, 1000.0])
def test_reversals_are_found_whatever_the_sampling_rate(rate: float) -> None:
    t = np.arange(0.1, 5.0, 1.0 / rate)
    found = follow(path(wave, nothing, nothing), t)
    expected = np.arange(0.5, t[-1], 0.5)
    np.testing.assert_allclose(found.joints.t, expected, atol=1e-11)


@pytest.mark.parametrize("rate", [1.01, 1.7, 2.0, 2.5, 3.0, 5.0, 10.0, 20.0, 50.0, 200.0])
def test_a_smooth_fast_path_has_no_joints_at_any_rate(rate: float) -> None:
    # The loop of figure 1 turns by up to 3 Hz: at most rates here its samples alone look like leaps.
    loop = path(lambda t: 0.8 * wave(t), lambda t: 0.8 * np.sin(2 * np.pi * t), lambda t: 0.3 * wave(3.0 * t))
    assert follow(loop, np.arange(0.0, 20.0, 1.0 / rate)).joints.t.size == 0


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6])
def test_a_narrow_turn_is_no_reversal(gap: float) -> None:
    # An ellipse as thin as a hair: the body does turn by 180 degrees, steeply but steadily.
    thin = path(wave, lambda t: gap * np.sin(2.0 * np.pi * t), nothing)
    assert follow(thin, np.arange(0.013, 3.0, 0.01)).joints.t.size == 0


def least_snap(t: Array) -> Array:
    u = np.clip(t, 0.0, 1.0)
    return u**4 * (35.0 - 84.0 * u + 70.0 * u**2 - 20.0 * u**3)


def braking(t: Array) -> Array:
    u = np.clip(t, 0.0, 1.0)
    return u - 0.5 * u**2


def seam_after_the_sample(t: Array) -> Array:
    return np.where((t >= 0.0) & (t <= 1.0), 3.0 * t**2 - 2.0 * t**3, np.where(t > 1.0, 1.0, 0.0))


@pytest.mark.parametrize("motion", [move, least_snap, braking, seam_after_the_sample])
def test_a_body_at_rest_keeps_its_heading_and_has_that_of_its_first_movement_before(motion: Function) -> None:
    found = follow(path(motion, lambda t: 2.0 * motion(t), nothing), TIMES)
    np.testing.assert_allclose(heading(found), np.rad2deg(np.arctan2(2.0, 1.0)), atol=1e-9)
    assert found.joints.t.size == 0
    assert not found.aimless


def test_setting_off_in_another_direction_is_a_jump_at_that_time() -> None:
    found = follow(path(move, lambda t: move(t - 2.0), nothing), TIMES)
    np.testing.assert_allclose(heading(found), np.where(TIMES >= 2.0, 90.0, 0.0), atol=1e-9)
    np.testing.assert_allclose(found.joints.t, [2.0], atol=1e-6)
    np.testing.assert_allclose(found.joints.turns, [0.5 * np.pi])


def test_rest_is_the_same_whichever_rows_are_asked_for() -> None:
    moving = path(move, lambda t: 2.0 * move(t) + move(t - 3.0), nothing)
    whole = follow(moving, np.arange(0.0, 200.0, 0.05))
    for rows in (slice(1500, 1501), slice(30, 45), slice(0, None, 977)):
        part = follow(moving, np.arange(0.0, 200.0, 0.05)[rows])
        # What was found by halving from different starts agrees to the last places.
        np.testing.assert_allclose(part.attitude.R_NB, whole.attitude.R_NB[rows], atol=1e-14)


def test_a_body_that_never_moves_has_heading_zero_and_says_so() -> None:
    found = follow(path(nothing, nothing, nothing), np.arange(5.0))
    np.testing.assert_array_equal(found.attitude.R_NB, np.tile(np.eye(3), (5, 1, 1)))
    assert found.aimless


def test_a_lift_keeps_its_heading_and_turns_over_when_it_reverses() -> None:
    # Drives east, then rises and sinks: nose up, nose down, and the y axis to the north throughout.
    found = follow(path(move, nothing, lambda t: move(t - 1.5) - move(t - 3.0)), np.arange(0, 900) / 200.0)
    up = found.attitude.R_NB[:, 2, 0]
    assert up[350] == pytest.approx(1.0) and up[800] == pytest.approx(-1.0)
    np.testing.assert_allclose(found.attitude.R_NB[:, :, 1], np.tile([0.0, 1.0, 0.0], (900, 1)), atol=1e-12)
    np.testing.assert_allclose(found.joints.t, [1.5, 3.0], atol=1e-6)
    np.testing.assert_allclose(np.rad2deg(found.joints.turns), [90.0, 180.0])


def test_a_vertical_loop_flips_where_it_is_vertical_with_its_rates_on_both_sides() -> None:
    t = np.arange(0, 401) / 200.0 + 0.0013
    found = follow(path(wave, nothing, lambda u: np.sin(2.0 * np.pi * u)), t)
    np.testing.assert_allclose(found.joints.t, [0.5, 1.0, 1.5, 2.0], atol=1e-11)
    np.testing.assert_allclose(found.joints.turns, np.pi)
    for side in (found.joints.before, found.joints.after):
        np.testing.assert_allclose(
            np.abs(side.omega_NB_B), np.tile([0.0, 2.0 * np.pi, 0.0], (4, 1)), atol=1e-9
        )


def test_a_corner_is_a_jump() -> None:
    found = follow(
        path(lambda t: np.minimum(t, 1.0), lambda t: np.maximum(t - 1.0, 0.0), nothing),
        np.arange(0, 2, 0.013),
    )
    np.testing.assert_allclose(found.joints.t, [1.0], atol=1e-11)
    np.testing.assert_allclose(found.joints.turns, [0.5 * np.pi])


@pytest.mark.parametrize("rate", [20.0, 200.0])
def test_a_seam_between_line_and_circle_is_a_step_of_the_rate(rate: float) -> None:
    # Radius 0.1 m at 0.8 m/s: 8 rad/s from t = 1 s on.
    x = lambda t: np.where(t < 1.0, 0.8 * (t - 1.0), 0.1 * np.sin(8.0 * (t - 1.0)))  # noqa: E731
    y = lambda t: np.where(t < 1.0, 0.0, 0.1 - 0.1 * np.cos(8.0 * (t - 1.0)))  # noqa: E731
    found = follow(path(x, y, nothing), np.arange(0.0, 1.3, 1.0 / rate))
    np.testing.assert_allclose(found.joints.t, [1.0], atol=1e-11)
    np.testing.assert_allclose(found.joints.rate_steps, [8.0], rtol=1e-9)
    np.testing.assert_allclose(found.joints.before.omega_NB_B, [[0.0, 0.0, 0.0]], atol=1e-9)
    assert found.joints.turns[0] < 1e-9


def test_the_end_of_the_span_is_seen_from_inside() -> None:
    t = np.array([0.0, 0.25, 0.5])
    inside = follow(path(wave, nothing, nothing), t, (0.0, 0.5))
    beyond = follow(path(wave, nothing, nothing), t, EVERYWHERE)
    np.testing.assert_allclose(np.abs(heading(inside)), [180.0, 180.0, 180.0])
    np.testing.assert_allclose(np.abs(heading(beyond)), [180.0, 180.0, 0.0], atol=1e-9)
    assert inside.joints.t.size == 0 and beyond.joints.t.size == 1


def test_no_rows_give_no_rows() -> None:
    found = follow(path(wave, nothing, nothing), np.empty(0))
    assert found.p_NB.shape == (0, 3) and found.joints.t.size == 0


def bell(t: Array) -> Array:
    return np.exp(-((6.0 * (t - 2.0)) ** 2))


def smooth_stop(t: Array) -> Array:
    return np.where(t < 2.0, np.exp(-1.0 / np.maximum(2.0 - t, 1e-9)), 0.0)


def smooth_start(t: Array) -> Array:
    return smooth_stop(4.0 - t)


def fade(t: Array) -> Array:
    return np.tanh(20.0 * (t - 2.0))


@pytest.mark.parametrize("slope", [(1.0, 0.0, 0.0), (-1.0, 0.5, 0.3), (1.0, 0.0, 2e-3)])
@pytest.mark.parametrize(
    "motion, turns_at", [(smooth_stop, []), (bell, [2.0]), (fade, []), (smooth_start, [])]
)
def test_a_movement_that_fades_away_does_not_turn_round(
    motion: Function, turns_at: list[float], slope: tuple[float, float, float]
) -> None:
    # All derivatives go to zero with the velocity, and any few of them promise a reversal that never comes.
    x, y, z = ((lambda t, s=s: s * motion(t)) for s in slope)
    found = follow(path(x, y, z), np.arange(0, 4000) / 1000.0)
    np.testing.assert_allclose(found.joints.t, turns_at, atol=1e-9)
    # One attitude before the turn and one after it, to the accuracy with which tiny velocities have a direction.
    for rows in (slice(0, 2000), slice(2000, None)):
        R = found.attitude.R_NB[rows]
        np.testing.assert_allclose(R, np.broadcast_to(R[0], R.shape), atol=1e-9)


def test_the_last_instants_before_a_stop_still_go_forward() -> None:
    # Expanded, the velocity there is round-off, and its derivatives promise a reversal.
    t = np.sort(1.0 - 10.0 ** -np.arange(3.0, 12.0, 0.25))
    np.testing.assert_array_equal(heading(follow(path(least_snap, nothing, nothing), t)), 0.0)


def test_a_fading_stop_and_a_smooth_start_elsewhere_are_one_jump() -> None:
    t = np.arange(0, 8000) / 2000.0
    found = follow(path(smooth_stop, smooth_start, nothing), t)
    assert found.joints.t.size == 1
    # 1e-12 m/s, under which nothing is a movement, is passed at 2.03 s.
    assert 2.0 < found.joints.t[0] < 2.03
    west = np.abs(heading(found)) > 170.0
    np.testing.assert_array_equal(west, t < found.joints.t[0])
    np.testing.assert_allclose(heading(found)[~west], 90.0, atol=1e-9)
