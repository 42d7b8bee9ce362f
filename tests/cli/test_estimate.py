"""`kreisel estimate`: a file of readings in, a file of attitude out, impossible units refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.cli.commands.estimate import parse_settings
from kreisel.cli.main import main
from kreisel.data.frames import from_enu_flu
from tests.trials import turning_trial

TRIAL = turning_trial(6.0)


@pytest.fixture
def imu(tmp_path: Path) -> str:
    kreisel.write(tmp_path / "imu.csv", TRIAL.recording)
    return str(tmp_path / "imu.csv")


@pytest.mark.parametrize("name", ["attitude.tum", "attitude.csv", "attitude.npz", "attitude.mat"])
def test_the_answer_is_the_truth_and_reads_back(name, imu, tmp_path, capsys) -> None:
    out = tmp_path / name
    assert main(["estimate", imu, "-o", str(out)]) == 0
    text = capsys.readouterr().out
    assert "600 samples with magnetometer" in text and str(out) in text
    answer = kreisel.read(out)
    assert isinstance(answer, kreisel.AttitudeHistory)
    assert (answer.gyro_bias is not None) == (name != "attitude.tum")
    # Perfect readings, 100 Hz: what is left is the filter's own doubt, a tenth of a degree.
    assert kreisel.attitude_errors(TRIAL.reference, answer).summary().total_max_deg < 0.5


def test_another_world_goes_in_and_out(tmp_path) -> None:
    ned = from_enu_flu(TRIAL.recording, "ned-frd")
    kreisel.write(tmp_path / "ned.csv", ned)
    out = tmp_path / "ned.npz"
    assert main(["estimate", str(tmp_path / "ned.csv"), "-o", str(out), "--frame", "ned-frd"]) == 0
    truth = from_enu_flu(TRIAL.reference, "ned-frd")
    assert kreisel.attitude_errors(truth, kreisel.read(out)).summary().total_max_deg < 0.5


def test_declination_turns_the_answer_to_true_north(imu, tmp_path) -> None:
    out = tmp_path / "true.npz"
    assert main(["estimate", imu, "-o", str(out), "--declination-deg", "10"]) == 0
    s = kreisel.attitude_errors(TRIAL.reference, kreisel.read(out), align="heading").summary()
    # Magnetic north lies 10 deg east: what pointed magnetic north points 10 deg to the right of true north.
    assert s.heading_offset_deg == pytest.approx(-10.0, abs=0.3)


def test_tuning_reaches_the_filter(imu, tmp_path, capsys) -> None:
    out = str(tmp_path / "a.npz")
    # Without magnetometer the heading starts at zero, 1.9 rad from the truth.
    assert main(["estimate", imu, "-o", out, "--set", "mode=6", "--set", "accel_time=3"]) == 0
    s = kreisel.attitude_errors(TRIAL.reference, kreisel.read(out), align="heading").summary()
    assert abs(s.heading_offset_deg) > 30.0
    capsys.readouterr()
    assert main(["estimate", imu, "-o", out, "--set", "accel_tim=3"]) == 1
    assert "accel_tim is unknown; did you mean 'accel_time'" in capsys.readouterr().err


def test_settings_are_numbers_where_they_look_like_it() -> None:
    found = parse_settings(["mode=6", "accel_time = 3", "coning=true", "word=gyro"], {"mode"})
    assert found == {"mode": "6", "accel_time": 3, "coning": True, "word": "gyro"}
    assert parse_settings(["mode='9'"], {"mode"}) == {"mode": "9"}
    for pair in ("mode", "mode=", "=3"):
        with pytest.raises(ValueError, match="--set takes NAME=VALUE"):
            parse_settings([pair])


@pytest.mark.parametrize(
    ("change", "likely"),
    [
        ({"accel": TRIAL.recording.accel / 9.80665}, "looks like g"),
        ({"accel": TRIAL.recording.accel / 9.80665e-3}, "looks like mg"),
        ({"gyro": np.full_like(TRIAL.recording.gyro, 60.0)}, "looks like deg/s"),
    ],
)
def test_impossible_units_are_refused_unless_insisted_on(change, likely, tmp_path, capsys) -> None:
    kreisel.write(tmp_path / "odd.csv", replace(TRIAL.recording, **change))
    command = ["estimate", str(tmp_path / "odd.csv"), "-o", str(tmp_path / "out.npz")]
    assert main(command) == 1
    err = capsys.readouterr().err
    assert likely in err and "--trust-units" in err and err.count("\n") == 1
    assert not (tmp_path / "out.npz").exists()
    assert main([*command, "--trust-units"]) == 0
    assert likely in capsys.readouterr().err


def test_a_doubtful_field_is_only_a_note(tmp_path, capsys) -> None:
    kreisel.write(tmp_path / "gauss.npz", replace(TRIAL.recording, mag_uT=TRIAL.recording.mag_uT / 100.0))
    assert main(["estimate", str(tmp_path / "gauss.npz"), "-o", str(tmp_path / "out.npz")]) == 0
    err = capsys.readouterr().err
    assert err.startswith("kreisel: note: ") and "looks like gauss" in err


def test_a_picture_is_drawn_when_asked(imu, tmp_path) -> None:
    picture = tmp_path / "attitude.png"
    assert main(["estimate", imu, "-o", str(tmp_path / "a.tum"), "--picture", str(picture)]) == 0
    assert picture.stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--filter", "dmc"], "Did you mean 'dcm'"),
        (["--set", "mode"], "--set takes NAME=VALUE"),
        (["--to", "tumm"], "Did you mean 'tum'"),
    ],
)
def test_mistakes_are_one_line(arguments, message, imu, tmp_path, capsys) -> None:
    assert main(["estimate", imu, "-o", str(tmp_path / "a.tum"), *arguments]) == 1
    err = capsys.readouterr().err
    assert message in err and err.count("\n") == 1
