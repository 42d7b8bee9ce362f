"""Imu.record_increments: what a unit that adds up inside delivers with its errors, and what is known of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from kreisel import discovery
from kreisel.data.environment import Environment
from kreisel.data.motion import Mount
from kreisel.estimate.strapdown import integrate
from kreisel.evaluate.allan import allan
from kreisel.maths.rotations import log_so3
from kreisel.simulate.clock import Clock, Sampling
from kreisel.simulate.effects.bias_random_walk import BiasRandomWalk
from kreisel.simulate.effects.gauss_markov import GaussMarkov
from kreisel.simulate.effects.increment_quantisation import IncrementQuantisation
from kreisel.simulate.effects.quantisation import Quantisation
from kreisel.simulate.effects.scale_factor import ScaleFactor
from kreisel.simulate.effects.turn_on_bias import TurnOnBias
from kreisel.simulate.effects.vibration_lines import VibrationLines
from kreisel.simulate.effects.white_noise import WhiteNoise
from kreisel.simulate.imu import Imu
from kreisel.simulate.recorded import Recorded
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.trajectories.rest import rest

MOTION = lissajous(frequency=0.3).sample(np.arange(6001) / 200.0)
MOUNT = Mount(p_BS=[0.1, -0.05, 0.02])
GYRO = [
    ScaleFactor(error=0.01),
    TurnOnBias(sigma=0.01),
    BiasRandomWalk(density=1e-3),
    WhiteNoise(density=1e-3),
]
ACCEL = [GaussMarkov(sigma=0.05, time_constant=3.0), WhiteNoise(density=2e-3)]
BOTH: dict[str, Any] = {"gyro_effects": GYRO, "accel_effects": ACCEL}
SENSORS = ("dtheta", "dv")


def seed_of(rng: np.random.Generator) -> int:
    return int(rng.integers(2**62))


def bits(recorded: Recorded) -> list[bytes]:
    read = recorded.measured
    errors = [error for sensor in SENSORS for error in recorded.errors(sensor).values()]
    columns = (read.t, read.dtheta, read.dv, recorded.gyro_bias, recorded.accel_bias, *errors)
    return [np.asarray(column).tobytes() for column in columns]


def test_without_errors_it_delivers_the_ideal_to_the_bit(rng: np.random.Generator) -> None:
    """All plug-ins at zero, on every sensor that takes them."""
    folder = "kreisel.simulate.effects"
    zeros = [discovery.load(folder, name).zero() for name in discovery.names(folder)]
    imu = Imu(MOUNT, gyro_effects=zeros, accel_effects=zeros)
    recorded, ideal = imu.record_increments(MOTION, seed_of(rng)), imu.increments(MOTION)
    for name in ("t", *SENSORS, "dp"):
        assert getattr(recorded.measured, name).tobytes() == getattr(ideal, name).tobytes()
    assert not any(error.any() for name in SENSORS for error in recorded.errors(name).values())


def test_same_seed_same_bits(rng: np.random.Generator) -> None:
    seed, imu = seed_of(rng), Imu(MOUNT, **BOTH, clock=Clock(jitter=1e-3, loss=0.1))
    assert bits(imu.record_increments(MOTION, seed)) == bits(imu.record_increments(MOTION, seed))
    recorded = imu.record_increments(MOTION, np.random.default_rng(seed))
    assert bits(imu.record_increments(MOTION, recorded.seed)) == bits(recorded)
    assert bits(imu.record_increments(MOTION, seed, run=1)) != bits(imu.record_increments(MOTION, seed))


def test_a_longer_record_begins_with_the_shorter(rng: np.random.Generator) -> None:
    """Longer than a block of 8192 as well."""
    motion, seed, imu = rest().sample(np.arange(20_000) / 200.0), seed_of(rng), Imu(**BOTH)
    short = imu.record_increments(motion.rows(slice(0, 4500)), seed).measured
    whole = imu.record_increments(motion, seed).measured
    for name in SENSORS:
        np.testing.assert_array_equal(getattr(short, name), getattr(whole, name)[:4499])


@pytest.mark.parametrize("dropped", range(len(GYRO)))
def test_switching_one_effect_off_leaves_the_others_alone(dropped: int, rng: np.random.Generator) -> None:
    seed, kept = seed_of(rng), GYRO[:dropped] + GYRO[dropped + 1 :]
    with_all = Imu(**BOTH).record_increments(MOTION, seed)
    without = Imu(gyro_effects=kept, accel_effects=ACCEL).record_increments(MOTION, seed)
    for effect in kept:
        # Differences of increments of 0.03 rad, rounded; the scale acts on other readings, one per cent of which vary.
        scale = 1e-3 * np.abs(with_all.measured.dtheta).max() if effect.name == "scale_factor" else 0.0
        np.testing.assert_allclose(
            without.errors("dtheta")[effect.name],
            with_all.errors("dtheta")[effect.name],
            rtol=0.0,
            atol=1e-16 + scale,
        )
    np.testing.assert_array_equal(without.measured.dv, with_all.measured.dv)


def test_ideal_and_errors_add_up_to_what_is_delivered(rng: np.random.Generator) -> None:
    recorded = Imu(MOUNT, **BOTH).record_increments(MOTION, seed_of(rng))
    for name in SENSORS:
        total = getattr(recorded.ideal, name) + sum(recorded.errors(name).values())
        # A handful of roundings of 0.1 rad and m/s at most.
        np.testing.assert_allclose(getattr(recorded.measured, name), total, rtol=0.0, atol=1e-15)


def test_it_is_the_same_unit_that_record_reads(rng: np.random.Generator) -> None:
    """What is drawn once per run is common, and the bias is a rate in both."""
    imu, seed = Imu(gyro_effects=[TurnOnBias(sigma=0.01), WhiteNoise(1e-3)]), seed_of(rng)
    sums, rates = imu.record_increments(MOTION, seed), imu.record(MOTION, seed)
    # Differences of rates of 10 rad/s, rounded.
    np.testing.assert_allclose(sums.gyro_bias, rates.gyro_bias[1:], rtol=0.0, atol=1e-14)


def test_white_noise_adds_up_to_a_random_walk_at_any_step(rng: np.random.Generator) -> None:
    """Density N: the angle varies by N^2 dt over an interval, whatever its length."""
    density, t = 2e-3, np.cumsum(rng.uniform(1e-4, 1e-2, 40_001))
    imu = Imu(gyro_effects=[WhiteNoise(density)], accel_effects=[WhiteNoise(density)])
    recorded, dt = imu.record_increments(rest().sample(t), seed_of(rng)), np.diff(t)[:, None]
    for name in SENSORS:
        error = getattr(recorded.measured, name) - getattr(recorded.ideal, name)
        # 120 000 normals: 0.2 % standard deviation of theirs; five of them.
        np.testing.assert_allclose(np.std(error / np.sqrt(dt)), density, rtol=0.01)
        # Short and long intervals alike: 0.3 % on half as many.
        short = dt[:, 0] < np.median(dt)
        np.testing.assert_allclose(np.std(error[short] / np.sqrt(dt[short])), density, rtol=0.015)


def test_allan_deviation_of_the_mean_rates_has_n_and_k(rng: np.random.Generator) -> None:
    N, K = 1e-3, 3e-4
    effects = [WhiteNoise(N), BiasRandomWalk(K)]
    motion = rest().sample(np.arange(60_001) / 50.0)
    measured = (
        Imu(gyro_effects=effects, accel_effects=effects).record_increments(motion, seed_of(rng)).measured
    )
    for sensor in ("gyro", "accel"):
        fit = allan(measured.mean_rates(), sensor)
        for term, expected in ((fit.N, N), (fit.K, K)):
            half = 0.5 * np.log(term.high / term.low)
            # 95 % are two standard deviations: six of twelve coefficients are five in 10^8.
            assert (np.abs(np.log(term.value / expected)) < 3.0 * half).all()


def test_angle_random_walk_is_in_the_attitude(rng: np.random.Generator) -> None:
    N, seconds, seed = 5e-4, 20.0, seed_of(rng)
    motion = rest(phi=(0.1, -0.2, 0.7)).sample(np.arange(401) / 20.0)
    imu = Imu(gyro_effects=[WhiteNoise(N)])
    ends = [
        integrate(imu.record_increments(motion, seed, run).measured, motion).R_NB[-1] for run in range(64)
    ]
    walked = log_so3(np.stack(ends) @ motion.R_NB[-1].T)
    # 192 angles: 5 % standard deviation of theirs; four of them.
    np.testing.assert_allclose(np.sqrt(np.mean(walked**2)), N * np.sqrt(seconds), rtol=0.2)


@pytest.mark.parametrize(
    ("cycles", "left"), [(1.0, 0.0), (2.0, 0.0), (0.5, 2.0 / np.pi), (1.5, 2.0 / (3.0 * np.pi))]
)
def test_vibration_is_averaged_over_the_interval(
    cycles: float, left: float, rng: np.random.Generator
) -> None:
    """`cycles` in an interval: whole ones leave nothing, where a sampled sensor sees a constant."""
    rate, amplitude = 100.0, 0.5
    lines = VibrationLines([cycles * rate], [[amplitude] * 3])
    motion, seed = rest().sample(np.arange(1000) / rate), seed_of(rng)
    recorded = Imu(accel_effects=[lines]).record_increments(motion, seed)
    means = (recorded.measured.dv - recorded.ideal.dv) * rate
    if left:
        # The phase is drawn: at half a cycle every mean is +-, so that extremes show it as a factor below one.
        phases = [Imu(accel_effects=[lines]).record_increments(motion, seed, run) for run in range(12)]
        seen = [np.abs(each.measured.dv - each.ideal.dv).max(axis=0) * rate for each in phases]
        assert np.max(seen) <= left * amplitude * (1.0 + 1e-9)
        # The best of 12 random phases comes within 10 % of the crest, but for one seed in 10^4.
        assert np.max(seen) > 0.85 * left * amplitude
    else:
        # Round-off of gravity, 10 m/s^2.
        assert np.abs(means).max() < 1e-11


def test_pulses_lose_nothing_where_rounded_rates_walk_away(rng: np.random.Generator) -> None:
    step, rate = 1e-5, 200.0
    pulses = Imu(gyro_effects=[IncrementQuantisation(step)]).record_increments(MOTION, seed_of(rng))
    whole = pulses.measured.dtheta / step
    np.testing.assert_allclose(whole, np.rint(whole), atol=1e-9)
    astray = np.cumsum(pulses.measured.dtheta - pulses.ideal.dtheta, axis=0)
    # Half a pulse, and round-off of 6000 sums.
    assert np.abs(astray).max() <= 0.5 * step * (1.0 + 1e-6)
    assert np.abs(astray).max() > 0.4 * step
    rounded = Imu(gyro_effects=[Quantisation(step * rate)]).record_increments(MOTION, seed_of(rng))
    # A walk of 6000 errors of step / sqrt(12): 22 steps; a path that repeats itself makes it no smaller than a tenth.
    assert np.abs(np.cumsum(rounded.measured.dtheta - rounded.ideal.dtheta, axis=0)).max() > 2.0 * step


def test_quantisation_noise_falls_with_the_averaging_time() -> None:
    """sqrt(3) Q / tau with Q = step / sqrt(12), as IEEE 952 has it."""
    step, rate = 1e-5, 200.0
    error = (
        Imu(gyro_effects=[IncrementQuantisation(step)])
        .record(MOTION, 1)
        .errors("gyro")["increment_quantisation"]
    )
    angle = np.concatenate([np.zeros((1, 3)), np.cumsum(error, axis=0)]) / rate
    for m in (4, 16, 64):
        second = angle[2 * m :] - 2.0 * angle[m:-m] + angle[: -2 * m]
        deviation = np.sqrt(0.5 * np.mean(second**2)) * rate / m
        # 280 independent spans of the longest, and remainders that are not quite independent.
        np.testing.assert_allclose(deviation, np.sqrt(3.0) * step / np.sqrt(12.0) * rate / m, rtol=0.15)


def test_with_an_error_there_is_no_dp_and_none_is_missed(rng: np.random.Generator) -> None:
    imu = Imu(MOUNT, **BOTH)
    recorded, truth = imu.record_increments(MOTION, seed_of(rng)), MOTION.at(MOUNT)
    assert recorded.measured.dp is None and recorded.ideal.dp is not None
    dt = np.diff(MOTION.t)[:, None]
    carried = recorded.ideal.dp + 0.5 * dt * (recorded.measured.dv - recorded.ideal.dv)
    bare, with_dp = (
        integrate(read, truth).p_NB for read in (recorded.measured, replace(recorded.measured, dp=carried))
    )
    drift = np.abs(bare - truth.p_NB).max()
    # One sample of 0.03 m/s noise, 17 times amplified at the ends, over 5 ms, against metres of drift.
    assert np.abs(bare - with_dp).max() < 1e-4 * drift


def test_the_clock_stamps_jitters_and_loses_intervals(rng: np.random.Generator) -> None:
    clock = Clock(offset=2.0, jitter=1e-4, loss=0.2)
    recorded = Imu(**BOTH, clock=clock).record_increments(MOTION, seed_of(rng))
    lost = np.isnan(recorded.measured.dtheta)
    np.testing.assert_array_equal(lost, np.isnan(recorded.measured.dv))
    # 6000 intervals: 0.5 % standard deviation.
    np.testing.assert_allclose(lost.mean(), 0.2, atol=0.03)
    assert np.abs(recorded.measured.t - MOTION.t - 2.0).max() <= 1e-4 * (1 + 1e-9)
    np.testing.assert_array_equal(recorded.ideal.t, MOTION.t)


def test_a_magnetometer_adds_nothing_up(rng: np.random.Generator) -> None:
    field = Environment(field_N_uT=[1.0, 20.0, -44.0])
    listening = Imu(**BOTH, mag_effects=[WhiteNoise(0.1)], environment=field, clock=Clock(mag=Sampling(20.0)))
    seed = seed_of(rng)
    assert bits(listening.record_increments(MOTION, seed)) == bits(
        Imu(**BOTH).record_increments(MOTION, seed)
    )


@pytest.mark.parametrize("sensor", ["gyro", "accel"])
def test_what_no_increments_can_have_is_refused(sensor: str) -> None:
    imu = Imu(clock=Clock(**{sensor: Sampling(rate=50.0)}))
    with pytest.raises(ValueError, match=rf"rate, latency and window of clock\.{sensor} do not apply"):
        imu.record_increments(MOTION, 1)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: Imu().record_increments(MOTION.rows(slice(0, 1)), 1), ValueError, "two samples or more"),
        (lambda: Imu().record_increments(MOTION, 1, run=-1), ValueError, "run must be a whole number"),
        (lambda: Imu().record_increments(MOTION, None), TypeError, "rng must be a seed"),
        (
            lambda: Imu().record_increments(MOTION, 1).errors("gyro"),
            ValueError,
            "one of 'dtheta', 'dv'; got 'gyro'",
        ),
        (lambda: IncrementQuantisation(-1.0), ValueError, "step must be"),
    ],
)
def test_bad_input(make, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        make()
