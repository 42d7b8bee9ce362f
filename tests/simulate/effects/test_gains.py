"""Scale, misalignment, non-linearity, g-sensitivity, iron and temperature: what is wrong in the same way every time."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.data.environment import STANDARD_GRAVITY, Environment
from kreisel.data.temperature import TemperatureHistory
from kreisel.maths.rotations import exp_so3
from kreisel.simulate.effects.g_sensitivity import GSensitivity
from kreisel.simulate.effects.hard_soft_iron import HardSoftIron
from kreisel.simulate.effects.misalignment import Misalignment
from kreisel.simulate.effects.nonlinearity import Nonlinearity
from kreisel.simulate.effects.scale_factor import ScaleFactor
from kreisel.simulate.effects.temperature_bias import TemperatureBias
from kreisel.simulate.effects.temperature_scale import TemperatureScale
from kreisel.simulate.effects.vibration_lines import VibrationLines
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.trajectories.rest import rest
from tests.simulate.effects.recordings import FIELD, at_rest, error_at_rest

T = np.arange(500) / 100.0


def test_scale_multiplies() -> None:
    recorded = Imu(gyro_effects=[ScaleFactor(error=(0.01, 0.0, -0.02))]).record(lissajous().sample(T), 1)
    expected = recorded.ideal.gyro * [1.01, 1.0, 0.98]
    np.testing.assert_allclose(recorded.measured.gyro, expected, rtol=1e-15)


def test_scale_is_drawn_anew_in_every_run(rng: np.random.Generator) -> None:
    effect, motion = ScaleFactor(sigma=0.1), rest().sample(T[:2])
    seeds = int(rng.integers(2**62)) + np.arange(300)
    z = [Imu(accel_effects=[effect]).record(motion, seed).measured.accel[0, 2] for seed in seeds]
    # 300 draws: 4 %.
    np.testing.assert_allclose(np.std(z) / STANDARD_GRAVITY, 0.1, rtol=0.21)


def test_a_triad_turned_as_a_whole_reads_turned_rates() -> None:
    turn = np.array([0.02, -0.3, 0.1])
    motion = lissajous().sample(T)
    recorded = Imu(gyro_effects=[Misalignment.from_angles(turn=turn)]).record(motion, 1)
    np.testing.assert_allclose(recorded.measured.gyro, recorded.ideal.gyro @ exp_so3(turn), atol=1e-14)


def test_an_axis_that_leans_feels_a_little_of_the_axis_it_leans_to() -> None:
    leaning = Misalignment.from_angles(skew=(1e-3, 2e-3, 3e-3)).matrix
    np.testing.assert_array_equal(leaning, [[1.0, 0.0, 0.0], [1e-3, 1.0, 0.0], [2e-3, 3e-3, 1.0]])


def test_vibration_makes_a_bias_through_the_quadratic_term(rng: np.random.Generator) -> None:
    """Rectification: K2 A^2 / 2."""
    shaking = VibrationLines(frequency=[10.0], amplitude=[[3.0, 0.0, 1.0]])
    effects = [shaking, Nonlinearity(quadratic=0.01)]
    recorded = Imu(gyro_effects=effects).record(rest().sample(T), int(rng.integers(2**62)))
    # Five seconds are whole periods: the mean of the square is exact.
    np.testing.assert_allclose(recorded.measured.gyro.mean(axis=0), [0.045, 0.0, 0.005], atol=1e-14)


def test_the_cubic_term() -> None:
    recorded = at_rest(Nonlinearity(cubic=(0.0, 0.0, 1e-3)), T[:2], 1, "accel")
    expected = STANDARD_GRAVITY + 1e-3 * STANDARD_GRAVITY**3
    np.testing.assert_allclose(recorded.measured.accel, [[0.0, 0.0, expected]] * 2, rtol=1e-15)


def test_a_gyro_that_feels_gravity() -> None:
    np.testing.assert_allclose(
        error_at_rest(GSensitivity(sensitivity=1e-4), T[:2], 1), [[0.0, 0.0, 1e-4 * STANDARD_GRAVITY]] * 2
    )
    across = np.zeros((3, 3))
    across[0, 2] = 1e-4
    np.testing.assert_allclose(
        error_at_rest(GSensitivity(sensitivity=across), T[:2], 1), [[1e-4 * STANDARD_GRAVITY, 0.0, 0.0]] * 2
    )


def test_iron_bends_the_field_and_magnets_shift_it() -> None:
    effect = HardSoftIron(hard_iron_uT=(5.0, 0.0, -1.0), soft_iron=[[1, 0, 0.1], [0, 0.9, 0], [0, 0, 1]])
    recorded = at_rest(effect, T[:2], 1, "mag_uT")
    bent = [FIELD[0] + 0.1 * FIELD[2] + 5.0, 0.9 * FIELD[1], FIELD[2] - 1.0]
    np.testing.assert_allclose(recorded.measured.mag_uT, [bent] * 2, rtol=1e-15)


def test_bias_and_scale_follow_the_temperature() -> None:
    history = TemperatureHistory(np.array([-1.0, 0.0, 4.0, 9.0]), np.array([0.0, 25.0, 45.0, 45.0]))
    warmer = np.minimum(5.0 * T, 20.0)
    bias = error_at_rest(TemperatureBias(slope=(0.0, 2.0, 1.0)), T, 1, temperature=history)
    np.testing.assert_allclose(bias, warmer[:, None] * [0.0, 2.0, 1.0], atol=1e-13)
    effect = TemperatureScale(slope=1e-3, reference_degC=45.0)
    scale = error_at_rest(effect, T, 1, "accel", temperature=history)[:, 2]
    np.testing.assert_allclose(scale, STANDARD_GRAVITY * 1e-3 * (warmer - 20.0), atol=1e-14)


def test_without_a_history_it_is_25_degrees() -> None:
    assert not error_at_rest(TemperatureBias(slope=1.0), T, 1).any()
    np.testing.assert_array_equal(error_at_rest(TemperatureBias(slope=1.0, reference_degC=24.0), T, 1), 1.0)


def test_a_bias_over_temperature_is_a_bias_and_a_scale_is_none(rng: np.random.Generator) -> None:
    effects = [TemperatureBias(slope=1.0, reference_degC=20.0), ScaleFactor(error=0.1)]
    recorded = Imu(accel_effects=effects).record(rest().sample(T), 1)
    np.testing.assert_array_equal(recorded.accel_bias, recorded.errors("accel")["temperature_bias"])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ScaleFactor(error=-1.0), "error must be -0.999 or more, relative"),
        (lambda: Misalignment(np.ones((3, 3))), "matrix must not be singular, without unit"),
        (lambda: Misalignment(np.eye(2)), r"matrix must be \(3, 3\); got \(2, 2\)"),
        (lambda: HardSoftIron(soft_iron=np.diag([1.0, 1.0, 0.0])), "soft_iron must not be singular"),
        (lambda: HardSoftIron(hard_iron_uT=(1.0, np.inf, 0.0)), "hard_iron_uT must be finite"),
        (lambda: Nonlinearity(quadratic=np.nan), "quadratic must be finite, 1/unit of the sensor"),
        (lambda: GSensitivity(sensitivity=np.inf), "sensitivity must be finite, rad/s per m/s"),
        (lambda: TemperatureBias(slope=(1.0,)), "slope must be one number or three, one per axis"),
        (lambda: TemperatureScale(reference_degC=-300.0), "reference_degC must be .*deg C"),
        (lambda: at_rest(GSensitivity(sensitivity=1.0), T, 1, "accel"), "into gyro_effects"),
        (lambda: at_rest(HardSoftIron(hard_iron_uT=(1.0, 0.0, 0.0)), T, 1, "gyro"), "into mag_effects"),
    ],
)
def test_bad_parameters(make, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_draws_of_the_axes_are_independent(rng: np.random.Generator) -> None:
    motion, seed = lissajous().sample(T[:2]), int(rng.integers(2**62))
    imu = Imu(gyro_effects=[ScaleFactor(sigma=0.1)], environment=Environment())
    recorded = [imu.record(motion, seed, run) for run in range(200)]
    errors = np.array([r.errors("gyro")["scale_factor"][0, 1:] / r.ideal.gyro[0, 1:] for r in recorded])
    # 200 runs: 0.07 standard deviation of a correlation.
    assert np.abs(np.corrcoef(errors.T)[0, 1]) < 0.36
