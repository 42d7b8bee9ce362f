"""Bodies that follow sampled paths: through rest, reversal and the vertical, with noise and without."""

import numpy as np
import pytest

from kreisel.maths.following.transport import follow_without_twist
from kreisel.maths.jets import differentiate
from kreisel.simulate.trajectories.sampled import SampledTrajectory
from tests.truth import truth

T = np.arange(0.0, 20.0, 0.01)


def drive(t, start, duration=4.0, distance=5.0):
    """Smooth way from rest to rest."""
    x = np.clip((t - start) / duration, 0.0, 1.0)
    return distance * x**3 * (10.0 - 15.0 * x + 6.0 * x * x)


STILL = np.zeros_like(T)
STOP_AND_GO = np.stack([drive(T, 2.0) + drive(T, 12.0), STILL, STILL], axis=1)
TURN_AT_A_STOP = np.stack([drive(T, 2.0), drive(T, 12.0), STILL], axis=1)
PARKING = np.stack([drive(T, 2.0) - drive(T, 8.0, distance=2.0), STILL, STILL], axis=1)
PENDULUM = np.stack([np.sin(T), STILL, STILL], axis=1)
LOOPING = np.stack([np.sin(T), STILL, 1.0 - np.cos(T)], axis=1)


def heading_deg(motion):
    return np.rad2deg(np.arctan2(motion.R_NB[:, 1, 0], motion.R_NB[:, 0, 0]))


def jumps(motion):
    return np.array([note.t for note in motion.notes if note.kind == "heading-jump"])


def noisy(path, sigma, rng):
    return path + sigma * rng.normal(size=path.shape)


@pytest.mark.parametrize("sigma", [0.0, 1e-4])
def test_a_car_that_stops_keeps_its_heading(sigma, rng):
    motion = SampledTrajectory(T, noisy(STOP_AND_GO, sigma, rng)).sample()
    assert not jumps(motion).size
    # The floor of speed is where noise knows the direction to 3 degrees.
    assert np.abs(heading_deg(motion)).max() < 10.0
    resting = (T < 1.5) | ((T > 7.0) & (T < 11.0)) | (T > 17.0)
    assert np.abs(motion.omega_NB_B[resting]).max() == 0.0


@pytest.mark.parametrize("sigma", [0.0, 1e-4])
def test_a_heading_that_changes_at_a_stop_jumps_once_and_is_reported(sigma, rng):
    motion = SampledTrajectory(T, noisy(TURN_AT_A_STOP, sigma, rng)).sample()
    # Where the second drive leaves the floor: a few hundredths after its begin at 12 s.
    np.testing.assert_allclose(jumps(motion), [12.0], atol=0.1)
    np.testing.assert_allclose(heading_deg(motion)[[0, 500, 1100, 1400]], [0.0, 0.0, 0.0, 90.0], atol=8.0)


@pytest.mark.parametrize("sigma", [0.0, 1e-4])
def test_every_reversal_of_a_pendulum_is_found(sigma, rng):
    motion = SampledTrajectory(T, noisy(PENDULUM, sigma, rng)).sample()
    np.testing.assert_allclose(jumps(motion), np.pi / 2 + np.pi * np.arange(6), atol=0.01)
    np.testing.assert_allclose(np.abs(motion.R_NB[:, 0, 0]), 1.0, atol=0.02)


def test_a_looping_passes_the_vertical_with_its_true_pitch_rate():
    motion = SampledTrajectory(T, LOOPING).sample()
    np.testing.assert_allclose(jumps(motion), np.pi / 2 + np.pi * np.arange(6), atol=0.01)
    # Once round in 2 pi seconds, about the axis to the left or, after the roll over the top, to the right.
    np.testing.assert_allclose(np.abs(motion.omega_NB_B[:, 1]), 1.0, atol=1e-6)
    np.testing.assert_allclose(motion.omega_NB_B[:, [0, 2]], 0.0, atol=1e-6)


