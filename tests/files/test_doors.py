"""One door in, one door out: the format by name, suffix or content, and errors that teach."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.files.doors import format_names

POSES = kreisel.Poses(
    t=np.arange(5) * 0.1, p_NB=np.arange(15.0).reshape(5, 3), R_NB=np.tile(np.eye(3), (5, 1, 1))
)
IMU = kreisel.ImuRecording(t=np.arange(5) * 0.1, gyro=np.ones((5, 3)), accel=np.full((5, 3), 9.0))


def test_content_decides_where_the_suffix_says_nothing(tmp_path: Path) -> None:
    for name in ("csv", "tum", "euroc", "npz"):
        path = tmp_path / f"{name}.txt"
        kreisel.write(path, POSES, name)
        np.testing.assert_array_equal(kreisel.read(path).p_NB, POSES.p_NB)


def test_a_euroc_file_may_be_called_csv(tmp_path: Path) -> None:
    kreisel.write(tmp_path / "imu0.csv", IMU, "euroc-imu")
    assert isinstance(kreisel.read(tmp_path / "imu0.csv"), kreisel.ImuRecording)


def test_format_names_are_what_users_type() -> None:
    assert {"csv", "tum", "euroc", "euroc-imu", "npz"} <= set(format_names())


@pytest.mark.parametrize(
    ("path", "options", "message"),
    [
        ("out.tun", {}, r"Did you mean '\.tum'"),
        ("out", {"format": "eurok"}, "Did you mean 'euroc'"),
        ("missing/out.csv", {}, "folder .*missing does not exist"),
    ],
)
def test_writing_elsewhere_is_explained(
    tmp_path: Path, path: str, options: dict[str, str], message: str
) -> None:
    with pytest.raises((ValueError, OSError), match=message):
        kreisel.write(tmp_path / path, POSES, **options)


def test_a_missing_file_suggests_its_neighbour(tmp_path: Path) -> None:
    (tmp_path / "poses.csv").write_text("t,x\n")
    with pytest.raises(FileNotFoundError, match=r"Did you mean 'poses\.csv'"):
        kreisel.read(tmp_path / "pose.csv")


def test_kind_is_insisted_on(tmp_path: Path) -> None:
    kreisel.write(tmp_path / "imu.csv", IMU)
    with pytest.raises(ValueError, match="holds an IMU recording, not poses"):
        kreisel.read(tmp_path / "imu.csv", kind="poses")


def test_options_that_do_not_apply_are_refused(tmp_path: Path) -> None:
    kreisel.write(tmp_path / "p.tum", POSES)
    with pytest.raises(ValueError, match="rate_hz does not apply to the format 'tum'"):
        kreisel.read(tmp_path / "p.tum", rate_hz=100.0)


def test_an_unknown_file_lists_the_formats(tmp_path: Path) -> None:
    (tmp_path / "x.dat").write_text("1 2 3\n4 5 6\n")
    with pytest.raises(ValueError, match="cannot tell the format"):
        kreisel.read(tmp_path / "x.dat")
