"""Bandwidth, range and quantisation: the last stages of a sensor."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from kreisel.data.environment import STANDARD_GRAVITY, Environment
from kreisel.data.motion import Mount
from kreisel.simulate.effects.bandwidth import Bandwidth
from kreisel.simulate.effects.quantisation import Quantisation
from kreisel.simulate.effects.range import Range
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.trajectories.rest import rest
from tests.simulate.effects.recordings import at_rest


def through(effect: Bandwidth, t: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Output (n,) of the filter for input x (n,), which an accelerometer's z axis is made to read."""
    from kreisel.maths.random import stream
    from kreisel.simulate.clock import steps
    from kreisel.simulate.context import Context

    block, motion = np.tile(x[:, None], 3), rest().sample(t)
    rows = slice(0, len(t))
    context = Context("accel", 0, t, steps(t), block, Environment(), Mount(), motion, rows)
    draws = stream(0, 0, "imu/accel", effect.name)
    return effect.apply(effect.start(context, draws), block, context, draws)[:, 2]


@pytest.mark.parametrize("damping", [0.1, 0.5**0.5, 0.9])
def test_a_ramp_comes_out_late_by_the_group_delay(damping: float) -> None:
    effect, t = Bandwidth(cutoff=5.0, damping=damping), np.arange(2000) / 100.0
    out = through(effect, t, 3.0 + 2.0 * t)
    assert effect.group_delay == pytest.approx(2.0 * damping / (2.0 * np.pi * 5.0))
    # After ten seconds the transient has died: exp(-0.1 * 2 pi 5 * 10) = 2e-14.
    np.testing.assert_allclose(out[1000:], 3.0 + 2.0 * (t[1000:] - effect.group_delay), rtol=1e-12)


def test_the_gain_at_the_cutoff_is_minus_3_db() -> None:
    t = np.arange(8000) / 2000.0
    out = through(Bandwidth(cutoff=10.0), t, np.sin(2.0 * np.pi * 10.0 * t))
    # First-order hold at 200 samples a period: (2 pi / 200)^2 / 12.
    np.testing.assert_allclose(np.sqrt(2.0 * np.mean(out[4000:] ** 2)), np.sqrt(0.5), rtol=2e-4)


@pytest.mark.parametrize("cutoff", [0.01, 3.0, 400.0])
def test_it_is_exact_for_straight_pieces(cutoff: float, rng: np.random.Generator) -> None:
    """SciPy's lsim exponentiates the matrix of system and first-order hold, step by step."""
    t, x, w, d = np.arange(400) / 200.0, rng.normal(size=400), 2.0 * np.pi * cutoff, 0.6
    system = signal.StateSpace([[0.0, 1.0], [-w * w, -2.0 * d * w]], [[0.0], [w * w]], [[1.0, 0.0]], [[0.0]])
    _, expected, _ = signal.lsim(system, x, t, X0=[x[0], 0.0])
    out = through(Bandwidth(cutoff=cutoff, damping=d), t, x)
    np.testing.assert_allclose(out, expected, atol=1e-9)


def test_uneven_steps_give_what_even_ones_give() -> None:
    """A straight input with one kink, sampled at different times that all have the kink among them."""
    effect, t = Bandwidth(cutoff=2.0), np.arange(401) / 100.0
    some = np.sort(np.concatenate([np.array([0.0, 1.0]), t[[3, 4, 50, 120, 121, 300, 400]]]))
    np.testing.assert_allclose(
        through(effect, some, np.minimum(some, 1.0)),
        through(effect, t, np.minimum(t, 1.0))[np.searchsorted(t, some)],
        atol=1e-13,
    )


def test_at_rest_it_reads_true_from_the_first_sample() -> None:
    recorded = at_rest(Bandwidth(cutoff=1.0), np.arange(50) / 100.0, 1, "accel")
    np.testing.assert_allclose(recorded.measured.accel, recorded.ideal.accel, rtol=1e-14)


def test_a_range_ends() -> None:
    motion = lissajous(frequency=2.0).sample(np.arange(500) / 200.0)
    recorded = Imu(gyro_effects=[Range(limit=(0.5, np.inf, 9.0))]).record(motion, 1)
    ideal, read = recorded.ideal.gyro, recorded.measured.gyro
    np.testing.assert_array_equal(read, np.clip(ideal, [-0.5, -np.inf, -9.0], [0.5, np.inf, 9.0]))
    assert (np.abs(ideal[:, 0]) > 0.5).any() and (np.abs(ideal[:, 2]) > 9.0).any()


def test_a_range_that_could_not_show_gravity_is_refused() -> None:
    with pytest.raises(
        ValueError, match=r"below gravity, 9\.80665 m/s\^2; got \[8\. 8\. 8\.\] m/s\^2, which is 0\.816 g"
    ):
        at_rest(Range(limit=8.0), np.arange(5) / 10.0, 1, "accel")
    at_rest(Range(limit=8.0), np.arange(5) / 10.0, 1, "gyro")
    at_rest(Range(limit=STANDARD_GRAVITY), np.arange(5) / 10.0, 1, "accel")


def test_readings_are_multiples_of_the_step() -> None:
    motion = lissajous().sample(np.arange(500) / 200.0)
    recorded = Imu(gyro_effects=[Quantisation(step=(0.125, 0.0, 0.01))]).record(motion, 1)
    ideal, read = recorded.ideal.gyro, recorded.measured.gyro
    np.testing.assert_array_equal(read[:, 0] % 0.125, 0.0)
    np.testing.assert_array_equal(read[:, 1], ideal[:, 1])
    assert np.abs(read - ideal)[:, [0, 2]].max(axis=0) == pytest.approx([0.0625, 0.005], rel=0.05)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Range(limit=0.0), "limit must be positive, unit of the sensor"),
        (lambda: Range(limit=-3.0), "limit must be 0 or more, unit of the sensor"),
        (lambda: Quantisation(step=-1.0), "step must be 0 or more, unit of the sensor"),
        (lambda: Bandwidth(cutoff=0.0), "cutoff must be .*Hz"),
        (lambda: Bandwidth(cutoff=10.0, damping=1.0), "damping must be one number, from 0.001 to 0.999"),
    ],
)
def test_bad_parameters(make, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()
