"""Real recordings through the doors: every nanosecond and every digit they were published with."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.data.facts import facts
from kreisel.files.stamps import to_nanoseconds

EUROC = ("poses/euroc_V1_02_groundtruth.csv", "poses/euroc_V1_02_imu.txt")
TUM = "poses/tum_freiburg1_xyz_groundtruth.txt"


def printed_stamps(path: Path, delimiter: str | None) -> list[str]:
    return [line.split(delimiter)[0] for line in path.read_text().splitlines() if line and line[0] != "#"]


def test_euroc_is_found_out_by_content(shared_data: Path) -> None:
    poses, imu = (kreisel.read(shared_data / name) for name in EUROC)
    assert isinstance(poses, kreisel.Poses)
    assert isinstance(imu, kreisel.ImuRecording)
    assert poses.v_NB is not None
    # 1e-6 in the last of seven columns: the numbers are those printed.
    np.testing.assert_array_equal(poses.p_NB[0], [0.515356, 1.996773, 0.971104])
    assert facts(imu).clock.rate_hz == pytest.approx(200.0, rel=1e-4)
    assert facts(imu).doubts == ()


@pytest.mark.parametrize("name", EUROC)
@pytest.mark.parametrize("through", ["csv", "npz", "mat"])
def test_euroc_stamps_survive_exactly(shared_data: Path, name: str, through: str, tmp_path: Path) -> None:
    expected = [int(text) for text in printed_stamps(shared_data / name, ",")]
    kreisel.write(tmp_path / f"x.{through}", kreisel.read(shared_data / name))
    back = kreisel.read(tmp_path / f"x.{through}")
    assert to_nanoseconds(back.t, back.t0_ns).tolist() == expected


def test_euroc_through_tum_and_home_again(shared_data: Path, tmp_path: Path) -> None:
    truth = kreisel.read(shared_data / EUROC[0])
    kreisel.write(tmp_path / "x.tum", truth)
    back = kreisel.read(tmp_path / "x.tum")
    assert (back.t0_ns, back.t.tobytes()) == (truth.t0_ns, truth.t.tobytes())
    kreisel.write(tmp_path / "home.csv", truth, "euroc")
    printed = printed_stamps(shared_data / EUROC[0], ",")
    assert printed_stamps(tmp_path / "home.csv", ",") == printed


def test_tum_stamps_survive_exactly(shared_data: Path, tmp_path: Path) -> None:
    data = kreisel.read(shared_data / TUM)
    assert isinstance(data, kreisel.Poses)
    kreisel.write(tmp_path / "x.tum", data)
    # Four decimals printed by them, nine by us.
    ours = [text[:-5] for text in printed_stamps(tmp_path / "x.tum", None)]
    assert ours == printed_stamps(shared_data / TUM, None)
    assert facts(data).clock.gaps[0].length == pytest.approx(0.11, abs=1e-3)


def test_evo_reads_our_tum_and_euroc_files(shared_data: Path, tmp_path: Path) -> None:
    file_interface = pytest.importorskip("evo.tools.file_interface", reason="evo is not installed")
    data = kreisel.read(shared_data / EUROC[0], kind="poses")
    kreisel.write(tmp_path / "x.tum", data)
    kreisel.write(tmp_path / "x.csv", data, "euroc")
    for trajectory in (
        file_interface.read_tum_trajectory_file(tmp_path / "x.tum"),
        file_interface.read_euroc_csv_trajectory(tmp_path / "x.csv"),
    ):
        np.testing.assert_array_equal(trajectory.positions_xyz, data.p_NB)
        assert data.R_NB is not None
        # evo keeps quaternions; its matrices come from them by another formula.
        R = np.array(trajectory.poses_se3)[:, :3, :3]
        np.testing.assert_allclose(R, data.R_NB, atol=1e-14)


def test_a_matlab_user_s_recording_is_understood(shared_data: Path) -> None:
    path = next(iter(sorted((shared_data / "broad").glob("*.mat"))))
    data = kreisel.read(path, kind="imu")
    assert isinstance(data, kreisel.ImuRecording)
    what = facts(data)
    assert what.clock.rate_hz == pytest.approx(2000 / 7)
    assert what.doubts == ()
