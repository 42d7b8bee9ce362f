"""`kreisel sensors` as a user runs it."""

import json

import numpy as np
import pytest

from kreisel.cli.main import main
from kreisel.data.noise import NoiseModel
from kreisel.files.kalibr import read_kalibr
from kreisel.simulate.datasheet import PARAMETERS
from kreisel.simulate.presets import names, text_of


def test_all_are_listed_from_the_worst_grade_to_the_best(capsys):
    assert main(["sensors"]) == 0
    lines = capsys.readouterr().out.splitlines()
    listed = [line.split() for line in lines if line.split()[:1] and line.split()[0] in names()]
    assert sorted(row[0] for row in listed) == names()
    assert listed[0][1] == "consumer" and listed[-2][:2] == ["hg9900", "navigation"]
    # stim300 as its datasheet has it: 0.15 deg/sqrt(h), 0.5 deg/h, 400 deg/s, 0.07 m/s/sqrt(h), 50 ug, 10 g.
    assert next(row for row in listed if row[0] == "stim300")[2:] == [
        "0.15",
        "0.5",
        "400",
        "0.07",
        "50",
        "10",
        "-",
    ]


def test_one_with_its_sources(capsys):
    assert main(["sensors", "mpu6050"]) == 0
    text = capsys.readouterr().out
    assert "PS-MPU-6000A-00, revision 3.4" in text
    assert "gyro_turn_on_bias_deg_per_s = 20 deg/s" in text
    assert "p. 12, section 6.1" in text
    assert "rad/s/sqrt(Hz)" in text
    assert "two-sided. One-sided." in text


def test_a_magnetometer_is_shown_with_its_sources(capsys):
    assert main(["sensors", "vn100"]) == 0
    text = capsys.readouterr().out
    assert "mag_noise_ugauss_rthz = 140 ugauss/sqrt(Hz)" in text
    # 140 ugauss are 0.014 uT, one-sided.
    assert "0.009899 uT/sqrt(Hz)" in text


def test_json_of_one_and_of_all(capsys):
    assert main(["sensors", "--json"]) == 0
    every = json.loads(capsys.readouterr().out)
    assert every["schema"] == "kreisel.sensors/1"
    assert [len(every["sensors"])] == [len(names())]
    assert main(["sensors", "bmi088", "--json"]) == 0
    (one,) = json.loads(capsys.readouterr().out)["sensors"]
    assert one["values"]["gyro_noise_deg_per_s_rthz"]["value"] == 0.014
    # 0.014 deg/s/sqrt(Hz), one-sided.
    np.testing.assert_allclose(one["noise"]["gyro"]["white_noise"], np.deg2rad(0.014) / np.sqrt(2))


def test_a_measured_sensor_goes_to_kalibr_and_is_read_back(tmp_path, capsys):
    model = NoiseModel(white_noise=1e-4, bias_random_walk=1e-6)
    (tmp_path / "mine.toml").write_text(text_of(model, model, "mine", "rest.csv"))
    path = tmp_path / "imu.yaml"
    assert main(["sensors", str(tmp_path / "mine.toml"), "--kalibr", str(path), "--rate", "400"]) == 0
    assert read_kalibr(path).rate_hz == 400.0
    np.testing.assert_allclose(read_kalibr(path).gyro.white_noise, 1e-4, rtol=1e-14)
    capsys.readouterr()
    assert main(["sensors", str(path)]) == 0
    # 1e-4 rad/s/sqrt(Hz) are 1e-4 * 57.29578 * 60 deg/sqrt(h).
    assert "0.3438 deg/sqrt(h)" in capsys.readouterr().out


def test_a_preset_without_random_walks_goes_to_kalibr_with_those_given(tmp_path, capsys):
    path = tmp_path / "imu.yaml"
    given = ["--gyro-walk", "2e-5", "--accel-walk", "3e-4"]
    assert main(["sensors", "bmi088", "--kalibr", str(path), *given]) == 0
    found = read_kalibr(path)
    assert found.gyro.bias_random_walk[0] == 2e-5 and found.accel.bias_random_walk[0] == 3e-4
    # 0.014 deg/s/sqrt(Hz), one-sided.
    np.testing.assert_allclose(found.gyro.white_noise, np.deg2rad(0.014) / np.sqrt(2))
    assert (
        main(["sensors", "bmi088", "--kalibr", str(path), "--gyro-walk", "-1", "--accel-walk", "3e-4"]) == 2
    )
    assert "--gyro-walk must be a number of rad/s^2/sqrt(Hz), 0 or more; got '-1'" in capsys.readouterr().err


def test_both_columns_say_the_same(capsys):
    assert main(["sensors", "mti1"]) == 0
    row = next(
        line for line in capsys.readouterr().out.splitlines() if "gyro bias instability, floor" in line
    )
    # 10 deg/h in rad/s; B, which it is made of, is 1.5 times that.
    assert float(row.split()[-2]) == pytest.approx(np.deg2rad(10.0) / 3600.0, rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["bmi08"], "Did you mean 'bmi088'"),
        (["none.toml"], "cannot read none.toml"),
        (["none.yaml"], "cannot read none.yaml"),
        (["--kalibr", "x.yaml"], "name it"),
        (["bmi088", "--kalibr", "x.yaml"], "gyroscope_random_walk above 0"),
    ],
)
def test_mistakes_are_one_line(arguments, message, capsys):
    assert main(["sensors", *arguments]) == (2 if message in ("Did you mean 'bmi088'", "name it") else 1)
    err = capsys.readouterr().err
    assert message in err and err.count("\n") == 1


def test_keys_lists_every_number_with_its_unit(capsys):
    assert main(["sensors", "--keys"]) == 0
    lines = capsys.readouterr().out.splitlines()
    line = next(line for line in lines if line.startswith("gyro_temperature_bias_deg_per_s_per_K "))
    assert "deg/s/K" in line and "one sigma" in line
    assert all(len(line) < 140 for line in lines)
    assert main(["sensors", "--keys", "--json"]) == 0
    keys = json.loads(capsys.readouterr().out)["keys"]
    assert list(keys) == list(PARAMETERS)
    assert keys["accel_range_g"]["unit"] == "g"


def test_presets_may_spell_keys_as_datasheets_do(tmp_path, capsys):
    path = tmp_path / "mine.toml"
    path.write_text(
        'part = "mine"\nmaker = ""\ngrade = "measured"\ndatasheet = "chamber"\n[values]\n'
        'gyro_temperature_bias_dps_per_degC = { value = 0.02, source = "run 3" }\n'
    )
    assert main(["sensors", str(path)]) == 0
    assert (
        "gyro_temperature_bias_deg_per_s_per_K = 0.02 deg/s/K: temperature coefficient"
        in capsys.readouterr().out
    )
