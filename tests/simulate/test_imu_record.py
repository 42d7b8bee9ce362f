"""What an imperfect IMU records, and what it says about how that came to be."""

from __future__ import annotations

import tracemalloc
from typing import Any

import numpy as np
import pytest

from kreisel import DcmFilter, allan, calibrate_mag, discovery, integrate, run
from kreisel.data.environment import Environment
from kreisel.data.motion import Mount
from kreisel.data.temperature import TemperatureHistory
from kreisel.simulate.clock import Clock, Sampling
from kreisel.simulate.effects.bias_random_walk import BiasRandomWalk
from kreisel.simulate.effects.gauss_markov import GaussMarkov
from kreisel.simulate.effects.scale_factor import ScaleFactor
from kreisel.simulate.effects.turn_on_bias import TurnOnBias
from kreisel.simulate.effects.white_noise import WhiteNoise
from kreisel.simulate.imu import Imu
from kreisel.simulate.recorded import Recorded
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.trajectories.rest import rest

MOTION = lissajous(frequency=0.3).sample(np.arange(6000) / 200.0)
SURROUNDINGS = Environment(field_N_uT=np.array([1.0, 20.0, -44.0]))
GYRO = [
    ScaleFactor(error=0.01),
    TurnOnBias(sigma=0.01),
    BiasRandomWalk(density=1e-3),
    WhiteNoise(density=1e-3),
]
ACCEL = [GaussMarkov(sigma=0.05, time_constant=3.0), WhiteNoise(density=2e-3)]
MAG = [TurnOnBias(sigma=1.0), WhiteNoise(density=0.1)]
SENSORS = ("gyro", "accel", "mag_uT")
ALL: dict[str, Any] = {"gyro_effects": GYRO, "accel_effects": ACCEL, "mag_effects": MAG}


def seed_of(rng: np.random.Generator) -> int:
    return int(rng.integers(2**62))


def bits(recorded: Recorded) -> list[bytes]:
    read = recorded.measured
    errors = [error for sensor in SENSORS for error in recorded.errors(sensor).values()]
    columns = (read.t, read.gyro, read.accel, read.mag_uT, recorded.gyro_bias, recorded.accel_bias, *errors)
    return [np.asarray(column).tobytes() for column in columns]


def test_without_errors_it_reads_the_ideal_to_the_bit(rng: np.random.Generator) -> None:
    """All plug-ins at zero, on every sensor that takes them."""
    zeros = [
        discovery.load("kreisel.simulate.effects", name).zero()
        for name in discovery.names("kreisel.simulate.effects")
    ]
    imu = Imu(gyro_effects=zeros, accel_effects=zeros, mag_effects=zeros, environment=SURROUNDINGS)
    recorded, ideal = imu.record(MOTION, seed_of(rng)), imu.ideal(MOTION)
    for sensor in SENSORS:
        assert getattr(recorded.measured, sensor).tobytes() == getattr(ideal, sensor).tobytes()
        assert not any(error.any() for error in recorded.errors(sensor).values())
    assert not recorded.gyro_bias.any() and not recorded.accel_bias.any()


def test_same_seed_same_bits(rng: np.random.Generator) -> None:
    seed, imu = seed_of(rng), Imu(**ALL, environment=SURROUNDINGS, clock=Clock(jitter=1e-3, loss=0.1))
    assert bits(imu.record(MOTION, seed)) == bits(imu.record(MOTION, seed))
    recorded = imu.record(MOTION, np.random.default_rng(seed))
    assert bits(imu.record(MOTION, recorded.seed)) == bits(recorded)


def test_a_generator_gives_one_draw(rng: np.random.Generator) -> None:
    used, other = (np.random.default_rng(5) for _ in range(2))
    Imu(**ALL, environment=SURROUNDINGS).record(MOTION, used)
    other.integers(2**63)
    assert used.bit_generator.state == other.bit_generator.state


def test_a_longer_recording_begins_with_the_shorter(rng: np.random.Generator) -> None:
    seed, imu = seed_of(rng), Imu(**ALL, environment=SURROUNDINGS)
    short = imu.record(MOTION.rows(slice(0, 4500)), seed)
    for sensor in SENSORS:
        whole = getattr(imu.record(MOTION, seed).measured, sensor)
        np.testing.assert_array_equal(getattr(short.measured, sensor), whole[:4500])


