"""Attitude and references in files: what each format keeps, what `kind` makes of them, what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.maths.rotations import matrix_from_euler

HALF_TURN = "0.0,0.0,0.0,1.0"


def turning(n: int = 5) -> np.ndarray:
    phi = np.zeros((n, 3))
    phi[:, 2] = 0.1 * np.arange(n)
    return matrix_from_euler(phi)


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "in.csv"
    path.write_text(text)
    return path


def test_tum_has_zeros_for_positions_and_says_so(tmp_path: Path) -> None:
    path = tmp_path / "a.tum"
    kreisel.write(path, kreisel.AttitudeHistory(np.arange(5.0), turning()))
    remark, _, first, *_ = path.read_text().splitlines()
    assert remark == "# attitude only: the positions are zero"
    assert first.split()[:4] == ["0.0", "0.0", "0.0", "0.0"]
    assert isinstance(kreisel.read(path), kreisel.AttitudeHistory)
    # Another tool that drops comments leaves poses at the origin: the attitude is the same.
    path.write_text("\n".join(path.read_text().splitlines()[2:]) + "\n")
    assert isinstance(kreisel.read(path), kreisel.Poses)
    np.testing.assert_allclose(kreisel.read(path, kind="attitude").R_NS, turning(), atol=4e-15)


def test_a_body_at_rest_at_the_origin_stays_poses(tmp_path: Path) -> None:
    kreisel.write(tmp_path / "rest.tum", kreisel.Poses(np.arange(5.0), np.zeros((5, 3)), turning()))
    assert isinstance(kreisel.read(tmp_path / "rest.tum"), kreisel.Poses)


def test_a_table_of_times_and_quaternions_is_attitude(tmp_path: Path) -> None:
    path = written(
        tmp_path, f"t,qw,qx,qy,qz,gyro_bias_x [deg/s],gyro_bias_y,gyro_bias_z\n0,{HALF_TURN},180,0,0\n"
    )
    found = kreisel.read(path)
    assert isinstance(found, kreisel.AttitudeHistory)
    np.testing.assert_array_equal(found.R_NS[0], np.diag([-1.0, -1.0, 1.0]))
    np.testing.assert_allclose(found.gyro_bias, [[np.pi, 0.0, 0.0]])


def test_angles_of_a_strangers_archive_are_attitude(tmp_path: Path) -> None:
    phi = np.linspace(0.0, 0.4, 15).reshape(5, 3)
    np.savez(tmp_path / "a.npz", time=np.arange(5.0), euler=phi)
    found = kreisel.read(tmp_path / "a.npz")
    assert isinstance(found, kreisel.AttitudeHistory)
    np.testing.assert_array_equal(found.R_NS, matrix_from_euler(phi))


def test_a_loggers_own_quaternion_does_not_hide_its_imu(tmp_path: Path) -> None:
    header = "t,gx,gy,gz,ax,ay,az,qw,qx,qy,qz"
    path = written(tmp_path, f"{header}\n0,1,2,3,0,0,9.8,{HALF_TURN}\n")
    assert isinstance(kreisel.read(path), kreisel.ImuRecording)
    assert isinstance(kreisel.read(path, kind="attitude"), kreisel.AttitudeHistory)


def test_kinds_that_fit_are_converted_and_others_named(tmp_path: Path) -> None:
    kreisel.write(tmp_path / "p.npz", kreisel.Poses(np.arange(5.0), np.ones((5, 3)), turning(), t0_ns=7))
    found = kreisel.read(tmp_path / "p.npz", kind="attitude")
    assert isinstance(found, kreisel.AttitudeHistory) and found.t0_ns == 7
    np.testing.assert_array_equal(found.R_NS, turning())
    with pytest.raises(ValueError, match="holds poses, not a reference attitude"):
        kreisel.read(tmp_path / "p.npz", kind="reference")
    kreisel.write(tmp_path / "bare.csv", kreisel.Poses(np.arange(5.0), np.ones((5, 3))))
    with pytest.raises(ValueError, match="holds poses, not attitude over time"):
        kreisel.read(tmp_path / "bare.csv", kind="attitude")


def test_rows_that_do_not_count_may_hold_anything(tmp_path: Path) -> None:
    R = turning()
    R[1], R[2] = 0.0, np.nan
    counts = [True, False, False, True, True]
    kreisel.write(tmp_path / "r.csv", kreisel.Reference(np.arange(5.0), R, counts))
    found = kreisel.read(tmp_path / "r.csv")
    assert isinstance(found, kreisel.Reference)
    assert found.counts.tolist() == counts
    assert np.isnan(found.R_NS[1:3]).all()
    np.testing.assert_allclose(found.R_NS[found.counts], R[counts], atol=4e-15)


@pytest.mark.parametrize(
    ("header", "row", "message"),
    [
        ("counts", "nan,nan,nan,nan,1", "line 3, column 'q_w': the value is nan"),
        ("counts", f"{HALF_TURN},2", "line 3, column 'counts': 2 is neither 0 nor 1"),
        ("rest", f"{HALF_TURN},nan", "line 3, column 'rest': the value is nan"),
        ("rest", "nan,0,0,1,0", "line 3, column 'q_w': the value is nan"),
        ("rest", "0,0,0,2,0", "line 3, column 'q_w ... q_z': the quaternion has length 2"),
    ],
)
def test_unsound_rows_are_named(header: str, row: str, message: str, tmp_path: Path) -> None:
    path = written(tmp_path, f"t,q_w,q_x,q_y,q_z,{header}\n0,{HALF_TURN},1\n1,{row}\n")
    with pytest.raises(ValueError, match=message):
        kreisel.read(path)


def test_a_spread_of_positions_is_not_taken_for_ours(tmp_path: Path) -> None:
    path = written(tmp_path, "t,x,y,z,sigma_x [m],sigma_y [m],sigma_z [m]\n0,1,2,3,1,1,1\n")
    assert isinstance(kreisel.read(path), kreisel.Poses)
