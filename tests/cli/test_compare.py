"""`kreisel compare` as a person and as a program meet it."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.io import savemat

import kreisel
from kreisel.cli.main import main
from kreisel.maths.rotations import continuous_signs, exp_so3, matrix_from_quat_wxyz, quat_wxyz_from_matrix
from kreisel.simulate.effects.white_noise import WhiteNoise
from tests.evaluate.align.moving import T, every_way

MOUNT = kreisel.Mount([0.05, -0.02, 0.1], exp_so3(np.array([0.4, -1.0, 2.0])))


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    """Files of an IMU with stamps 20 ms ahead, and of the poses it was on."""
    folder = tmp_path_factory.mktemp("made")
    trajectory = every_way()
    noise = {"gyro_effects": [WhiteNoise(1e-4)], "accel_effects": [WhiteNoise(1e-3)]}
    imu = kreisel.Imu(MOUNT, **noise, clock=kreisel.Clock(offset=0.02))
    kreisel.write(folder / "real.csv", imu.record(trajectory.sample(T), 1).measured)
    motion = trajectory.sample(trajectory.t)
    kreisel.write(folder / "poses.csv", kreisel.Poses(motion.t, motion.p_NB, motion.R_NB))
    return str(folder / "real.csv"), str(folder / "poses.csv")


def report(capsys, *arguments: str, code: int = 0) -> dict:
    assert main(["compare", *arguments, "--json"]) == code
    return json.loads(capsys.readouterr().out)


def complaint(capsys, *arguments: str, code: int = 1) -> str:
    assert main(["compare", *arguments]) == code
    streams = capsys.readouterr()
    assert streams.err.count("\n") == 1 and "Traceback" not in streams.err
    return streams.err


def test_the_mount_is_found_and_told(made, capsys) -> None:
    assert main(["compare", *made]) == 0
    text = capsys.readouterr().out
    lines = {line.split("  ")[0]: line for line in text.splitlines()}
    assert "gyro RMSE, rad/s" in lines and "accel correlation" in lines
    assert (
        float(lines["gyro clock"].split()[2]) == pytest.approx(20.0, abs=0.1)
        and "mm" in lines["lever arm"]
        and "±" in lines["lever arm"]
    )
    found = report(capsys, *made)
    assert found["schema"] == "kreisel.compare/1"
    errors = np.array(found["standard_errors"]["lever_arm"])
    assert (np.abs(np.array(found["p_BS_m"]) - MOUNT.p_BS) < 5.0 * errors).all()
    np.testing.assert_allclose(found["R_BS"], MOUNT.R_BS, atol=1e-3)
    assert found["accel"]["clock_s"] == pytest.approx(0.02, abs=1e-4)
    # 1e-4 rad/s/sqrt(Hz) at 100 Hz.
    assert found["gyro"]["rmse_all_axes"] == pytest.approx(1e-3, rel=0.1)


def test_the_folder_has_picture_twin_and_numbers(made, tmp_path, capsys) -> None:
    assert main(["compare", *made, "-o", str(tmp_path)]) == 0
    assert "twin.png" in capsys.readouterr().out
    assert (tmp_path / "twin.png").stat().st_size > 10_000
    twin, real = kreisel.read(tmp_path / "twin.csv"), kreisel.read(made[0])
    np.testing.assert_array_equal(twin.t, real.t)
    both = np.isfinite(twin.gyro[:, 0])
    assert both.sum() > 900 and np.abs(twin.gyro - real.gyro)[both].max() < 0.01
    assert json.loads((tmp_path / "summary.json").read_text())["gyro"]["samples"] == both.sum()


def test_a_known_mount_leaves_only_what_is_asked_for(made, capsys) -> None:
    known = report(capsys, *made, "--imu=0.1,0,0:0,0,0", "--estimate", "none")
    assert known["p_BS_m"] == [0.1, 0.0, 0.0] and known["standard_errors"] == {}
    assert known["gyro"]["rmse_all_axes"] > 0.5
    every = report(capsys, *made, "--estimate", "all")
    assert len(every["standard_errors"]) == 10 and every["drift"] == pytest.approx(0.0, abs=1e-4)
    assert "estimate must be one of" in complaint(capsys, *made, "--estimate", "lever", code=2)


def test_limits_are_held_or_the_exit_code_says_so(made, capsys) -> None:
    assert report(capsys, *made, "--max-gyro-rmse", "0.002")["limits"][0]["held"]
    missed = report(capsys, *made, "--max-accel-rmse", "0.001", code=3)
    assert missed["limits"][0] | {"value": 0.0} == {
        "name": "accel_rmse",
        "unit": "m/s^2",
        "limit": 0.001,
        "value": 0.0,
        "held": False,
    }


def test_a_trial_with_positions_needs_no_second_file(made, tmp_path, capsys) -> None:
    real, poses = kreisel.read(made[0]), kreisel.read(made[1])
    seen = every_way().sample(real.t)
    trial = {"imu_gyr": real.gyro, "imu_acc": real.accel, "imu_mag": real.gyro, "sampling_rate": 100.0}
    trial |= {"opt_quat": quat_wxyz_from_matrix(seen.R_NB), "movement": np.ones(len(real))}
    savemat(tmp_path / "blind.mat", trial)
    assert "has no poses of its own" in complaint(capsys, str(tmp_path / "blind.mat"), "--trust-units")
    savemat(tmp_path / "trial.mat", trial | {"opt_pos": seen.p_NB})
    found = report(capsys, str(tmp_path / "trial.mat"), "--trust-units")
    np.testing.assert_allclose(found["R_BS"], MOUNT.R_BS, atol=1e-3)
    assert found["gyro"]["clock_s"] == pytest.approx(0.02, abs=1e-4)
    assert len(poses) > len(real)


def test_interpolated_poses_are_thinned_and_others_are_not(made, tmp_path, capsys) -> None:
    real, path = made[0], kreisel.read(made[1])
    assert not any("interpolated on" in note for note in report(capsys, *made)["notes"])
    turns = continuous_signs(quat_wxyz_from_matrix(path.R_NB))
    t = np.arange(path.t[0], path.t[-1], 1.0 / 286.0)
    p_NB, turned = (
        np.stack([np.interp(t, path.t, column) for column in columns.T], axis=1)
        for columns in (path.p_NB, turns)
    )
    turned /= np.linalg.norm(turned, axis=1, keepdims=True)
    between = kreisel.Poses(t, p_NB, matrix_from_quat_wxyz(turned))
    kreisel.write(tmp_path / "between.npz", between)
    note, *_ = report(capsys, real, str(tmp_path / "between.npz"))["notes"]
    assert "interpolated on straight lines from" in note and f"of {len(t)} are taken" in note
    asked = report(capsys, real, str(tmp_path / "between.npz"), "--pose-rate", "300")["notes"]
    assert not any("interpolated on" in note for note in asked)


def test_bad_input_is_one_sentence(made, tmp_path, capsys) -> None:
    real, poses = made
    assert "is no IMU recording. The recording comes first" in complaint(capsys, poses, real)
    assert "Name the file that has" in complaint(capsys, real)
    recording, path = kreisel.read(real), kreisel.read(poses)
    kreisel.write(tmp_path / "p.csv", kreisel.Poses(path.t, path.p_NB))
    assert "positions only" in complaint(capsys, real, str(tmp_path / "p.csv"))
    kreisel.write(tmp_path / "late.csv", kreisel.Poses(path.t + 60.0, path.p_NB, path.R_NB))
    assert "do not overlap in time" in complaint(capsys, real, str(tmp_path / "late.csv"))
    in_g = kreisel.ImuRecording(recording.t, recording.gyro, recording.accel / 9.80665)
    kreisel.write(tmp_path / "g.csv", in_g)
    assert "looks like g" in complaint(capsys, str(tmp_path / "g.csv"), poses)
    assert "--pose-rate must be a number of hertz above 0" in complaint(
        capsys, real, poses, "--pose-rate", "0", code=2
    )
    assert "method must be one of" in complaint(capsys, real, poses, "--method", "gradient", code=2)
