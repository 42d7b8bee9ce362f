"""Everything an IMU can be, said in a scenario: the same bits as in Python, and mistakes named with their key."""

import numpy as np
import pytest

from kreisel.data.calibration import Calibration, TriadCalibration
from kreisel.data.environment import Environment
from kreisel.data.motion import Mount
from kreisel.data.noise import NoiseModel
from kreisel.data.temperature import TemperatureHistory
from kreisel.files.calibrations import write_calibration
from kreisel.files.kalibr import KalibrImu, write_kalibr
from kreisel.simulate.clock import Clock, Sampling
from kreisel.simulate.effects.vibration_lines import VibrationLines
from kreisel.simulate.effects.white_noise import WhiteNoise
from kreisel.simulate.imu import Imu
from kreisel.simulate.order import ORDER, placed
from kreisel.study.building import build
from kreisel.study.imus import effect_kinds
from kreisel.study.run import run
from kreisel.study.scenario import EffectRecipe, EnvironmentRecipe, ImuRecipe, Scenario, TrajectoryRecipe

BODY = 'duration = 1.0\nrate_hz = 100.0\nseed = 3\n[trajectory]\nkind = "circle"\n'
FULL = (
    BODY
    + """
[environment]
field_N_uT = [0, 20, -44]
[[imu]]
name = "wrist"
sensor = "bmi088"
temperature = [[0, 20], [0.4, 30], [1, 33]]
[imu.datasheet]
gyro_noise_dps_rthz = 0.02
gyro_fixed_temperature_bias_dps_per_degC = [0.01, 0, -0.02]
accel_nonlinearity_percent = 0.5
[imu.clock]
offset = 0.1
rate_offset_ppm = 20
jitter = 1e-3
loss = 0.1
gyro = { latency = 0.01 }
mag = { rate = 20, window = 0.02 }
[[imu.effects]]
sensor = "accel"
kind = "vibration_lines"
frequency = 30
amplitude = [0.5, 0.2, 1.0]
[[imu.effects]]
sensor = "mag"
kind = "white_noise"
name = "radio"
density = 0.1
[[imu.effects]]
sensor = "gyro"
kind = "white_noise"
name = "late"
density = 1e-4
after = "range"
"""
)


def read(text, folder="."):
    return Scenario.from_toml(text, folder, source="s.toml")


def by_hand(motion):
    imu = Imu.from_preset(
        "bmi088",
        mount=Mount(name="wrist"),
        environment=Environment(field_N_uT=[0, 20, -44]),
        clock=Clock(0.1, 2e-5, 1e-3, 0.1, gyro=Sampling(latency=0.01), mag=Sampling(20.0, window=0.02)),
        temperature=TemperatureHistory([0.0, 0.4, 1.0], [20.0, 30.0, 33.0]),
        gyro_noise_deg_per_s_rthz=0.02,
        gyro_fixed_temperature_bias_deg_per_s_per_K=(0.01, 0.0, -0.02),
        accel_nonlinearity_percent=0.5,
    )
    return Imu(
        imu.mount,
        placed(imu.gyro_effects, WhiteNoise(1e-4, name="late"), after="range"),
        placed(imu.accel_effects, VibrationLines(30.0, (0.5, 0.2, 1.0))),
        (WhiteNoise(0.1, name="radio"),),
        imu.environment,
        imu.clock,
        imu.temperature,
    ).record(motion, 3)


def test_the_same_bits_as_in_python():
    result = run(read(FULL))
    (recorded,), expected = result.recorded, by_hand(result.motion)
    for name in ("t", "gyro", "accel", "mag_uT"):
        found = getattr(recorded.measured, name)
        assert found.tobytes() == getattr(expected.measured, name).tobytes(), name
    assert [*recorded.errors("gyro")][-2:] == ["late", "quantisation"]
    assert next(iter(recorded.errors("accel"))) == "vibration_lines"
    np.testing.assert_array_equal(recorded.temperature_degC, expected.temperature_degC)


