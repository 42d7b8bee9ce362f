"""Sensors of a scenario: by preset, by file beside the scenario, and with everything they got wrong."""

import numpy as np
import pytest

from kreisel.simulate.imu import Imu
from kreisel.study.run import run
from kreisel.study.scenario import Scenario

TEXT = """\
duration = 1.0
rate_hz = 100.0
seed = {seed}
trajectory = {{ kind = "circle" }}
[[imu]]
name = "real"
sensor = "{sensor}"
[[imu]]
name = "perfect"
"""


def scenario(sensor="bmi088", seed=3, folder="."):
    return Scenario.from_toml(TEXT.format(sensor=sensor, seed=seed), folder)


def test_a_sensor_errs_and_its_neighbour_does_not():
    result = run(scenario())
    real, perfect = result.recordings
    (recorded,) = result.recorded
    assert recorded.measured is real
    np.testing.assert_array_equal(recorded.ideal.gyro, perfect.gyro)
    assert (real.gyro != perfect.gyro).all(axis=0).any()


def test_the_seed_of_the_scenario_decides():
    first, again, other = (run(scenario(seed=seed)).recordings[0].gyro for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


def test_the_same_as_in_python():
    result = run(scenario())
    imu = Imu.from_preset("bmi088", mount=result.mounts[0])
    np.testing.assert_array_equal(imu.record(result.motion, 3).measured.accel, result.recordings[0].accel)


def test_round_trip_keeps_the_sensor():
    assert Scenario.from_toml(scenario().to_toml()) == scenario()


def test_files_begin_at_the_folder_of_the_scenario(tmp_path):
    (tmp_path / "imu.yaml").write_text(
        "{gyroscope_noise_density: 1.0e-4, gyroscope_random_walk: 0.0, accelerometer_noise_density: 1.0e-3, "
        "accelerometer_random_walk: 0.0, update_rate: 200.0}"
    )
    (recorded,) = run(scenario("imu.yaml", folder=tmp_path)).recorded
    assert list(recorded.errors("gyro")) == ["white_noise"]


def test_an_unknown_sensor_is_refused_with_its_place():
    with pytest.raises(ValueError, match=r"scenario: imu\[0\].sensor: .*Did you mean 'bmi088'"):
        scenario("bmi08")
