"""What every effect promises, asked of each one that discovery finds."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from types import ModuleType

import numpy as np
import pytest

from kreisel import discovery
from kreisel.data.environment import Environment
from kreisel.data.motion import Motion, Mount
from kreisel.data.temperature import TemperatureHistory
from kreisel.maths.random import stream
from kreisel.simulate.chain import Sensed, sense
from kreisel.simulate.clock import steps
from kreisel.simulate.context import Context
from kreisel.simulate.effects import Effect
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.trajectories.rest import rest

PACKAGE = "kreisel.simulate.effects"
EFFECTS = discovery.names(PACKAGE)
NOISES = [name for name in EFFECTS if hasattr(discovery.load(PACKAGE, name).example(), "allan_deviation")]
SURROUNDINGS = Environment(field_N_uT=np.array([1.0, 20.0, -44.0]))
WARMING = TemperatureHistory(np.array([0.0, 10_000.0]), np.array([15.0, 400.0]))


@pytest.fixture(params=EFFECTS)
def plugin(request: pytest.FixtureRequest) -> ModuleType:
    return discovery.load(PACKAGE, request.param)


def contexts(sensor: str, motion: Motion, size: int) -> Iterator[Context]:
    force = Imu(environment=SURROUNDINGS).ideal(motion).accel
    dt = steps(motion.t)
    for first in range(0, len(motion), size):
        rows = slice(first, min(first + size, len(motion)))
        t, surroundings = motion.t[rows], (SURROUNDINGS, Mount(), motion, rows, WARMING)
        yield Context(sensor, first, t, dt[rows], force[rows], *surroundings)


def sensor_of(effect: Effect) -> str:
    """The first sensor that the effect suits."""
    for sensor in ("gyro", "accel"):
        try:
            effect.start(next(contexts(sensor, moving(), 5)), stream(1, 0, sensor, effect.name))
        except ValueError:
            continue
        return sensor
    return "mag_uT"


def readings(sensor: str, motion: Motion) -> np.ndarray:
    return getattr(Imu(environment=SURROUNDINGS).ideal(motion), sensor)


def run(effect: Effect, motion: Motion, seed: int, size: int = 4096) -> Sensed:
    sensor = sensor_of(effect)
    blocks = contexts(sensor, motion, size)
    return sense([effect], readings(sensor, motion), blocks, partial(stream, seed, 0, sensor))


def error_of(effect: Effect, motion: Motion, seed: int) -> np.ndarray:
    sensor, errors = sensor_of(effect), {effect.name: np.zeros((len(motion), 3))}
    blocks = contexts(sensor, motion, 4096)
    sense([effect], readings(sensor, motion), blocks, partial(stream, seed, 0, sensor), errors)
    return errors[effect.name]


def moving(rate: float = 100.0, count: int = 1000) -> Motion:
    return lissajous(frequency=0.3).sample(np.arange(count) / rate)


def seed_of(rng: np.random.Generator) -> int:
    return int(rng.integers(2**63))


def test_it_goes_by_the_name_of_its_file(plugin: ModuleType) -> None:
    assert plugin.example().name == plugin.zero().name == plugin.__name__.rsplit(".", 1)[1]


def test_zero_is_the_identity(plugin: ModuleType, rng: np.random.Generator) -> None:
    effect, motion = plugin.zero(), moving()
    assert effect.idle
    sensor = sensor_of(effect)
    context, block = next(contexts(sensor, motion, len(motion))), readings(sensor, motion)
    draws = stream(seed_of(rng), 0, sensor, effect.name)
    np.testing.assert_array_equal(effect.apply(effect.start(context, draws), block, context, draws), block)
    assert run(effect, motion, seed_of(rng)).reading.tobytes() == block.tobytes()


def test_an_example_changes_something(plugin: ModuleType, rng: np.random.Generator) -> None:
    effect, motion = plugin.example(), moving()
    assert not effect.idle
    # At the readings of the other tests the range of the example would cut nothing off.
    harder = lissajous(frequency=2.0).sample(motion.t)
    assert error_of(effect, harder, seed_of(rng)).any()


def test_same_seed_same_bits(plugin: ModuleType, rng: np.random.Generator) -> None:
    seed, motion = seed_of(rng), moving()
    first, second = (run(plugin.example(), motion, seed).reading for _ in range(2))
    assert first.tobytes() == second.tobytes()


@pytest.mark.parametrize("size", [1, 10, 333])
def test_blocks_give_the_bits_of_the_whole(plugin: ModuleType, size: int, rng: np.random.Generator) -> None:
    seed, t = seed_of(rng), np.cumsum(rng.uniform(0.005, 0.015, 1000))
    motion = lissajous(frequency=0.3).sample(t)
    whole, parts = (run(plugin.example(), motion, seed, n).reading for n in (1000, size))
    assert whole.tobytes() == parts.tobytes()


def test_the_error_is_the_difference(plugin: ModuleType, rng: np.random.Generator) -> None:
    effect, motion, seed = plugin.example(), moving(), seed_of(rng)
    sensed, error = run(effect, motion, seed), error_of(effect, motion, seed)
    ideal = readings(sensor_of(effect), motion)
    np.testing.assert_array_equal(error, sensed.reading - ideal)
    np.testing.assert_array_equal(sensed.bias, error if effect.is_bias else 0.0)


def test_inputs_are_left_as_they_are(plugin: ModuleType, rng: np.random.Generator) -> None:
    effect, motion = plugin.example(), moving()
    sensor = sensor_of(effect)
    context = next(contexts(sensor, motion, len(motion)))
    block = np.array(readings(sensor, motion))
    before = [x.tobytes() for x in (block, context.t, context.dt, context.specific_force)]
    draws = stream(seed_of(rng), 0, sensor, effect.name)
    effect.apply(effect.start(context, draws), block, context, draws)
    assert [x.tobytes() for x in (block, context.t, context.dt, context.specific_force)] == before


@pytest.mark.parametrize("plugin", sorted(set(EFFECTS) - set(NOISES)), indirect=True)
def test_what_is_no_noise_does_not_depend_on_the_rate(plugin: ModuleType, rng: np.random.Generator) -> None:
    effect, seed = plugin.example(), seed_of(rng)
    slow = run(effect, moving(200.0, 2000), seed).reading
    fast = run(effect, moving(400.0, 4000), seed).reading[::2]
    # Exact but for the low-pass, whose input runs straight between samples: (2 pi 0.9 Hz / 200 Hz)^2 / 8.
    np.testing.assert_allclose(slow, fast, rtol=0.0, atol=2e-4 * np.abs(slow).max())


@pytest.mark.parametrize("rate", [25.0, 100.0])
@pytest.mark.parametrize("plugin", NOISES, indirect=True)
def test_allan_deviation_is_the_one_promised(
    plugin: ModuleType, rate: float, rng: np.random.Generator
) -> None:
    """At averaging times of many samples, and a few hundred times shorter than the recording."""
    effect = plugin.example()
    motion = rest().sample(np.arange(int(3000 * rate)) / rate)
    error = error_of(effect, motion, seed_of(rng))
    tau = np.array([0.4, 1.6, 6.4])
    measured = np.array([overlapping_allan(error, round(each * rate), 1.0 / rate) for each in tau])
    expected = np.sqrt((effect.allan_deviation(tau) ** 2).mean(axis=1))
    # Three axes of 470 spans of the longest tau: 2 % standard deviation; samples are no averages: 1 % at 10 a span.
    np.testing.assert_allclose(measured, expected, rtol=0.12, atol=1e-15)


def overlapping_allan(x: np.ndarray, m: int, dt: float) -> float:
    """Overlapping Allan deviation over spans of m samples, all axes taken together. Source: IEEE Std 952."""
    theta = np.concatenate([np.zeros((1, 3)), np.cumsum(x - x.mean(axis=0), axis=0)]) * dt
    second = theta[2 * m :] - 2.0 * theta[m:-m] + theta[: -2 * m]
    return float(np.sqrt(0.5 * np.mean(second**2)) / (m * dt))