def test_a_body_that_never_moves_heads_east():
    motion = SampledTrajectory(T, np.ones((len(T), 3))).sample()
    np.testing.assert_array_equal(motion.R_NB, np.tile(np.eye(3), (len(T), 1, 1)))
    np.testing.assert_array_equal(motion.omega_NB_B, np.zeros((len(T), 3)))


def test_a_smooth_fast_path_at_a_low_rate_has_no_jumps():
    t = np.arange(0.0, 5.0, 0.05)
    path = np.stack([2.0 * np.cos(3.0 * t), np.sin(6.0 * t), np.cos(3.0 * t)], axis=1)
    assert not jumps(SampledTrajectory(t, path).sample()).size


@pytest.mark.parametrize("orientation", ["tangent", "transport"])
@pytest.mark.parametrize("path", [STOP_AND_GO, TURN_AT_A_STOP, PARKING, PENDULUM, LOOPING], ids=range(5))
def test_any_choice_of_times_gives_the_same_attitude(orientation, path):
    trajectory = SampledTrajectory(T, path, orientation)
    whole, part = trajectory.sample(T), trajectory.sample(T[3::7])
    for field in ("R_NB", "omega_NB_B", "alpha_NB_B"):
        np.testing.assert_array_equal(getattr(whole, field)[3::7], getattr(part, field))


@pytest.mark.parametrize("sigma", [0.0, 1e-4])
@pytest.mark.parametrize("path", [STOP_AND_GO, PARKING, PENDULUM, LOOPING], ids=range(4))
def test_transport_has_no_jumps_and_no_twist(path, sigma, rng):
    motion = SampledTrajectory(T, noisy(path, sigma, rng), "transport").sample()
    # 1 rad/s at 100 Hz turns by 0.01; noise lets a slow nose tremble.
    assert np.abs(np.diff(motion.R_NB, axis=0)).max() < 0.02
    np.testing.assert_array_equal(motion.omega_NB_B[:, 0], 0.0)
    speed = np.linalg.norm(motion.v_NB, axis=1)
    moving = speed > 0.1
    along = np.sum(motion.R_NB[:, :, 0] * motion.v_NB, axis=1)[moving] / speed[moving]
    np.testing.assert_allclose(np.abs(along), 1.0, atol=1e-12)


def test_transport_of_samples_is_transport_of_the_functions_behind_them():
    t = np.arange(1001) / 200.0

    def figure_1(t):
        w = 2.0 * np.pi
        return np.stack([0.8 * np.cos(w * t), 0.8 * np.sin(w * t), 0.3 * np.cos(3.0 * w * t)], axis=1)

    exact = follow_without_twist(lambda t, order: differentiate(figure_1, t, order), t, (0.0, 5.0)).attitude
    motion = SampledTrajectory(t, truth("A", t).p_NB, "transport").sample()
    # Two independent integrators; the fourth-order one loses (0.025 rad)^5 in each of 4000 steps.
    np.testing.assert_allclose(motion.R_NB, exact.R_NB, rtol=0, atol=1e-8)
    # Derivatives of samples at their ends, as for the tangent.
    np.testing.assert_allclose(motion.omega_NB_B, exact.omega_NB_B, rtol=0, atol=1e-6)


