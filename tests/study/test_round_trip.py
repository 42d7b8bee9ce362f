"""The loop closed: an ideal recording comes back, a biased one drifts as its bias says."""

from dataclasses import replace

import numpy as np

from kreisel.data.environment import Environment
from kreisel.data.motion import Mount
from kreisel.simulate.clock import Clock
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.trajectories.rest import rest
from kreisel.study.round_trip import complete, round_trip

T = np.arange(2001) / 200.0


def test_a_turned_sensor_off_the_centre_comes_back_under_any_gravity():
    imu = Imu(
        Mount([0.1, 0.2, -0.3], np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])),
        environment=Environment([0, 0, -3.7]),
    )
    motion = lissajous().sample(np.arange(2001) / 1000.0)
    errors = round_trip(imu.ideal(motion), motion.at(imu.mount), imu.environment)
    # A lever arm three times the tests' of strapdown, at the same rate.
    assert errors.position.max() < 1e-10
    assert errors.attitude.max() < 1e-11


def test_biases_drift_as_they_must():
    motion = rest().sample(T)
    ideal = Imu().ideal(motion)
    slow = round_trip(replace(ideal, gyro=ideal.gyro + np.array([0.0, 0.0, 1e-4])), motion)
    np.testing.assert_allclose(slow.dtheta_N, 1e-4 * T[:, None] * [0.0, 0.0, 1.0], atol=1e-13)
    pushed = round_trip(replace(ideal, accel=ideal.accel + np.array([0.02, 0.0, 0.0])), motion)
    np.testing.assert_allclose(pushed.position, 0.01 * T**2, atol=1e-12)
    # Tilt by the gyro's bias leans gravity: g b t^3 / 6, as long as the tilt is small.
    leaning = round_trip(replace(ideal, gyro=ideal.gyro + np.array([1e-5, 0.0, 0.0])), motion)
    np.testing.assert_allclose(leaning.position, 9.80665 * 1e-5 * T**3 / 6.0, atol=1e-9)


def test_lost_samples_and_a_wrong_clock_are_life():
    """A clock 1 % fast: by its own stamps the body at 1 rad/s has turned 1 % too far, whichever samples are lost."""
    imu = Imu(clock=Clock(rate_offset=0.01, loss=0.2))
    motion = FunctionTrajectory((0.0, 0.0, 0.0), (0.0, 0.0, lambda t: t)).sample(T)
    measured = imu.record(motion, 5).measured
    kept, truth = complete(measured, motion)
    assert 0.7 * len(T) < len(kept) == len(truth) < 0.9 * len(T)
    np.testing.assert_array_equal(kept.t, truth.t)
    errors = round_trip(kept, truth, imu.environment)
    turned = 0.01 * (kept.t - kept.t[0]) / 1.01
    # Rates are constant: nothing is lost between samples but digits.
    np.testing.assert_allclose(errors.attitude, turned, atol=1e-9)
