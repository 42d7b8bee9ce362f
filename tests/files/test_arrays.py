"""Boxes of named arrays that others made: MATLAB users' variables and bare NPZ archives."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat, savemat

import kreisel
from kreisel.maths.rotations import matrix_from_euler

T = np.arange(5) * 0.1
S = np.arange(15.0).reshape(5, 3)
PHI = S / 20.0


def mat(folder: Path, **variables: Any) -> Path:
    savemat(folder / "theirs.mat", variables)
    return folder / "theirs.mat"


@pytest.mark.parametrize("t", [T, T[:, None], T[None, :]])
@pytest.mark.parametrize("s", [S, S.T])
def test_the_document_s_names(tmp_path: Path, t: np.ndarray, s: np.ndarray) -> None:
    """s and phi over t, time as row or column, vectors (n, 3) or (3, n)."""
    data = kreisel.read(mat(tmp_path, t=t, s=s, phi=PHI), kind="poses")
    np.testing.assert_array_equal(data.t, T)
    np.testing.assert_array_equal(data.p_NB, S)
    np.testing.assert_array_equal(data.R_NB, matrix_from_euler(PHI))


def test_a_rate_stands_in_for_time(tmp_path: Path) -> None:
    path = mat(tmp_path, gyr=S, acc=S, Fs=50.0)
    np.testing.assert_array_equal(kreisel.read(path, kind="imu").t, np.arange(5) / 50.0)
    assert kreisel.read(path, kind="imu", rate_hz=10.0).t[-1] == 0.4


def test_orientation_is_matlabs_frame_rotation(tmp_path: Path) -> None:
    """MathWorks' example of rotateframe: turned by 45 degrees, (0.5, 0.5, 0) is (0.7071, 0, 0)."""
    half = np.pi / 8
    q = np.tile([np.cos(half), 0.0, 0.0, np.sin(half)], (5, 1))
    as_quaternion = kreisel.read(mat(tmp_path, t=T, position=S, orientation=q), kind="poses")
    v_B = as_quaternion.R_NB[0].T @ [0.5, 0.5, 0.0]
    np.testing.assert_allclose(v_B, [np.sqrt(0.5), 0.0, 0.0], atol=1e-15)
    # rotmat(q, 'frame') of the same rotation, as pages.
    c = np.sqrt(0.5)
    frame = np.repeat(np.array([[c, c, 0.0], [-c, c, 0.0], [0.0, 0.0, 1.0]])[:, :, None], 5, axis=2)
    as_pages = kreisel.read(mat(tmp_path, t=T, position=S, orientation=frame), kind="poses")
    np.testing.assert_allclose(as_pages.R_NB, as_quaternion.R_NB, atol=1e-15)


def test_matlab_sees_columns_and_pages(tmp_path: Path) -> None:
    data = kreisel.Poses(T, S, matrix_from_euler(PHI), t0_ns=1403715524907143168)
    kreisel.write(tmp_path / "ours.mat", data)
    seen = loadmat(tmp_path / "ours.mat")
    assert seen["t"].shape == (5, 1)
    assert seen["R_NB"].shape == (3, 3, 5)
    np.testing.assert_array_equal(seen["R_NB"][:, :, 2], data.R_NB[2])
    assert seen["t0_ns"].dtype == np.int64
    assert int(seen["t0_ns"][0, 0]) == 1403715524907143168


def test_a_bare_array_under_the_name_of_an_archive_is_no_archive(tmp_path: Path) -> None:
    np.save(tmp_path / "x.npy", S)
    (tmp_path / "x.npy").rename(tmp_path / "x.npz")
    with pytest.raises(ValueError, match=r"x\.npz is one bare array \(\.npy\)"):
        kreisel.read(tmp_path / "x.npz")


def test_a_bare_npz_is_read_by_its_names(tmp_path: Path) -> None:
    np.savez(tmp_path / "x.npz", t=T, gyro=S, accel=S)
    assert isinstance(kreisel.read(tmp_path / "x.npz"), kreisel.ImuRecording)


def test_pickled_objects_are_never_loaded(tmp_path: Path) -> None:
    np.savez(tmp_path / "x.npz", t=np.array([{"a": 1}], dtype=object))
    with pytest.raises(ValueError, match="pickled objects, which are never loaded"):
        kreisel.read(tmp_path / "x.npz")


@pytest.mark.parametrize(
    ("variables", "message"),
    [
        ({"a": S}, r"needs positions .* it has: a\."),
        ({"t": T, "s": S[:, :2]}, r"variable 's' must be \(n, 3\); got \(5, 2\)"),
        ({"t": T[:4], "s": S}, "one row per time stamp"),
        ({"s": S}, "has no time"),
        ({"t": T, "s": "text"}, "variable 's' does not hold numbers"),
        ({"t": T, "s": np.full((5, 3), np.nan)}, "p_NB must be finite; row 0"),
        ({"t": T[::-1], "s": S}, "runs back"),
        ({"t": T, "s": S, "quat": np.ones((5, 4))}, "row 0 has length 2"),
        ({"t": T, "s": S, "R_NB": 2.0 * np.repeat(np.eye(3)[:, :, None], 5, axis=2)}, "rotation matrices"),
        ({"t": T, "s": S, "gyro": S, "accel": S}, "Say which: kind"),
    ],
)
def test_a_box_that_makes_no_sense_names_file_and_variable(
    tmp_path: Path, variables: dict[str, Any], message: str
) -> None:
    path = mat(tmp_path, **variables)
    with pytest.raises(ValueError, match=message) as caught:
        kreisel.read(path)
    assert str(caught.value).startswith(str(path))


def test_a_later_schema_is_refused_by_its_number(tmp_path: Path) -> None:
    kreisel.write(tmp_path / "x.npz", kreisel.Poses(T, S))
    with np.load(tmp_path / "x.npz") as archive:
        arrays = dict(archive)
    arrays["kreisel_schema"] = np.array("Poses 9: t p_NB")
    np.savez(tmp_path / "x.npz", **arrays)
    with pytest.raises(ValueError, match="schema 'Poses 9'"):
        kreisel.read(tmp_path / "x.npz")


def test_hdf5_mat_files_are_told_apart(tmp_path: Path) -> None:
    (tmp_path / "new.mat").write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512))
    with pytest.raises(ValueError, match="-v7"):
        kreisel.read(tmp_path / "new.mat")
