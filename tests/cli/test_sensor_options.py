"""--set, --clock, --temperature and --effect as a user writes them, and as a scenario has them."""

import numpy as np
import pytest

from kreisel.cli.main import main
from kreisel.data.trajectory import Poses
from kreisel.files.doors import read, write
from kreisel.maths.rotations import matrix_from_euler

OPTIONS = (
    "--set gyro_noise_dps_rthz=0.02,accel_fixed_bias_mg=3/-2/5 --set gyro_fixed_temperature_bias_dps_per_degC=0.01 "
    "--clock jitter=1e-4,rate_offset_ppm=20,gyro.latency=0.02,loss=0.1 --temperature warm.csv "
    "--effect accel:vibration_lines:frequency=30/60,amplitude=[[0.5,0.2,1],[0.1,0,0]] "
    "--effect gyro:white_noise:density=1e-4,name=late,after=range"
)
SCENARIO = """
seed = 7
[trajectory]
kind = "file"
path = "poses.csv"
[[imu]]
name = "wrist"
p_BS = [0.1, 0, 0]
sensor = "bmi088"
temperature = "warm.csv"
[imu.datasheet]
gyro_noise_dps_rthz = 0.02
accel_fixed_bias_mg = [3, -2, 5]
gyro_fixed_temperature_bias_dps_per_degC = 0.01
[imu.clock]
jitter = 1e-4
rate_offset_ppm = 20
loss = 0.1
gyro = { latency = 0.02 }
[[imu.effects]]
sensor = "accel"
kind = "vibration_lines"
frequency = [30, 60]
amplitude = [[0.5, 0.2, 1], [0.1, 0, 0]]
[[imu.effects]]
sensor = "gyro"
kind = "white_noise"
name = "late"
density = 1e-4
after = "range"
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    t = np.arange(200) / 50.0
    p = np.stack([2.0 * np.cos(t), 2.0 * np.sin(t), 0 * t], axis=1)
    write(tmp_path / "poses.csv", Poses(t, p, matrix_from_euler(np.stack([0 * t, 0 * t, t], axis=1))))
    (tmp_path / "warm.csv").write_text("t [s],temperature [degC]\n0,20\n10,50\n")
    (tmp_path / "s.toml").write_text(SCENARIO)
    monkeypatch.chdir(tmp_path)


def simulate(options):
    return main(["simulate", "poses.csv", "-o", "out", "--no-pictures", *options.split()])


def test_options_and_a_scenario_make_the_same_bits(capsys):
    assert simulate(f"--imu bmi088@wrist:0.1,0,0 --seed 7 {OPTIONS}") == 0
    told = capsys.readouterr().out
    assert "datasheet: gyro_noise_dps_rthz = 0.02, accel_fixed_bias_mg = [3.0, -2.0, 5.0]" in told
    assert "clock: jitter = 0.0001, rate_offset_ppm = 20.0, gyro.latency = 0.02, loss = 0.1" in told
    assert "temperature: from warm.csv" in told
    assert 'white_noise of the gyro (density = 0.0001, name = "late", after range)' in " ".join(told.split())
    assert main(["run", "s.toml", "-o", "run", "--no-pictures"]) == 0
    told = capsys.readouterr().out
    assert "wrist, clock: jitter = 0.0001" in told and "wrist, temperature: from warm.csv" in told
    one, other = read("out/wrist.csv", kind="imu"), read("run/wrist.csv", kind="imu")
    for name in ("t", "gyro", "accel"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()
    with np.load("out/wrist-errors.npz") as terms, np.load("run/wrist-errors.npz") as again:
        assert {"accel_error_vibration_lines", "gyro_error_late", "temperature_degC"} <= set(terms.files)
        assert all(terms[name].tobytes() == again[name].tobytes() for name in terms.files)


def test_a_perfect_imu_with_a_clock_of_its_own_has_a_record():
    assert simulate("--clock offset=0.25") == 0
    with np.load("out/imu-errors.npz") as terms:
        np.testing.assert_allclose(read("out/imu.csv", kind="imu").t, terms["t"] + 0.25, atol=1e-9)


def test_what_was_lost_is_left_out_of_the_check(capsys):
    assert simulate("--imu bmi088 --clock loss=0.1,jitter=1e-3 --check") == 0
    assert "bmi088 with its errors" in capsys.readouterr().out


MISTAKES = [
    (
        "--set gyro_nose_dps_rthz=1",
        "--set: gyro_nose_dps_rthz is unknown; did you mean 'gyro_noise_deg_per_s_rthz'?",
    ),
    (
        "--set gyro_noise_dps_rthz",
        "--set takes KEY=VALUE, with commas between several; got 'gyro_noise_dps_rthz'.",
    ),
    ("--set gyro_bits=12,gyro_bits=16", "--set has gyro_bits twice; give it once."),
    (
        "--set gyro_noise_dps_rthz=-1",
        "--set: gyro_noise_dps_rthz must be 0 or more, deg/s/sqrt(Hz); got -1.0.",
    ),
    ("--clock jiter=1", "--clock: jiter is unknown; did you mean 'jitter'?"),
    ("--clock gyro.rat=1", "--clock: gyro.rat is unknown; did you mean 'rate'?"),
    ("--clock gyro=1,gyro.rate=1", "--clock has both gyro=... and gyro.rate=...; give one of them."),
    ("--clock jitter=1", "jitter must be below half the shortest step, 0.01 s"),
    ("--temperature none.csv", "cannot read none.csv"),
    ("--temperature -400", "--temperature: temperature_degC must be from -273.15 to 2000, deg C"),
    ("--effect gyro", "--effect takes SENSOR:KIND:KEY=VALUE"),
    (
        "--effect gyr:white_noise",
        "--effect gyr:white_noise: sensor must be one of 'gyro', 'accel', 'mag'; got 'gyr'.",
    ),
    (
        "--effect gyro:whitenoise",
        "--effect gyro:whitenoise: kind 'whitenoise' is unknown; did you mean 'white_noise'?",
    ),
    (
        "--effect gyro:white_noise:densty=1",
        "--effect gyro:white_noise: densty is unknown; did you mean 'density'?",
    ),
    (
        "--effect gyro:white_noise:density=[1,2",
        "--effect density takes a list written as [1, 2, 3]; got '[1,2'.",
    ),
    (
        "--effect mag:white_noise:density=1",
        "--effect mag:white_noise says nothing where there is no magnetic field",
    ),
    (
        "--effect accel:g_sensitivity:sensitivity=1",
        "--effect accel:g_sensitivity: sensitivity to specific force",
    ),
]


# What the poses, or a file that was named, make a mistake.
ABOUT_FILES = ("--clock jitter=1", "--temperature none.csv")


@pytest.mark.parametrize(("options", "message"), MISTAKES, ids=[options for options, _ in MISTAKES])
def test_a_mistake_is_one_line_that_names_the_option(options, message, tmp_path, capsys):
    assert simulate(options) == (1 if options in ABOUT_FILES else 2)
    told = capsys.readouterr().err
    assert told.startswith(f"kreisel: {message}") and told.count("\n") == 1
    assert not (tmp_path / "out").exists()