def test_it_survives_its_file():
    scenario = read(FULL)
    again = read(scenario.to_toml())
    assert again == scenario
    assert again.to_toml() == scenario.to_toml()
    assert scenario.imus[0].effects[2] == EffectRecipe(
        "gyro", "white_noise", {"name": "late", "density": 1e-4}, after="range"
    )
    assert run(again).recordings[0].gyro.tobytes() == run(scenario).recordings[0].gyro.tobytes()


def test_recipes_made_in_python_are_plain_values():
    given = np.array([[0.0, 20.0], [1.0, 30.0]])
    recipe = ImuRecipe(temperature=given, datasheet={"gyro_fixed_bias_dps": np.float64(1.0)})
    given[:] = 0.0
    assert recipe.temperature == ((0.0, 20.0), (1.0, 30.0))
    scenario = Scenario(TrajectoryRecipe("circle"), 1.0, 100.0, imus=(recipe,))
    assert read(scenario.to_toml()) == scenario
    # A magnetometer nobody asked for is not there to be wrong.
    np.testing.assert_allclose(run(scenario).recorded[0].gyro_bias, np.deg2rad(1.0), rtol=1e-12)


def test_a_datasheet_alone_is_a_sensor_and_a_clock_alone_an_error():
    plain, timed = run(
        read(
            BODY
            + '[[imu]]\nname = "a"\n[imu.datasheet]\ngyro_fixed_bias_dps = 2\n'
            + '[[imu]]\nname = "b"\n[imu.clock]\noffset = 0.5'
        )
    ).recorded
    np.testing.assert_allclose(plain.measured.gyro - plain.ideal.gyro, np.deg2rad(2.0), rtol=1e-9)
    np.testing.assert_array_equal(timed.measured.t, timed.ideal.t + 0.5)
    assert timed.measured.gyro.tobytes() == timed.ideal.gyro.tobytes()


def test_numbers_beside_those_of_a_kalibr_file(tmp_path):
    noises = NoiseModel(1e-4, bias_random_walk=1e-6), NoiseModel(1e-3, bias_random_walk=1e-5)
    write_kalibr(tmp_path / "imu.yaml", KalibrImu(*noises, 200.0))
    text = '[imu]\nsensor = "imu.yaml"\n[imu.datasheet]\ngyro_range_dps = 250\naccel_vrw_m_per_s_rth = 0.6\n'
    (imu,) = build(read(BODY + text, tmp_path)).imus
    assert [effect.name for effect in imu.gyro_effects] == ["bias_random_walk", "white_noise", "range"]
    np.testing.assert_allclose(imu.gyro_effects[1].density, 1e-4, rtol=1e-14)
    np.testing.assert_allclose(imu.accel_effects[1].density, 0.01, rtol=1e-14)


def test_noise_beside_the_errors_of_a_calibration(tmp_path):
    gyro = TriadCalibration(np.eye(3) + 0.01 * np.eye(3, k=1), np.array([0.1, 0.0, 0.0]))
    write_calibration(tmp_path / "mine.toml", Calibration(gyro=gyro))
    text = '[imu]\nsensor = "mine.toml"\n[imu.datasheet]\ngyro_noise_dps_rthz = 0.01\ngyro_scale_error_percent = 1\n'
    (imu,) = build(read(BODY + text, tmp_path)).imus
    names = [effect.name for effect in imu.gyro_effects]
    assert names == ["misalignment", "scale_factor", "turn_on_bias", "white_noise"]
    with pytest.raises(
        ValueError, match="datasheet: the calibration says what the turn_on_bias of the gyro is"
    ):
        read(BODY + text + "gyro_fixed_bias_dps = 1\n", tmp_path)


def test_temperature_from_a_file_beside_the_scenario(tmp_path):
    (tmp_path / "warm.csv").write_text("t [s],temperature [degC]\n0,20\n1,30\n")
    (imu,) = build(read(BODY + '[imu]\ntemperature = "warm.csv"\n', tmp_path)).imus
    np.testing.assert_array_equal(imu.temperature.temperature_degC, [20.0, 30.0])
    (imu,) = build(read(BODY + "[imu]\ntemperature = -10\n")).imus
    np.testing.assert_array_equal(imu.temperature.at(np.arange(3.0)), -10.0)


