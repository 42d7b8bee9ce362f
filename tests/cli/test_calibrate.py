"""`kreisel calibrate`: a recording in, a calibration file out, and with it a better recording."""

from __future__ import annotations

from datetime import date

import numpy as np
import pytest

import kreisel
from kreisel.cli.main import main
from kreisel.files.calibrations import read_calibration, write_calibration
from kreisel.maths.rotations import exp_so3

T = np.arange(1500) / 50.0
BIAS = np.array([0.01, -0.02, 0.03])


@pytest.fixture
def turned(tmp_path) -> str:
    """Ten seconds of rest, then the field from everywhere."""
    R = exp_so3(np.random.default_rng(7).uniform(-2.0, 2.0, (1500, 3)))
    R[:500] = np.eye(3)
    gyro = np.where(T < 10.0, 0.0, np.sin(20.0 * T))[:, None] + BIAS
    mag = np.array([0.0, 20.0, -40.0]) @ R + [5.0, -6.0, 7.0]
    path = tmp_path / "turned.csv"
    kreisel.write(path, kreisel.ImuRecording(T, gyro, np.array([0.0, 0.0, 9.80665]) @ R, mag))
    return str(path)


def test_calibrate_then_apply(turned, tmp_path, capsys) -> None:
    out, better = tmp_path / "calibration.toml", tmp_path / "better.csv"
    assert main(["calibrate", turned, "--gyro", "--mag", "-o", str(out)]) == 0
    text = capsys.readouterr().out
    assert "hard iron (5 ±" in text and "dip 63.4 deg" in text
    calibration = read_calibration(out)
    assert calibration.accel is None
    assert out.with_suffix(".png").stat().st_size > 10_000 and "before and after" in text
    np.testing.assert_allclose(calibration.gyro.bias, BIAS, atol=1e-9)
    assert main(["calibrate", turned, "--apply", str(out), "-o", str(better)]) == 0
    strength = np.linalg.norm(kreisel.read(better).mag_uT, axis=1)
    np.testing.assert_allclose(strength, np.hypot(20.0, 40.0), rtol=1e-8)


def test_without_flags_what_shows_is_calibrated_and_the_rest_noted(turned, tmp_path, capsys) -> None:
    out = tmp_path / "calibration.toml"
    assert main(["calibrate", turned, "-o", str(out)]) == 0
    assert "note: no accel" in capsys.readouterr().err
    assert main(["calibrate", turned, "--accel", "-o", str(out)]) == 1


@pytest.fixture
def posed(tmp_path) -> str:
    """Fourteen poses of four seconds with a shake in between, where gravity is 9.78 m/s^2."""
    rng = np.random.default_rng(3)
    up = rng.normal(size=(14, 3))
    up[:6] = [*np.eye(3), *-np.eye(3)]
    up *= 9.78 / np.linalg.norm(up, axis=1)[:, None]
    t = np.arange(14 * 250) / 50.0
    shaken = (np.arange(len(t)) % 250 >= 200)[:, None]
    lean = np.array([[1.0, 0.01, 0.0], [0.01, 1.0, 0.0], [0.0, 0.0, 1.0]])
    noise = rng.normal(size=(2, len(t), 3))
    accel = np.repeat(up, 250, axis=0) @ lean + np.where(shaken, 1.0, 0.01) * noise[0]
    path = tmp_path / "posed.csv"
    kreisel.write(path, kreisel.ImuRecording(t, np.where(shaken, 1.0, 0.001) * noise[1], accel))
    return str(path)


def test_gravity_of_the_place_is_no_scale(posed, tmp_path, capsys) -> None:
    out = tmp_path / "calibration.toml"
    assert main(["calibrate", posed, "--accel", "--gravity", "9.78", "-o", str(out)]) == 0
    # 0.01 m/s^2 of noise, 100 samples and more a pose: 1e-4 of gravity.
    np.testing.assert_allclose(np.diagonal(read_calibration(out).accel.matrix), 1.0, atol=5e-4)
    assert "misalignment xy, xz, yz (0.57" in capsys.readouterr().out
    assert main(["calibrate", posed, "--accel", "-o", str(out)]) == 0
    scale = np.diagonal(read_calibration(out).accel.matrix)
    np.testing.assert_allclose(scale, 9.78 / 9.80665, atol=5e-4)
    assert main(["calibrate", posed, "--accel", "--gravity", "978", "-o", str(out)]) == 2
    assert "--gravity must be a number of m/s^2 from 0.1 to 100; got '978'" in capsys.readouterr().err


def test_options_that_cannot_be_are_errors_and_no_notes(turned, tmp_path, capsys) -> None:
    out = str(tmp_path / "c.toml")
    assert main(["calibrate", turned, "-o", out, "--field-ut", "-3"]) == 2
    assert "--field-ut must be a number of microtesla from 1 to 1000; got '-3'" in capsys.readouterr().err
    assert main(["calibrate", turned, "-o", out, "--apply", "c.toml", "--mag", "--gravity", "9.8"]) == 2
    assert "--mag, --gravity belongs to a calibration" in capsys.readouterr().err


def test_a_calibration_is_a_sensor_to_simulate(turned, tmp_path) -> None:
    out, folder = tmp_path / "calibration.toml", tmp_path / "out"
    poses = tmp_path / "poses.csv"
    poses.write_text(
        "t [s],p_x,p_y,p_z,phi_x,phi_y,phi_z\n" + "".join(f"{k},0,0,0,0,0,0\n" for k in range(20))
    )
    assert main(["calibrate", turned, "-o", str(out)]) == 0
    place = ["--place", "48,11", "--date", "2026-05-01", "--no-pictures"]
    assert main(["simulate", str(poses), "-o", str(folder), "--imu", str(out), *place]) == 0
    made, true = (
        kreisel.read(folder / "calibration.csv"),
        kreisel.Environment.at(48, 11, 0, date(2026, 5, 1)),
    )
    np.testing.assert_allclose(made.gyro[3], BIAS, atol=1e-9)
    better = read_calibration(out).apply(made)
    # Level, nose to the east: the axes are those of N. The file holds every digit.
    np.testing.assert_allclose(better.mag_uT[3], true.field_N_uT, atol=1e-9)
    # Without a field there is no magnetometer, and nothing to complain of.
    assert main(["simulate", str(poses), "-o", str(folder), "--imu", str(out), "--no-pictures"]) == 0


def test_a_calibration_file_reads_back_and_a_wrong_one_says_where(tmp_path) -> None:
    path = tmp_path / "c.toml"
    triad = kreisel.data.calibration.TriadCalibration(
        np.diag([1.1, 1.2, 1.3]), BIAS, 0.1 * np.ones((3, 3)), BIAS**2
    )
    write_calibration(path, kreisel.Calibration(accel=triad))
    back = read_calibration(path)
    assert back.gyro is None and back.mag is None
    for name in ("matrix", "bias", "matrix_error", "bias_error"):
        np.testing.assert_array_equal(getattr(back.accel, name), getattr(triad, name))
    path.write_text(path.read_text().replace("m/s^2", "g"))
    with pytest.raises(ValueError, match=r"unit of \[accel\] must be one of 'm/s\^2'; got 'g'"):
        read_calibration(path)
