"""Clocks: stamps, lost samples, and when each sensor takes its samples."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.data.environment import STANDARD_GRAVITY, Environment
from kreisel.simulate.clock import Clock, Sampling
from kreisel.simulate.effects.white_noise import WhiteNoise
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.trajectories.rest import rest

T = 3.0 + np.arange(2000) / 200.0
SURROUNDINGS = Environment(field_N_uT=np.array([1.0, 20.0, -44.0]))


def seed_of(rng: np.random.Generator) -> int:
    return int(rng.integers(2**62))


def test_a_perfect_clock_changes_nothing() -> None:
    recorded = Imu().record(lissajous().sample(T), 1)
    assert recorded.measured.t.tobytes() == T.tobytes()


def test_a_fast_clock_gains() -> None:
    recorded = Imu(clock=Clock(offset=0.5, rate_offset=1e-3)).record(rest().sample(T), 1)
    np.testing.assert_allclose(recorded.measured.t - T, 0.5 + 1e-3 * (T - 3.0), atol=1e-14)
    np.testing.assert_array_equal(recorded.ideal.t, T)


def test_jitter_is_even_and_keeps_the_order(rng: np.random.Generator) -> None:
    recorded = Imu(clock=Clock(jitter=0.0024)).record(rest().sample(T), seed_of(rng))
    error = recorded.measured.t - T
    assert np.abs(error).max() <= 0.0024 + 1e-15
    assert np.diff(recorded.measured.t).min() > 0.0
    # 2000 stamps: 1 % of the deviation jitter / sqrt(3).
    np.testing.assert_allclose(error.std(), 0.0024 / np.sqrt(3.0), rtol=0.06)


def test_lost_samples_are_rows_of_nan_and_leave_the_others_alone(rng: np.random.Generator) -> None:
    motion, seed = lissajous().sample(T), seed_of(rng)
    noise = {"gyro_effects": [WhiteNoise(density=0.01)], "environment": SURROUNDINGS}
    whole = Imu(**noise).record(motion, seed).measured
    recorded = Imu(**noise, clock=Clock(loss=0.2)).record(motion, seed)
    lost = np.isnan(recorded.measured.gyro[:, 0])
    # 2000 samples: 0.009 standard deviation.
    assert lost.mean() == pytest.approx(0.2, abs=0.045)
    for sensor in ("gyro", "accel", "mag_uT"):
        read = getattr(recorded.measured, sensor)
        assert np.isnan(read[lost]).all()
        np.testing.assert_array_equal(read[~lost], getattr(whole, sensor)[~lost])


def test_a_slow_magnetometer_has_rows_of_nan_and_noise_of_its_own_rate(rng: np.random.Generator) -> None:
    clock = Clock(mag=Sampling(rate=20.0))
    imu = Imu(mag_effects=[WhiteNoise(density=0.5)], environment=SURROUNDINGS, clock=clock)
    recorded = imu.record(rest().sample(T), seed_of(rng))
    there = ~np.isnan(recorded.measured.mag_uT[:, 0])
    np.testing.assert_array_equal(np.flatnonzero(there), np.arange(0, 2000, 10))
    noise = recorded.errors("mag_uT")["white_noise"]
    np.testing.assert_array_equal(np.isnan(noise[:, 1]), ~there)
    # 600 numbers: 3 %.
    np.testing.assert_allclose(noise[there].std(), 0.5 * np.sqrt(20.0), rtol=0.15)
    assert not np.isnan(recorded.measured.gyro).any()


def test_a_rate_that_is_no_whole_part_of_the_other(rng: np.random.Generator) -> None:
    rows = Sampling(rate=30.0).rows(T)
    assert rows[0] == 0
    assert len(rows) == 300
    np.testing.assert_array_equal(Sampling(rate=1e5).rows(T), np.arange(2000))


def delay_error(t: np.ndarray) -> float:
    """By how much a delayed accelerometer differs from one on a body that was sampled that much earlier."""
    path, sampling = lissajous(frequency=0.3), Sampling(latency=0.035 / 3.0)
    recorded = Imu(clock=Clock(accel=sampling)).record(path.sample(t), 1)
    np.testing.assert_array_equal(recorded.measured.gyro, recorded.ideal.gyro)
    earlier = Imu().ideal(path.sample(t - sampling.latency)).accel
    return float(np.abs(recorded.measured.accel - earlier)[20:].max())


def test_latency_delays_one_sensor_with_an_error_of_fourth_order() -> None:
    coarse, fine = (delay_error(3.0 + np.arange(int(5 * rate)) / rate) for rate in (200.0, 400.0))
    assert coarse < 1e-5
    # A third of a step from a sample at both rates: 16, but for the next order.
    assert 10.0 < coarse / fine < 25.0


def test_before_the_motion_began_the_first_reading_holds() -> None:
    recorded = Imu(clock=Clock(gyro=Sampling(latency=0.02))).record(lissajous().sample(T), 1)
    np.testing.assert_array_equal(recorded.measured.gyro[:5], np.tile(recorded.ideal.gyro[0], (5, 1)))


def test_a_window_collects() -> None:
    """The change of velocity over the window, by its length: a car at rest in heading feels just that."""
    window = 0.1
    level = FunctionTrajectory(lambda t: (np.sin(1.2 * t), np.cos(0.7 * t), 0.0 * t), (0.0, 0.0, 0.0))
    recorded = Imu(clock=Clock(accel=Sampling(window=window))).record(level.sample(T), 1)
    gained = level.sample(T).v_NB - level.sample(T - window).v_NB + [0.0, 0.0, STANDARD_GRAVITY * window]
    # Cubic between samples 5 ms apart: h^4 of a fourth derivative of 3.
    np.testing.assert_allclose(recorded.measured.accel[25:], gained[25:] / window, atol=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Sampling(rate=0.0), "rate must be positive, Hz; got 0.0"),
        (lambda: Sampling(rate=float("nan")), "rate must be positive, Hz"),
        (lambda: Sampling(latency=-1e-3), "latency must be one number, 0 or more, s; got -0.001"),
        (lambda: Sampling(window=-1.0), "window must be one number, 0 or more, s"),
        (lambda: Clock(jitter=-1.0), "jitter must be one number, 0 or more, s"),
        (lambda: Clock(loss=1.5), "loss must be one number, from 0 to 1, probability; got 1.5"),
        (lambda: Clock(rate_offset=50.0), "rate_offset must be one number, from -0.5 to 0.5, relative"),
        (
            lambda: Imu(clock=Clock(jitter=0.003)).record(rest().sample(T), 1),
            "half the shortest step, 0.0025 s",
        ),
        (
            lambda: Imu(clock=Clock(gyro=Sampling(window=0.1))).record(rest().sample(T[:3]), 1),
            "four samples or more; got 3",
        ),
    ],
)
def test_bad_parameters(make, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()
