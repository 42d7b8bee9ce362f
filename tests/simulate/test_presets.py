"""Presets: all sound, all sourced, and simulated at rest they show the noise their datasheet states."""

import numpy as np
import pytest

from kreisel.data.environment import Environment
from kreisel.data.noise import ALLAN_FLOOR, NoiseModel
from kreisel.simulate.imu import Imu
from kreisel.simulate.presets import GRADES, load, names, text_of
from kreisel.simulate.trajectories.rest import rest


def overlapping_allan(rate, dt, m):
    """Overlapping Allan deviation (3,) of rates (n, 3) at m steps; IEEE Std 952, by the integrated signal."""
    theta = np.concatenate([np.zeros((1, 3)), np.cumsum(rate, axis=0)]) * dt
    second = theta[2 * m :] - 2.0 * theta[m:-m] + theta[: -2 * m]
    return np.sqrt(0.5 * np.mean(second**2, axis=0)) / (m * dt)


def test_there_are_a_dozen_of_three_grades():
    assert len(names()) >= 12
    assert {load(name).grade for name in names()} >= {"consumer", "industrial", "tactical", "navigation"}


@pytest.mark.parametrize("name", names())
def test_every_preset_is_sound_and_every_value_has_its_source(name):
    preset = load(name)
    assert preset.grade in GRADES
    assert preset.part and preset.maker and preset.datasheet
    assert set(preset.sources) == set(preset.values)
    assert all(len(source) > 5 for source in preset.sources.values())
    # Which reading of a density is meant, and what was left out, is said of each.
    assert len(preset.notes) > 50
    recorded = Imu.from_preset(name).record(rest().sample(np.arange(50) / 100.0), 1)
    # Within six of the worst turn-on biases and scale errors here, 20 deg/s and 80 mg: units are the right ones.
    assert np.abs(recorded.measured.gyro).max() < np.deg2rad(120.0)
    assert np.abs(recorded.measured.accel - [0, 0, 9.80665]).max() < 6.0


# A fast subset: one consumer part by its density, one by its LSB, one by random walks, one with a low-pass.
@pytest.mark.parametrize("name", ["bmi088", "mpu9250", "adis16470", "stim300", "hg9900"])
def test_at_rest_the_allan_deviation_at_short_times_is_the_white_noise(name):
    dt, n, seed = 0.01, 60_000, 11
    recorded = Imu.from_preset(name).record(rest().sample(np.arange(n) * dt), seed)
    gyro, accel, _ = load(name).triads()
    for triad, readings in ((gyro, recorded.measured.gyro), (accel, recorded.measured.accel)):
        # At 0.1 s white noise dominates the bias by far; quantisation adds step^2 / 12 per sample as white noise.
        m = 10
        expected = np.sqrt(triad.noise.allan_deviation(np.array([m * dt]))[0] ** 2 + triad.step**2 / 12.0 / m)
        found = overlapping_allan(readings, dt, m)
        # 6000 independent clusters, overlapping: one standard error is 1 %, 4 of them; 1e-10 is round-off of the sum.
        np.testing.assert_allclose(found, expected, rtol=0.04, atol=1e-10, err_msg=f"{name}, seed {seed}")


def test_in_run_bias_stability_is_the_floor():
    """STIM300's 0.5 deg/h: long averages level off at it."""
    dt, n, seed = 1.0, 40_000, 5
    model = load("stim300").triads().gyro
    quiet = NoiseModel(bias_instability=model.noise.bias_instability)
    recorded = Imu.from_noise(quiet, NoiseModel()).record(rest().sample(np.arange(n) * dt), seed)
    found = np.rad2deg(overlapping_allan(recorded.measured.gyro, dt, 100)) * 3600.0
    # 400 clusters of flicker: 5 % standard error, four of them.
    np.testing.assert_allclose(found, 0.5, rtol=0.2, err_msg=f"seed {seed}")
    np.testing.assert_allclose(
        np.rad2deg(model.noise.bias_instability) * 3600.0 * ALLAN_FLOOR, 0.5, rtol=1e-12
    )


FIELD = Environment(field_N_uT=np.array([0.0, 20.0, -45.0]))


