"""`kreisel simulate --as waypoints` and `--as profile`."""

import re

import numpy as np
import pytest

from kreisel.cli.main import main
from kreisel.files.doors import read

MISSION = "x [m], y [m], z [m], stop [s], heading [deg]\n0,0,0,1,0\n10,0,2,,\n10,10,2,2,90\n"
DRIVE = "do, duration [s], speed [m/s], angle [deg]\ndrive,5,10\nturn,4,,90\nstop,3\n"
GNSS = """\
ini lat (deg),ini lon (deg),ini alt (m),ini vx_body (m/s),ini vy,ini vz,ini yaw (deg),ini pitch,ini roll
32,120,0,10,0,0,90,0,0
command type,yaw (deg),pitch (deg),roll (deg),vx_body (m/s),vy,vz,command duration (s),GPS visibility
1,-15,0,0,0,0,0,6,1
"""
LIMITS = ["--max-speed", "4", "--max-acceleration", "2"]


@pytest.fixture
def simulate(tmp_path, capsys):
    def run(text, *options):
        path = tmp_path / "path.csv"
        path.write_text(text, encoding="utf-8")
        code = main(["simulate", str(path), "-o", str(tmp_path / "out"), "--no-pictures", *options])
        out, err = capsys.readouterr()
        return code, out + err, tmp_path / "out"

    return run


def test_waypoints(simulate):
    code, text, out = simulate(MISSION, "--as", "waypoints", "--rate", "100", *LIMITS, "--banked", "--check")
    assert code == 0, text
    assert "3 waypoints over" in text
    assert "by the curve of least jerk" in text
    truth = read(out / "truth.npz", kind="motion")
    np.testing.assert_allclose(truth.p_NB[[0, -1]], [[0, 0, 0], [10, 10, 2]], atol=1e-9)
    assert np.linalg.norm(truth.v_NB, axis=1).max() <= 4.0
    still = read(out / "imu.csv", kind="imu")
    np.testing.assert_allclose(still.accel[:100], np.tile([0.0, 0.0, 9.80665], (100, 1)), atol=1e-12)


def test_waypoints_in_another_world(simulate):
    text = "x [m], y [m], z [m], heading [deg]\n0,0,0,0\n10,5,-2,90\n"
    code, _, out = simulate(text, "--as", "waypoints", "--rate", "50", *LIMITS, "--frame", "ned-frd")
    assert code == 0
    truth = read(out / "truth.npz", kind="motion")
    # 10 m north, 5 east and 2 up; first nose north, then east.
    np.testing.assert_allclose(truth.p_NB[-1], [5.0, 10.0, 2.0], atol=1e-3)
    np.testing.assert_allclose(truth.euler[[0, -1], 2], [np.pi / 2.0, 0.0], atol=1e-3)


def test_a_closed_path_is_gone_round_once(simulate):
    text = "x,y\n0,0\n10,0\n10,10\n"
    code, told, out = simulate(
        text, "--as", "waypoints", "--rate", "50", *LIMITS, "--closed", "--minimum", "snap"
    )
    assert code == 0
    assert "once round" in told
    truth = read(out / "truth.npz", kind="motion")
    assert np.linalg.norm(truth.p_NB[-1] - truth.p_NB[0]) < 0.1


def test_a_profile(simulate):
    code, text, out = simulate(DRIVE, "--as", "profile", "--rate", "100", "--heading", "90", "--ramp", "0.5")
    assert code == 0
    assert "3 segments in 12 s; at their end 0 m/s" in text
    truth = read(out / "truth.npz", kind="motion")
    np.testing.assert_allclose(truth.euler[[0, -1], 2], [np.pi / 2.0, np.pi], atol=1e-9)


def test_a_motion_definition(simulate):
    code, text, _ = simulate(GNSS, "--as", "profile", "--rate", "100")
    assert code == 0
    assert "1 command in 6 s; at their end 10 m/s" in text


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (MISSION, ["--as", "waypoints", *LIMITS], "--as waypoints needs a sampling rate: give --rate HZ"),
        (MISSION, ["--as", "waypoints", "--rate", "9"], "nothing says how fast to go from waypoint 1 of 3"),
        (MISSION, ["--as", "waypoint"], "--as must be one of .* Did you mean 'waypoints'"),
        (MISSION, [], "It looks like waypoints: say --as waypoints"),
        (DRIVE, [], "It looks like a motion profile: say --as profile"),
        (GNSS, [], "It looks like a motion profile: say --as profile"),
        (DRIVE, ["--as", "profile", "--rate", "9", "--closed"], "--closed does not apply to profile. Leave it out"),
        (MISSION, ["--as", "waypoints", "--rate", "9", "--method", "spline"], "--method does not apply to waypoints"),
        (MISSION, ["--as", "waypoints", "--rate", "9", "--from", "tum"], "--from does not apply to waypoints"),
        (GNSS, ["--as", "profile", "--rate", "9", "--banked"], "gnss-ins-sim: --banked does not apply"),
        (MISSION, ["--as", "waypoints", "--rate", "9", "--orientation", "level", *LIMITS], "points have headings"),
    ],
)  # fmt: skip
def test_mistakes_are_one_line(simulate, text, options, message):
    code, told, _ = simulate(text, *options)
    assert code == (1 if re.search("nothing says|looks like|points have", message) else 2)
    assert len(told.strip().splitlines()) == 1
    assert re.search(message, told), told