@pytest.mark.parametrize("dropped", range(len(GYRO)))
def test_switching_one_effect_off_leaves_the_draws_of_the_others_alone(
    dropped: int, rng: np.random.Generator
) -> None:
    seed = seed_of(rng)
    kept = GYRO[:dropped] + GYRO[dropped + 1 :]
    with_all = Imu(**ALL, environment=SURROUNDINGS).record(MOTION, seed)
    without = Imu(gyro_effects=kept, accel_effects=ACCEL, mag_effects=MAG, environment=SURROUNDINGS).record(
        MOTION, seed
    )
    for effect in kept:
        # Errors are differences of readings of a few rad/s: round-off, where scale acts on other readings.
        scale = 0.01 * np.abs(with_all.measured.gyro).max() if effect.name == "scale_factor" else 0.0
        np.testing.assert_allclose(
            without.errors("gyro")[effect.name],
            with_all.errors("gyro")[effect.name],
            atol=1e-14 + scale * 1e-12,
        )
    np.testing.assert_array_equal(without.measured.accel, with_all.measured.accel)


def test_order_does_not_matter_to_the_draws(rng: np.random.Generator) -> None:
    seed = seed_of(rng)
    ahead, behind = (
        Imu(accel_effects=effects).record(MOTION, seed).errors("accel")["white_noise"]
        for effects in (ACCEL, ACCEL[::-1])
    )
    np.testing.assert_allclose(ahead, behind, atol=1e-14)


def test_ideal_and_errors_add_up_to_what_was_measured(rng: np.random.Generator) -> None:
    recorded = Imu(**ALL, environment=SURROUNDINGS).record(MOTION, seed_of(rng))
    for sensor in SENSORS:
        total = getattr(recorded.ideal, sensor) + sum(recorded.errors(sensor).values())
        # A handful of roundings of 50 uT at most.
        np.testing.assert_allclose(getattr(recorded.measured, sensor), total, atol=5e-14)


def test_the_bias_is_the_sum_of_what_a_filter_may_estimate(rng: np.random.Generator) -> None:
    recorded = Imu(**ALL, environment=SURROUNDINGS).record(MOTION, seed_of(rng))
    gyro, accel = recorded.errors("gyro"), recorded.errors("accel")
    # Differences of readings of 10 rad/s, rounded.
    expected = gyro["turn_on_bias"] + gyro["bias_random_walk"]
    np.testing.assert_allclose(recorded.gyro_bias, expected, rtol=0.0, atol=1e-14)
    np.testing.assert_array_equal(recorded.accel_bias, accel["gauss_markov"])


def test_biases_with_something_between_them_add_up_too(rng: np.random.Generator) -> None:
    effects = [TurnOnBias(sigma=0.1), WhiteNoise(density=1.0), BiasRandomWalk(density=0.1)]
    recorded = Imu(gyro_effects=effects).record(MOTION, seed_of(rng))
    errors = recorded.errors("gyro")
    expected = errors["turn_on_bias"] + errors["bias_random_walk"]
    np.testing.assert_allclose(recorded.gyro_bias, expected, rtol=0.0, atol=1e-13)


def test_sensors_imus_and_runs_have_draws_of_their_own(rng: np.random.Generator) -> None:
    seed, noise = seed_of(rng), [WhiteNoise(density=1.0)]

    def made(name: str = "imu", run: int = 0) -> list[np.ndarray]:
        imu = Imu(Mount(name=name), noise, noise)
        recorded = imu.record(MOTION, seed, run)
        return [recorded.errors(sensor)["white_noise"] for sensor in ("gyro", "accel")]

    columns = np.concatenate([*made(), *made(name="wrist"), *made(run=1)], axis=1)
    correlation = np.corrcoef(columns.T)[np.triu_indices(18, 1)]
    # 6000 samples: 0.013 standard deviation of a correlation.
    assert np.abs(correlation).max() < 0.07


def test_a_reading_at_rest_is_gravity_with_a_bias(rng: np.random.Generator) -> None:
    biased = Imu(accel_effects=[TurnOnBias(fixed=(0.1, -0.2, 0.3))])
    recorded = biased.record(rest().sample(MOTION.t), seed_of(rng))
    np.testing.assert_allclose(recorded.measured.accel, [[0.1, -0.2, 9.80665 + 0.3]] * 6000, rtol=1e-15)


def size_of(recorded: Recorded) -> int:
    read = [recorded.gyro_bias, recorded.accel_bias, recorded.measured.t]
    read += [getattr(each, sensor) for each in (recorded.measured, recorded.ideal) for sensor in SENSORS]
    return sum(column.nbytes for column in read)


