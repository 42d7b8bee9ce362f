"""KITTI trajectories: twelve numbers, no time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kreisel

# Six printed digits, as the odometry ground truth has them.
PRINTED = "9.999978e-01 5.272628e-04 -2.066935e-03 -4.690294e-02 -5.296506e-04 9.999992e-01 -1.154865e-03 -2.839928e-02 2.066324e-03 1.155958e-03 9.999971e-01 8.586941e-01"  # noqa: E501


def test_printed_matrices_come_back_onto_so3(tmp_path: Path) -> None:
    (tmp_path / "00.txt").write_text(f"1 0 0 0 0 1 0 0 0 0 1 0\n{PRINTED}\n")
    data = kreisel.read(tmp_path / "00.txt", rate_hz=10.0)
    assert isinstance(data, kreisel.Poses)
    assert data.R_NB is not None
    np.testing.assert_allclose(data.R_NB[1].T @ data.R_NB[1], np.eye(3), atol=1e-15)
    assert data.R_NB[1, 2, 0] == pytest.approx(2.066324e-3, abs=1e-6)
    np.testing.assert_array_equal(data.p_NB[1], [-4.690294e-02, -2.839928e-02, 8.586941e-01])


@pytest.mark.parametrize(
    ("rows", "options", "message"),
    [
        (["1 0 0 0 0 1 0 0 0 0 1 0"] * 2, {}, "holds no time. Give rate_hz"),
        (["1 0 0 0 0 1 0 0 0 0 1 0", "1 0 0 0 0 1 0 0 0 0 2 0"], {"rate_hz": 1.0}, "line 2: .*no rotation"),
        (["1 0 0 0 0 1 0 0 0 0 -1 0"], {"rate_hz": 1.0}, "line 1: .*it mirrors"),
        (["1 0 0 0 0 1 0 0 0 0 1 0"], {"rate_hz": -1.0}, "rate_hz must be positive"),
    ],
)
def test_mistakes_name_their_line(
    tmp_path: Path, rows: list[str], options: dict[str, float], message: str
) -> None:
    (tmp_path / "x.kitti").write_text("\n".join(rows) + "\n")
    with pytest.raises(ValueError, match=message):
        kreisel.read(tmp_path / "x.kitti", **options)


def test_times_must_match_the_poses(tmp_path: Path) -> None:
    (tmp_path / "x.kitti").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
    (tmp_path / "times.txt").write_text("0\n1\n")
    with pytest.raises(ValueError, match="2 stamps for the 1 poses"):
        kreisel.read(tmp_path / "x.kitti", times=tmp_path / "times.txt")
