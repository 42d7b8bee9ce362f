"""`kreisel estimate` as a person and as a program meet it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.cli.main import main
from kreisel.data.frames import from_enu_flu
from tests.estimate.filters.turning import angles_deg, turning

N = 2000
T = np.arange(N) / 100.0
RATE = np.where(T < 5.0, 0.0, 0.8 * np.sin(T - 5.0))[:, None] * [0.3, -0.5, 1.0]
RECORDING, R = turning(T, RATE, np.eye(3))


@pytest.fixture
def imu(tmp_path: Path) -> str:
    kreisel.write(tmp_path / "imu.csv", RECORDING)
    return str(tmp_path / "imu.csv")


def error_deg(path: Path) -> float:
    attitude = kreisel.read(path, kind="attitude")
    assert isinstance(attitude, kreisel.AttitudeHistory)
    return float(angles_deg(attitude.R_NS, R)[0].max())


@pytest.mark.parametrize("suffix", ["tum", "csv", "npz", "mat"])
def test_a_recording_becomes_a_file_of_attitude(suffix: str, imu: str, tmp_path: Path, capsys) -> None:
    out = tmp_path / f"attitude.{suffix}"
    assert main(["estimate", imu, "-o", str(out)]) == 0
    # The sensors are perfect; 0.02 deg is what the start from single samples and the windows may leave.
    assert error_deg(out) < 0.02
    text = capsys.readouterr().out
    assert f"written: {out}" in text
    assert f"next: kreisel evaluate TRUTH {out}" in text


def test_everything_the_filter_knows_is_kept(imu: str, tmp_path: Path) -> None:
    assert main(["estimate", imu, "-o", str(tmp_path / "a.npz")]) == 0
    ours = kreisel.run(kreisel.DcmFilter(), kreisel.read(imu))
    found = kreisel.read(tmp_path / "a.npz")
    for name in ("R_NS", "gyro_bias", "a_N", "rest", "disturbed", "held"):
        np.testing.assert_array_equal(getattr(found, name), getattr(ours, name))


def test_the_summary_alone(imu: str, tmp_path: Path, capsys) -> None:
    assert main(["estimate", imu]) == 0
    text = capsys.readouterr().out
    assert "2000    19.99       100" in text and "nothing written" in text
    assert [p.name for p in tmp_path.iterdir()] == ["imu.csv"]


def test_the_summary_for_programs(imu: str, capsys) -> None:
    assert main(["estimate", imu, "--json", "--set", "mag_time=30"]) == 0
    report = json.loads(capsys.readouterr().out)
    (file,) = report["files"]
    assert report["schema"] == "kreisel.estimate/1" and report["filter"]["set"] == ["mag_time=30"]
    assert file["samples"] == N and file["magnetometer"] and file["held_share"] == 0.0
    # Five of twenty seconds less the time until rest is believed.
    assert 0.2 < file["rest_share"] < 0.25
    assert file["gyro_bias_deg_s"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-3)


def test_options_reach_the_filter(imu: str, tmp_path: Path, capsys) -> None:
    out = str(tmp_path / "a.npz")
    assert main(["estimate", imu, "-o", out, "--mode", "6", "--declination-deg", "90"]) == 0
    without = kreisel.run(kreisel.DcmFilter(mode="6"), kreisel.read(imu))
    np.testing.assert_array_equal(kreisel.read(out).R_NS, without.R_NS)
    assert main(["estimate", imu, "-o", out, "--declination-deg", "90"]) == 0
    # Magnetic north lies in the true east: everything is turned clockwise, seen from above.
    turned = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]) @ R
    assert angles_deg(kreisel.read(out).R_NS, turned)[0].max() < 0.02
    assert main(["estimate", imu, "-o", out, "--set", "published.weight_accel=0.02"]) == 0
    step = kreisel.DcmFilter.as_published(1.0, 0.02, 0.01)
    np.testing.assert_array_equal(kreisel.read(out).R_NS, kreisel.run(step, kreisel.read(imu)).R_NS)


def test_other_worlds_come_in_and_go_out(imu: str, tmp_path: Path) -> None:
    kreisel.write(tmp_path / "frd.csv", from_enu_flu(RECORDING, "ned-frd"))
    out, back = tmp_path / "a.npz", tmp_path / "b.npz"
    assert main(["estimate", str(tmp_path / "frd.csv"), "--frame", "ned-frd", "-o", str(out)]) == 0
    assert error_deg(out) < 0.02
    assert main(["estimate", imu, "--to-frame", "ned-frd", "-o", str(back)]) == 0
    expected = from_enu_flu(kreisel.read(out), "ned-frd")
    np.testing.assert_allclose(kreisel.read(back).R_NS, expected.R_NS, atol=1e-12)


def test_many_recordings_go_into_a_folder(imu: str, tmp_path: Path, capsys) -> None:
    kreisel.write(tmp_path / "imu2.csv", RECORDING)
    out = tmp_path / "out"
    assert main(["estimate", str(tmp_path / "imu*.csv"), "-o", str(out), "--to", "npz"]) == 0
    assert sorted(p.name for p in out.iterdir()) == ["imu.npz", "imu2.npz"]
    assert "written: 2 files" in capsys.readouterr().out
    assert all(error_deg(path) < 0.02 for path in out.iterdir())


def test_a_trial_is_its_own_truth(tmp_path: Path, capsys) -> None:
    from tests.cli.test_evaluate import broad_trial

    path = broad_trial(tmp_path, np.ones(400, bool))
    assert main(["estimate", str(path), "--trust-units"]) == 0
    assert f"next: kreisel evaluate {path} attitude.tum" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("sensor", "factor", "message"),
    [("accel", 1.0 / 9.80665, "looks like g,"), ("gyro", 180.0 / np.pi, "looks like deg/s")],
)
def test_units_that_cannot_be_are_refused(sensor, factor, message, tmp_path: Path, capsys) -> None:
    wrong = replace(RECORDING, **{sensor: getattr(RECORDING, sensor) * factor})
    path, out = str(tmp_path / "imu.npz"), str(tmp_path / "a.tum")
    kreisel.write(path, wrong)
    assert main(["estimate", path, "-o", out]) == 1
    err = capsys.readouterr().err
    assert message in err and "--trust-units" in err and err.count("\n") == 1
    assert main(["estimate", path, "-o", out, "--trust-units"]) == 0
    assert f"note: {path}:" in capsys.readouterr().err


def test_a_single_wild_sample_is_no_unit(tmp_path: Path, capsys) -> None:
    gyro = RECORDING.gyro.copy()
    gyro[1000] = 50.0
    kreisel.write(tmp_path / "imu.npz", replace(RECORDING, gyro=gyro))
    assert main(["estimate", str(tmp_path / "imu.npz")]) == 0
    assert "faults, or deg/s?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--set", "accel_tme=3"], "accel_tme is unknown; did you mean 'accel_time'?"),
        (["--set", "accel_time=soon"], "accel_time must be a number; got 'soon'"),
        (["--set", "accel_time=-3"], "accel_time must not be negative"),
        (["--set", "accel_time"], "--set takes KEY=VALUE"),
        (["--set", "published.exct=true"], "did you mean 'exact'?"),
        (["--mode", "7"], "mode must be 'auto', '9', '6' or 'gyro'"),
        (["--filter", "dmc"], "Did you mean 'dcm'?"),
        (["--to", "tumm"], "Did you mean 'tum'?"),
        (["--to-frame", "nde"], "--to-frame must be one of"),
    ],
)
def test_mistakes_are_one_line(arguments: list[str], message: str, imu: str, capsys) -> None:
    assert main(["estimate", imu, *arguments]) == 1
    err = capsys.readouterr().err
    assert message in err and err.count("\n") == 1


def test_files_are_not_mixed_up(imu: str, tmp_path: Path, capsys) -> None:
    before = Path(imu).read_bytes()
    kreisel.write(tmp_path / "imu.npz", RECORDING)
    for arguments, message in (
        (["estimate", imu, "-o", imu], "is the input itself"),
        (["estimate", imu, str(tmp_path / "imu.npz"), "-o", str(tmp_path / "out")], "two inputs"),
        (["estimate", imu, str(tmp_path / "imu.npz"), "-o", imu], "must be a folder for 2 inputs"),
        (["estimate", str(tmp_path / "*.nothing")], "no file fits"),
    ):
        assert main(arguments) == 1
        assert message in capsys.readouterr().err
    assert Path(imu).read_bytes() == before


def test_what_is_no_imu_and_what_has_no_magnetometer_is_refused(tmp_path: Path, capsys) -> None:
    kreisel.write(tmp_path / "poses.tum", kreisel.Poses(T, np.ones((N, 3)), R))
    assert main(["estimate", str(tmp_path / "poses.tum")]) == 1
    assert "holds Poses, not an IMU recording" in capsys.readouterr().err
    kreisel.write(tmp_path / "imu.csv", replace(RECORDING, mag_uT=None))
    assert main(["estimate", str(tmp_path / "imu.csv"), "--mode", "9"]) == 1
    assert "needs a magnetometer" in capsys.readouterr().err


def test_tuning_is_listed(imu: str, capsys) -> None:
    assert main(["estimate", imu, "--set", "help"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("accel_time: float = 5.0") for line in lines)
