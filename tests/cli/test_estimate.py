"""`kreisel estimate`: files of readings in, files of attitude out, impossible units refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.cli.filters import parse_settings
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
    assert (
        "600     5.99       100" in text
        and f"written: {out}" in text
        and "next: kreisel evaluate TRUTH" in text
    )
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
    assert main(["estimate", imu, "-o", out, "--set", "accel_tim=3"]) == 2
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


def test_a_sensor_that_never_reads_is_refused(tmp_path, capsys) -> None:
    nothing = np.full_like(TRIAL.recording.gyro, np.nan)
    kreisel.write(tmp_path / "nan.csv", replace(TRIAL.recording, gyro=nothing))
    assert (
        main(["estimate", str(tmp_path / "nan.csv"), "-o", str(tmp_path / "out.tum"), "--trust-units"]) == 1
    )
    assert "no reading of the gyroscope: every row is NaN." in capsys.readouterr().err
    assert not (tmp_path / "out.tum").exists()


def test_the_unit_that_is_asked_for_is_that_of_the_sensor(tmp_path, capsys) -> None:
    kreisel.write(
        tmp_path / "deg.csv", replace(TRIAL.recording, gyro=np.full_like(TRIAL.recording.gyro, 60.0))
    )
    assert main(["estimate", str(tmp_path / "deg.csv")]) == 1
    assert "--column gyro_x='gx [deg/s]'" in capsys.readouterr().err


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
        (["--to-frame", "nde"], "--to-frame must be one of"),
        (["--mode", "7"], "--mode must be one of 'auto', '9', '6', 'gyro'"),
        (["--set", "accel_time=soon"], "accel_time must be a number; got 'soon'"),
        (["--set", "accel_time=-3"], "accel_time must not be negative"),
        (["--set", "published.exct=true"], "did you mean 'exact'?"),
        (["--set", "accel_time=3", "--set", "accel_time.x=3"], "accel_time has a value already"),
    ],
)
def test_mistakes_are_one_line(arguments, message, imu, tmp_path, capsys) -> None:
    assert main(["estimate", imu, "-o", str(tmp_path / "a.tum"), *arguments]) == 2
    err = capsys.readouterr().err
    assert message in err and err.count("\n") == 1


def test_everything_the_filter_knows_is_kept(imu: str, tmp_path: Path) -> None:
    assert main(["estimate", imu, "-o", str(tmp_path / "a.npz")]) == 0
    ours = kreisel.run(kreisel.DcmFilter(), kreisel.read(imu))
    found = kreisel.read(tmp_path / "a.npz")
    for name in ("R_NS", "gyro_bias", "a_N", "rest", "disturbed", "held"):
        np.testing.assert_array_equal(getattr(found, name), getattr(ours, name))


def test_the_summary_alone(imu: str, tmp_path: Path, capsys) -> None:
    assert main(["estimate", imu]) == 0
    text = capsys.readouterr().out
    assert "600     5.99       100" in text and "nothing written" in text
    assert [p.name for p in tmp_path.iterdir()] == ["imu.csv"]


def test_the_summary_for_programs(imu: str, capsys) -> None:
    assert main(["estimate", imu, "--json", "--set", "mag_time=30"]) == 0
    report = json.loads(capsys.readouterr().out)
    (file,) = report["files"]
    assert report["schema"] == "kreisel.estimate/1" and report["filter"]["set"] == ["mag_time=30"]
    assert file["samples"] == 600 and file["magnetometer"] and file["held_share"] == 0.0
    # Two of six seconds less the time until rest is believed.
    assert 0.2 < file["rest_share"] < 0.4
    assert file["gyro_bias_deg_s"] == pytest.approx([0.0, 0.0, 0.0], abs=0.05)


def test_options_reach_the_filter(imu: str, tmp_path: Path, capsys) -> None:
    out = str(tmp_path / "a.npz")
    assert main(["estimate", imu, "-o", out, "--mode", "6"]) == 0
    without = kreisel.run(kreisel.DcmFilter(mode="6"), kreisel.read(imu))
    np.testing.assert_array_equal(kreisel.read(out).R_NS, without.R_NS)
    assert main(["estimate", imu, "-o", out, "--set", "published.weight_accel=0.02"]) == 0
    step = kreisel.DcmFilter.as_published(1.0, 0.02, 0.01)
    np.testing.assert_array_equal(kreisel.read(out).R_NS, kreisel.run(step, kreisel.read(imu)).R_NS)


def test_many_recordings_go_into_a_folder(imu: str, tmp_path: Path, capsys) -> None:
    kreisel.write(tmp_path / "imu2.csv", TRIAL.recording)
    out = tmp_path / "out"
    assert main(["estimate", str(tmp_path / "imu*.csv"), "-o", str(out), "--to", "npz"]) == 0
    assert sorted(p.name for p in out.iterdir()) == ["imu.npz", "imu2.npz"]
    assert "written: 2 files" in capsys.readouterr().out
    for path in out.iterdir():
        assert kreisel.attitude_errors(TRIAL.reference, kreisel.read(path)).summary().total_max_deg < 0.5


def test_a_trial_is_its_own_truth(tmp_path: Path, capsys) -> None:
    from tests.cli.test_evaluate import broad_trial

    path = broad_trial(tmp_path, np.ones(400, bool))
    assert main(["estimate", str(path), "--trust-units"]) == 0
    assert f"next: kreisel evaluate {path} attitude.tum" in capsys.readouterr().out


def test_a_single_wild_sample_is_no_unit(tmp_path: Path, capsys) -> None:
    gyro = TRIAL.recording.gyro.copy()
    gyro[300] = 50.0
    kreisel.write(tmp_path / "imu.npz", replace(TRIAL.recording, gyro=gyro))
    assert main(["estimate", str(tmp_path / "imu.npz")]) == 0
    assert "faults, or deg/s?" in capsys.readouterr().err


def test_files_are_not_mixed_up(imu: str, tmp_path: Path, capsys) -> None:
    before = Path(imu).read_bytes()
    kreisel.write(tmp_path / "imu.npz", TRIAL.recording)
    for arguments, message in (
        (["estimate", imu, "-o", imu], "is the input itself"),
        (["estimate", imu, str(tmp_path / "imu.npz"), "-o", str(tmp_path / "out")], "two inputs"),
        (["estimate", imu, str(tmp_path / "imu.npz"), "-o", imu], "must be a folder for 2 inputs"),
        (["estimate", str(tmp_path / "*.nothing")], "no file fits"),
    ):
        assert main(arguments) == 2
        assert message in capsys.readouterr().err
    assert Path(imu).read_bytes() == before


def test_what_is_no_imu_and_what_has_no_magnetometer_is_refused(tmp_path: Path, capsys) -> None:
    kreisel.write(
        tmp_path / "poses.tum", kreisel.Poses(TRIAL.reference.t, np.ones((600, 3)), TRIAL.reference.R_NS)
    )
    assert main(["estimate", str(tmp_path / "poses.tum")]) == 1
    assert "holds Poses, not an IMU recording" in capsys.readouterr().err
    kreisel.write(tmp_path / "imu.csv", replace(TRIAL.recording, mag_uT=None))
    assert main(["estimate", str(tmp_path / "imu.csv"), "--mode", "9"]) == 1
    assert "needs a magnetometer" in capsys.readouterr().err


def test_tuning_is_listed(imu: str, capsys) -> None:
    assert main(["estimate", imu, "--set", "help"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("accel_time: float = 5.0") for line in lines)


def test_smooth_needs_a_filter_that_knows_its_errors(tmp_path, capsys):
    t = np.arange(200) * 0.01
    still = np.tile([0.0, 0.0, 9.81], (len(t), 1))
    source = tmp_path / "imu.npz"
    kreisel.write(source, kreisel.ImuRecording(t, np.zeros_like(still), still))
    out = tmp_path / "attitude.npz"
    assert main(["estimate", str(source), "-o", str(out), "--filter", "mekf", "--smooth"]) == 0
    assert "mekf, mode auto, smoothed" in "".join(capsys.readouterr())
    assert kreisel.read(out, kind="attitude").sigma is not None
    assert main(["estimate", str(source), "--smooth"]) != 0
    assert "--filter mekf" in capsys.readouterr().err
