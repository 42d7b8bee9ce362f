"""`kreisel convert` and `kreisel info` as a person at a terminal meets them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.cli.main import main

G = 9.80665


@pytest.fixture
def mocap(tmp_path: Path) -> Path:
    """A stranger's table: milliseconds, millimetres, NED."""
    path = tmp_path / "mocap.csv"
    rows = [f"{10 * k};{1000 + k};{2000 - k};{-500}" for k in range(50)]
    path.write_text("Time (ms);X;Y;Z\n" + "\n".join(rows) + "\n")
    return path


def test_a_strangers_table_becomes_ours(
    mocap: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "poses.csv"
    columns = [
        f"--column={name}={header}"
        for name, header in zip(
            ["t", "p_x", "p_y", "p_z"], ("Time (ms)", "X [mm]", "Y [mm]", "Z [mm]"), strict=True
        )
    ]
    assert main(["convert", str(mocap), str(out), "--frame", "ned-frd", *columns]) == 0
    assert "50 rows over 0.49 s" in capsys.readouterr().out
    # (1, 2) m north and east, half a metre up.
    np.testing.assert_array_equal(kreisel.read(out).p_NB[0], [2.0, 1.0, 0.5])


def test_out_to_another_world(tmp_path: Path) -> None:
    t = np.arange(3) * 0.1
    rest = kreisel.ImuRecording(t, np.zeros((3, 3)), np.tile([0.0, 0.0, G], (3, 1)))
    kreisel.write(tmp_path / "a.csv", rest)
    assert main(["convert", str(tmp_path / "a.csv"), str(tmp_path / "b.npz"), "--to-frame", "ned-frd"]) == 0
    np.testing.assert_array_equal(kreisel.read(tmp_path / "b.npz").accel[0], [0.0, 0.0, -G])


def test_kitti_gets_its_times(tmp_path: Path) -> None:
    (tmp_path / "00.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n")
    (tmp_path / "times.txt").write_text("0.0\n1.037e-01\n")
    arguments = ["convert", str(tmp_path / "00.txt"), str(tmp_path / "00.tum")]
    assert main([*arguments, "--times", str(tmp_path / "times.txt")]) == 0
    np.testing.assert_array_equal(kreisel.read(tmp_path / "00.tum").t, [0.0, 0.1037])
    assert main([*arguments, "--input-rate", "10"]) == 0
    np.testing.assert_array_equal(kreisel.read(tmp_path / "00.tum").t, [0.0, 0.1])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["out.tun"], "Did you mean '.tum'"),
        (["out.tum", "--to-frame", "ned"], "Did you mean 'ned-frd'"),
        (["out.tum", "--frame", "enu"], "Did you mean 'enu-flu'"),
        (["nowhere/out.csv"], "does not exist"),
        (["out.csv", "--column", "t"], "--column takes NAME=HEADER"),
        (["out.tum", "--from", "tumm"], "Did you mean 'tum'"),
        (["out.tum", "--to", "kiti"], "Did you mean 'kitti'"),
    ],
)
def test_mistakes_are_one_line(
    arguments: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("in.csv").write_text("t,x,y,z\n0,1,2,3\n1,1,2,3\n")
    assert main(["convert", "in.csv", *arguments]) == (1 if "nowhere/out.csv" in arguments else 2)
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert [p.name for p in tmp_path.iterdir()] == ["in.csv"]


def test_info_says_what_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    t = np.delete(np.arange(200) / 100.0, [70, 71])
    n = len(t)
    kreisel.write(
        tmp_path / "imu.csv", kreisel.ImuRecording(t, np.zeros((n, 3)), np.tile([0, 0, 1.0], (n, 1)))
    )
    assert main(["info", str(tmp_path / "imu.csv")]) == 0
    report = capsys.readouterr().out
    assert "IMU recording: gyroscope, accelerometer" in report
    assert "100 Hz (median step 10 ms" in report
    assert "1; 30 ms after t = 0.69 s" in report
    assert "looks like g" in report


def test_info_for_machines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kreisel.write(tmp_path / "p.csv", kreisel.Poses(np.array([0.0]), np.zeros((1, 3))))
    kreisel.write(tmp_path / "q.csv", kreisel.Poses(np.arange(3.0), np.ones((3, 3)), t0_ns=10**18))
    assert main(["info", "--json", str(tmp_path / "p.csv"), str(tmp_path / "q.csv")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["schema"] == "kreisel.info/1"
    one, three = found["files"]
    assert one["clock"]["rate_hz"] is None
    assert three["clock"]["rate_hz"] == 1.0
    assert three["clock"]["t0_ns"] == 10**18
    assert three["noun"] == "Poses"


def test_standard_output_holds_the_data_and_nothing_else(mocap: Path, tmp_path: Path) -> None:
    poses = tmp_path / "poses.csv"
    poses.write_text("t,p_x,p_y,p_z\n0,1,2,3\n1,1,2,3\n")
    command = [sys.executable, "-m", "kreisel", "convert", str(poses), "/dev/stdout", "--to", "csv"]
    environment = {**os.environ, "PYTHONPATH": str(Path(kreisel.__file__).parents[1])}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stdout.splitlines()[0]) == (0, "t [s],p_x [m],p_y [m],p_z [m]")
    assert len(done.stdout.splitlines()) == 3
    assert done.stderr == "/dev/stdout: 2 rows over 1 s\n"


def test_a_folder_is_no_output(mocap: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kreisel.write(tmp_path / "a.csv", kreisel.Poses([0.0, 1.0], np.zeros((2, 3))))
    assert main(["convert", str(tmp_path / "a.csv"), f"{tmp_path}/b.csv/"]) == 2
    assert "b.csv/ is a folder: name the format of its files" in capsys.readouterr().err