@pytest.mark.parametrize(
    "clock", [Clock(), Clock(mag=Sampling(rate=20.0), accel=Sampling(window=0.01), jitter=1e-4)]
)
def test_memory_above_the_output(clock: Clock, rng: np.random.Generator) -> None:
    motion = rest().sample(np.arange(100_000) / 200.0)
    imu = Imu(**ALL, environment=SURROUNDINGS, clock=clock)
    imu.record(MOTION, 1)  # compiles
    tracemalloc.start()
    recorded = imu.record(motion, seed_of(rng))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak - size_of(recorded) < 150 * len(motion)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: Imu(gyro_effects=[GYRO[3], GYRO[3]]),
            "gyro_effects has two effects called 'white_noise'.*name=",
        ),
        (lambda: Imu(mag_effects=MAG), "mag_effects need a magnetic field"),
        (lambda: Imu().record(MOTION.rows(slice(0, 1)), 1), "two samples or more.*got 1"),
        (
            lambda: Imu(temperature=TemperatureHistory([0.0, 20.0], [1.0, 2.0])).record(MOTION, 1),
            "temperature must cover the motion, from 0 to 29.995 s; it covers 0 to 20 s",
        ),
        (lambda: Imu().record(MOTION, 1, run=-1), "run must be a whole number, 0 or more; got -1"),
        (
            lambda: Imu(clock=Clock(gyro=Sampling(latency=29.0, window=1.0))).record(MOTION, 1),
            "latency and window, 30 s together, reach back beyond the whole motion of 29.995 s",
        ),
        (lambda: TemperatureHistory([0.0, 1.0], [1.0]), "temperature_degC must have one row per time stamp"),
    ],
)
def test_bad_input(make, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        # A class has an `idle` that is no False: the sensor would be a perfect one.
        (
            lambda: Imu(gyro_effects=[WhiteNoise]),
            "gyro_effects must be a list of effects.*got the class WhiteNoise",
        ),
        (lambda: Imu(accel_effects=WhiteNoise(1e-3)), "accel_effects must be a list of .*; got WhiteNoise"),
        (lambda: Imu(gyro_effects=[1e-3]), "gyro_effects must be .*got float"),
        (lambda: Imu(gyro_effects=None), "gyro_effects must be .*got NoneType"),
        (
            lambda: Imu(temperature=([0.0, 1.0], [20.0, 30.0])),
            "temperature must be of type TemperatureHistory",
        ),
        (lambda: Imu(clock=1e-4), "clock must be of type Clock"),
        (lambda: allan(Imu().record(MOTION, 1)), "recording must be .*got Recorded.*take .measured"),
        (lambda: calibrate_mag(MOTION), "recording must be .*got Motion"),
        (
            lambda: run(DcmFilter(), Imu().record(MOTION, 1)),
            "recording must be .*got Recorded.*take .measured",
        ),
        (
            lambda: integrate(Imu().record(MOTION, 1), MOTION),
            "recording must be .*got Recorded.*take .measured",
        ),
    ],
)
def test_things_of_another_kind_are_named(make, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        make()


def test_errors_of_a_sensor_that_is_not_there() -> None:
    with pytest.raises(ValueError, match="sensor must be one of 'gyro', 'accel'; got 'mag_uT'"):
        Imu().record(MOTION, 1).errors("mag_uT")


def test_two_of_a_kind_may_go_by_different_names(rng: np.random.Generator) -> None:
    effects = [
        GaussMarkov(sigma=1.0, time_constant=1.0),
        GaussMarkov(sigma=1.0, time_constant=1.0, name="slow"),
    ]
    errors = Imu(gyro_effects=effects).record(MOTION, seed_of(rng)).errors("gyro")
    assert np.abs(errors["gauss_markov"] - errors["slow"]).max() > 0.1


def test_a_seed_must_be_one() -> None:
    with pytest.raises(TypeError, match="rng must be a seed"):
        Imu().record(MOTION, None)  # type: ignore[arg-type]


def test_the_recording_says_how_large_the_white_noise_of_a_sample_is() -> None:
    imu = Imu(
        gyro_effects=[WhiteNoise(1e-3), WhiteNoise([0.0, 0.0, 1e-3], name="more"), TurnOnBias(sigma=0.01)],
        mag_effects=[WhiteNoise(0.1)],
        environment=SURROUNDINGS,
        clock=Clock(mag=Sampling(rate=20.0)),
    )
    measured = imu.record(MOTION, 1).measured
    # Per axis the root of the sum of squares, density sqrt(rate): 200 Hz, and 20 Hz for the magnetometer.
    np.testing.assert_allclose(measured.gyro_noise, 1e-3 * np.sqrt([200.0, 200.0, 400.0]), rtol=1e-9)
    np.testing.assert_allclose(measured.mag_noise_uT, 0.1 * np.sqrt(20.0), rtol=1e-9)
    assert measured.accel_noise is None
