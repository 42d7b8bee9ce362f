"""The folder of a run, read back: what was written is what is known."""

import json

import numpy as np
import pytest

from kreisel.cli.main import main
from kreisel.study.account import account_of
from kreisel.study.folder import read_account
from kreisel.study.run import run
from kreisel.study.scenario import Scenario

SCENARIO = """
name = "to and fro"
seed = 5
duration = 6.0
rate_hz = 100.0
[trajectory]
kind = "lying_eight"
[[imu]]
name = "left wrist"
p_BS = [0.1, 0.0, 0.0]
rotation_deg = [0, 90, 0]
sensor = "bmi088"
[[imu]]
name = "elbow"
[environment]
field_N_uT = [0.0, 20.0, -44.0]
[[filter]]
kind = "dcm"
name = "my dcm"
align = "heading"
"""


@pytest.fixture
def folder(tmp_path, capsys):
    (tmp_path / "scenario.toml").write_text(SCENARIO)
    assert main(["run", str(tmp_path / "scenario.toml"), "-o", str(tmp_path / "out"), "--no-pictures"]) == 0
    return tmp_path / "out"


def test_it_tells_what_the_run_itself_does(folder):
    found, expected = read_account(folder), account_of(run(Scenario.from_toml(SCENARIO)))
    assert found.name == expected.name and found.report == json.loads(json.dumps(expected.report))
    np.testing.assert_array_equal(found.truth.p_NB, expected.truth.p_NB)
    for one, other in zip(found.readings, expected.readings, strict=True):
        np.testing.assert_array_equal(one.recording.gyro, other.recording.gyro)
        np.testing.assert_array_equal(one.recording.mag_uT, other.recording.mag_uT)
        np.testing.assert_array_equal(one.gyro_bias, other.gyro_bias)
        np.testing.assert_array_equal(one.mount.p_BS, other.mount.p_BS)
        np.testing.assert_array_equal(one.mount.R_BS, other.mount.R_BS)
    assert found.readings[0].gyro_bias.any() and not found.readings[1].gyro_bias.any()
    for one, other in zip(found.answers, expected.answers, strict=True):
        assert (one.imu, one.filter) == (other.imu, other.filter)
        np.testing.assert_array_equal(one.errors.dtheta_N, other.errors.dtheta_N)
        assert one.errors.summary() == other.errors.summary()


def test_what_is_no_such_folder_is_named(folder, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"report\.json: there is no such file.*kreisel run"):
        read_account(tmp_path)
    (folder / "elbow.csv").unlink()
    with pytest.raises(FileNotFoundError, match=r"elbow\.csv"):
        read_account(folder)
    lacking = ('{"schema": "kreisel.run/1"}', "it lacks 'scenario'")
    for text, cause in (("no", "not JSON"), ('{"schema": "other/1"}', "'other/1'"), ("[]", "None"), lacking):
        (folder / "report.json").write_text(text)
        with pytest.raises(ValueError, match=rf"report\.json is no report of `kreisel run`.*{cause}"):
            read_account(folder)