def test_every_effect_can_be_named():
    assert effect_kinds() == sorted(ORDER)
    effects = tuple(EffectRecipe("mag" if kind == "hard_soft_iron" else "gyro", kind) for kind in ORDER)
    world = EnvironmentRecipe(field_N_uT=(0.0, 20.0, -44.0))
    scenario = Scenario(
        TrajectoryRecipe("rest"), 1.0, 10.0, imus=(ImuRecipe(effects=effects),), environment=world
    )
    (imu,) = build(read(scenario.to_toml())).imus
    assert [effect.name for effect in imu.gyro_effects] == [k for k in ORDER if k != "hard_soft_iron"]


IMU = BODY + "[imu]\n"
EFFECT = BODY + '[[imu]]\n[[imu.effects]]\nsensor = "gyro"\n'
MISTAKES = [
    (IMU + "datashet = {}", "s.toml: imu.datashet is unknown; did you mean 'datasheet'?"),
    (IMU + "datasheet = 3", "s.toml: imu.datasheet must be a table; got 3."),
    (
        IMU + "datasheet = {gyro_nose_dps_rthz = 1}",
        "s.toml: imu[0].datasheet.gyro_nose_dps_rthz is unknown; did you mean 'gyro_noise_deg_per_s_rthz'?",
    ),
    (
        IMU + "datasheet = {zz = 1}",
        "s.toml: imu[0].datasheet.zz is unknown; kreisel sensors --keys lists all.",
    ),
    (
        IMU + 'datasheet = {gyro_noise_dps_rthz = "1"}',
        "s.toml: imu[0].datasheet.gyro_noise_dps_rthz must be one number, or three, one per axis, deg/s/sqrt(Hz)",
    ),
    (
        IMU + "datasheet = {gyro_noise_dps_rthz = [1, 2]}",
        "s.toml: imu[0].datasheet.gyro_noise_dps_rthz must be one number, or three",
    ),
    (
        IMU + "datasheet = {gyro_noise_dps_rthz = -1}",
        "s.toml: imu[0].datasheet: gyro_noise_dps_rthz must be 0 or more, deg/s/sqrt(Hz); got -1.0.",
    ),
    (
        IMU + "datasheet = {gyro_bits = 16}",
        "s.toml: imu[0].datasheet: gyro_bits needs the range, gyro_range_deg_per_s.",
    ),
    (
        IMU + "datasheet = {accel_range_g = 0.5}",
        "s.toml: imu[0].datasheet: limit of an accelerometer's range",
    ),
    (
        IMU + "datasheet = {mag_noise_uT_rthz = 1}",
        "s.toml: imu[0].datasheet.mag_noise_uT_rthz says nothing where there is no magnetic field",
    ),
    (IMU + "clock = 3", "s.toml: imu.clock must be a table; got 3."),
    (IMU + "clock = {jiter = 1}", "s.toml: imu[0].clock.jiter is unknown; did you mean 'jitter'?"),
    (
        IMU + "clock = {gyro = 3}",
        "s.toml: imu[0].clock.gyro must be a table with rate, latency, window; got 3.",
    ),
    (IMU + "clock = {gyro = {rat = 3}}", "s.toml: imu[0].clock.gyro.rat is unknown; did you mean 'rate'?"),
    (
        IMU + "clock = {gyro = {window = -3}}",
        "s.toml: imu[0].clock.gyro: window must be one number, 0 or more, s; got -3.0.",
    ),
    (IMU + "clock = {loss = 1.5}", "s.toml: imu[0].clock: loss must be one number, from 0 to 1, probability"),
    (IMU + "clock = {jitter = true}", "s.toml: imu[0].clock.jitter must be a number; got True."),
    (
        IMU + "clock = {jitter = 0.1}",
        "s.toml: imu[0].clock: jitter must be below half the shortest step, 0.005 s",
    ),
    (
        IMU + "clock = {gyro = {latency = 3}}",
        "s.toml: imu[0].clock: latency and window, 3 s together, reach back",
    ),
    (
        IMU + "clock = {rate_offset = 1e-5, rate_offset_ppm = 1}",
        "s.toml: imu[0].clock: rate_offset and rate_offset_ppm say the same",
    ),
    (
        IMU + "temperature = -300",
        "s.toml: imu[0].temperature: temperature_degC must be from -273.15 to 2000, deg C",
    ),
    (
        IMU + "temperature = true",
        "s.toml: imu.temperature must be a number or text in quotes or a list; got True.",
    ),
    (IMU + "temperature = [[0, 20], [1]]", "s.toml: imu.temperature[1][1] is missing."),
    (
        IMU + "temperature = []",
        "s.toml: imu[0].temperature must be one temperature, deg C, pairs [time in s, deg C]",
    ),
    (
        IMU + "temperature = [[0, 20], [0.5, 30]]",
        "s.toml: imu[0].temperature: temperature must cover the motion, from 0 to 1 s; it covers 0 to 0.5 s.",
    ),
    (IMU + "temperature = [[1, 20], [0, 30]]", "s.toml: imu[0].temperature: t must increase strictly"),
    (IMU + "effects = 3", "s.toml: imu.effects must be tables [[effects]]; got 3."),
    (BODY + "[[imu]]\n[[imu.effects]]\nkind = 'white_noise'", "s.toml: imu[0].effects[0].sensor is missing."),
    (EFFECT, "s.toml: imu[0].effects[0].kind is missing."),
    (
        EFFECT.replace('"gyro"', '"gyroscope"') + 'kind = "white_noise"',
        "s.toml: imu[0].effects[0].sensor must be 'gyro', 'accel' or 'mag'; got 'gyroscope'.",
    ),
    (
        EFFECT + 'kind = "white_nose"',
        "s.toml: imu[0].effects[0].kind 'white_nose' is unknown; did you mean 'white_noise'?",
    ),
    (
        EFFECT + 'kind = "white_noise"\ndensty = 1',
        "s.toml: imu[0].effects[0].densty is unknown; did you mean 'density'?",
    ),
    (
        EFFECT + 'kind = "white_noise"\ndensity = -1',
        "s.toml: imu[0].effects[0]: density must be 0 or more, unit/sqrt(Hz); got -1.0.",
    ),
    (
        EFFECT + 'kind = "misalignment"\nmatrix = [[1, 0, 0], [1, 0, 0], [0, 0, 1]]',
        "s.toml: imu[0].effects[0]: matrix must not be singular",
    ),
    (
        EFFECT + 'kind = "hard_soft_iron"\nhard_iron_uT = [1, 2, 3]',
        "s.toml: imu[0].effects[0]: hard and soft iron bend magnetic fields",
    ),
    (
        EFFECT.replace('"gyro"', '"mag"') + 'kind = "white_noise"',
        "s.toml: imu[0].effects[0] says nothing where there is no magnetic field",
    ),
    (
        EFFECT + 'kind = "white_noise"\nbefore = "range"',
        "s.toml: imu[0].effects[0]: before 'range' is no place: this sensor has no other effects.",
    ),
    (
        EFFECT + 'kind = "white_noise"\nname = "a/b"',
        "s.toml: imu[0].effects[0]: name must start with a letter or digit",
    ),
    (
        EFFECT + 'kind = "white_noise"\n[[imu.effects]]\nsensor = "gyro"\nkind = "white_noise"',
        "s.toml: imu[0].effects[1]: the gyro has an effect called 'white_noise' already",
    ),
]


@pytest.mark.parametrize(("text", "message"), MISTAKES, ids=[message[:70] for _, message in MISTAKES])
def test_a_mistake_is_one_sentence_that_names_the_key(text, message):
    with pytest.raises(ValueError) as caught:
        read(text)
    told = str(caught.value)
    assert told.startswith(message)
    assert "\n" not in told and "pydantic" not in told
    assert len(told) < 300