# What a reviewer tried, and what a body along it does: the times at which it jumps, and by how much in degrees.
S = np.arange(0.0, 4.0001, 0.01)
C = np.cos(2.0 * S)
NOTHING = 0.0 * S
REVERSALS = np.pi / 2.0 * np.arange(1, 3)
KNOTS = [0.0, 1.0, 2.0, 3.0, 4.0]
VERTICAL = np.stack([NOTHING, NOTHING, np.sin(2.0 * S)], axis=1)
SLANTED = np.stack([C, 0.5 * C, 0.2 * C], axis=1)
STOP_THEN_TURN = np.stack(
    [np.where(S < 1.0, -((1.0 - S) ** 3), 0.0), np.where(S > 2.0, (S - 2.0) ** 3, 0.0), NOTHING], axis=1
)
WAYPOINTS = np.stack(
    [np.interp(S, KNOTS, [0.0, 1.0, 1.0, 1.0, 0.0]), np.interp(S, KNOTS, [0.0, 0.0, 1.0, 1.0, 1.0]), NOTHING],
    axis=1,
)
CUSP = np.stack([(S - 2.0) ** 2, (S - 2.0) ** 3, NOTHING], axis=1)
JUMPS = [
    (VERTICAL, "tangent", np.pi / 4.0 + np.pi / 2.0 * np.arange(3), 180.0, 1e-6),
    (VERTICAL, "transport", [], 0.0, 0.0),
    (SLANTED, "tangent", REVERSALS, 180.0, 1e-6),
    (SLANTED, "transport", [], 0.0, 0.0),
    (STOP_THEN_TURN, "tangent", [2.0], 90.0, 5e-3),  # a cubic leaves the floor slowly
    (STOP_THEN_TURN, "transport", [2.0], 90.0, 5e-3),
    (WAYPOINTS, "tangent", [3.0], 90.0, 0.02),  # two samples: where the interpolation turns the corner
    (WAYPOINTS, "transport", [3.0], 90.0, 0.02),
    (CUSP, "tangent", [2.0], 180.0, 1e-6),
    (CUSP, "transport", [], 0.0, 0.0),
]


@pytest.mark.parametrize("path, orientation, at, by, within", JUMPS, ids=range(len(JUMPS)))
def test_the_gyro_explains_every_turn_but_those_in_the_notes(path, orientation, at, by, within):
    t = np.arange(0.0, 4.0, 1e-3)
    motion = SampledTrajectory(S, path, orientation).sample(t)
    np.testing.assert_allclose(jumps(motion), at, atol=within)
    relative = np.einsum("nji,njk->nik", motion.R_NB[:-1], motion.R_NB[1:])
    turned = np.rad2deg(np.arccos(np.clip((np.trace(relative, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0)))
    rate = np.rad2deg(np.linalg.norm(motion.omega_NB_B, axis=1)) * 1e-3
    unexplained = np.flatnonzero(turned > np.maximum(rate[:-1], rate[1:]) + 2.0)
    np.testing.assert_array_equal(unexplained, np.searchsorted(t, jumps(motion)) - 1)
    # The cusp turns on by 0.1 degree in a millisecond.
    np.testing.assert_allclose(turned[unexplained], by, atol=0.1)


def test_at_rest_the_whole_attitude_is_held():
    motion = SampledTrajectory(S, SLANTED).sample()
    # Up or down along one line, and never level in between; a floor is where 0.05 rad are known.
    np.testing.assert_allclose(np.abs(motion.R_NB[:, 2, 0]), 0.2 / np.sqrt(1.29), atol=0.05)


def test_a_cusp_is_passed_at_its_own_rate():
    t = np.arange(1.9, 2.1, 1e-3)
    motion = SampledTrajectory(S, CUSP, "transport").sample(t)
    # The direction is atan(1.5 (t - 2)); at the cusp itself its rate is that of a quarter step before.
    np.testing.assert_allclose(motion.omega_NB_B[:, 2], 1.5 / (1.0 + 2.25 * (t - 2.0) ** 2), rtol=2e-5)


def test_corners_are_named():
    notes = SampledTrajectory(S, WAYPOINTS).sample().notes
    assert any(
        note.kind == "method" and "corners" in note.text and "1, 2, 3 s" in note.text for note in notes
    )
    assert not any("corners" in note.text for note in SampledTrajectory(S, CUSP).sample().notes)


@pytest.mark.parametrize(
    "orientation, path", [("tangent", VERTICAL), ("tangent", 1.0 + 0.0 * CUSP), ("transport", 0.0 * CUSP)]
)
def test_a_path_that_gives_no_heading_says_so(orientation, path):
    notes = SampledTrajectory(S, path, orientation).sample().notes
    assert [note.kind for note in notes].count("rest") == 1