def test_the_magnetometer_of_a_preset_reads_where_there_is_a_field():
    recorded = Imu.from_preset("icm20948", environment=FIELD).record(rest().sample(np.arange(50) / 100.0), 1)
    # Whole multiples of 0.15 uT, nearest the field: the datasheet states no noise.
    np.testing.assert_allclose(
        recorded.measured.mag_uT, np.tile(np.round(FIELD.field_N_uT / 0.15) * 0.15, (50, 1)), rtol=1e-12
    )
    assert Imu.from_preset("icm20948").mag_effects == ()
    assert Imu.from_preset("bmi088", environment=FIELD).mag_effects == ()


def test_the_noise_of_a_magnetometer_is_that_of_its_datasheet():
    """VN-100: 140 ugauss/sqrt(Hz), one-sided, are 0.014 uT * sqrt(50 Hz) RMS at 100 Hz."""
    seed, n = 3, 4000
    recorded = Imu.from_preset("vn100", environment=FIELD).record(rest().sample(np.arange(n) / 100.0), seed)
    # Of 4000 samples 1.1 % standard error, four of them.
    np.testing.assert_allclose(
        recorded.measured.mag_uT.std(axis=0), 0.014 * np.sqrt(50.0), rtol=0.045, err_msg=f"seed {seed}"
    )


def test_same_seed_same_bits_and_another_seed_another_turn_on_bias():
    motion, imu = rest().sample(np.arange(100) / 100.0), Imu.from_preset("bmi088")
    first, again, other = imu.record(motion, 7), imu.record(motion, 7), imu.record(motion, 8)
    np.testing.assert_array_equal(first.measured.gyro, again.measured.gyro)
    assert (first.gyro_bias[0] != other.gyro_bias[0]).all()


def test_names_forgive_hyphens_and_suggest_the_nearest():
    assert load("ICM-20948").name == "icm20948"
    assert load("ADIS16465_1").name == "adis16465-1"
    with pytest.raises(ValueError, match="Did you mean 'bmi088'"):
        Imu.from_preset("bmi08")


def test_a_noise_model_becomes_a_preset_file_and_back(tmp_path):
    gyro = NoiseModel(white_noise=(1e-4, 2e-4, 3e-4), bias_instability=1e-5, bias_random_walk=1e-6)
    accel = NoiseModel(white_noise=1e-3, bias_random_walk=2e-5, turn_on_bias=0.1)
    path = tmp_path / "mine.toml"
    path.write_text(text_of(gyro, accel, "my phone", "rest.csv, 2 h at rest"))
    preset = load(path)
    assert (preset.name, preset.part, preset.grade) == ("mine", "my phone", "measured")
    for model, triad in zip((gyro, accel), preset.triads()[:2], strict=True):
        for quantity in ("white_noise", "bias_instability", "bias_random_walk", "turn_on_bias"):
            np.testing.assert_allclose(getattr(triad.noise, quantity), getattr(model, quantity), rtol=1e-14)
    assert len(Imu.from_preset(str(path)).gyro_effects) == 3


HEAD = 'part = "x"\nmaker = "y"\ngrade = "consumer"\ndatasheet = "z"\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("part = ", "is no preset"),
        (HEAD, r"the table \[values\] is missing"),
        (HEAD + "[values]\ngyro_arw_deg_per_rth = 1.0", "must be { value"),
        (HEAD + "[values]\ngyro_arw_deg_per_rth = { value = 1.0 }", "must be { value"),
        (
            HEAD + '[values]\ngyro_arw = { value = 1.0, source = "p. 1" }',
            "Did you mean 'gyro_arw_deg_per_rth'",
        ),
        (HEAD.replace("consumer", "best") + "[values]", "grade must be one of"),
        (HEAD.replace('"x"', "3") + "[values]", "part must be text"),
        ("notes = 3\n" + HEAD + "[values]", "notes must be text"),
        ('colour = "red"\n' + HEAD + "[values]", "a key must be one of"),
    ],
)
def test_a_preset_file_that_is_not_sound_is_refused(tmp_path, text, message):
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        load(path)


def test_a_preset_file_that_is_not_there():
    with pytest.raises(OSError, match="cannot read"):
        load("nowhere.toml")
