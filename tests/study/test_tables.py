"""Waypoints and motion profiles in scenario files, written out or in a file of their own."""

import numpy as np
import pytest

from kreisel import Scenario
from kreisel.study.run import run

WAYPOINTS = """
rate_hz = 50.0
[trajectory]
kind = "waypoints"
max_speed = 4.0
max_acceleration = 2.0
points = [
  { position = [0, 0, 0], stop = 1.0 },
  { position = [10, 0, 1] },
  { position = [10, 10, 2], speed = 2, heading_deg = 90 },
]
"""
PROFILE = """
rate_hz = 50.0
[trajectory]
kind = "profile"
heading_deg = 90
[[trajectory.segments]]
do = "drive"
duration = 5
speed = 10
[[trajectory.segments]]
do = "turn"
angle_deg = -90
radius = 15.0
"""
IN_A_FILE = """
rate_hz = 50.0
[trajectory]
kind = "{kind}"
path = "{path}"
{more}
"""
GNSS = """\
ini lat (deg),ini lon (deg),ini alt (m),ini vx_body (m/s),ini vy,ini vz,ini yaw (deg),ini pitch,ini roll
32,120,0,10,0,0,90,0,0
command type,yaw (deg),pitch (deg),roll (deg),vx_body (m/s),vy,vz,command duration (s),GPS visibility
2,0,0,0,10,0,0,60,1
"""


@pytest.mark.parametrize("text", [WAYPOINTS, PROFILE])
def test_scenarios_survive_their_file(text):
    scenario = Scenario.from_toml(text)
    assert Scenario.from_toml(scenario.to_toml()) == scenario
    assert (
        run(scenario).motion.p_NB.tobytes()
        == run(Scenario.from_toml(scenario.to_toml())).motion.p_NB.tobytes()
    )


def test_tables_in_files_of_their_own(tmp_path):
    (tmp_path / "way.csv").write_text("x,y,z,stop,speed,heading [deg]\n0,0,0,1,,\n10,0,1,,,\n10,10,2,,2,90\n")
    (tmp_path / "drive.csv").write_text("do,duration,speed,angle [deg],radius\ndrive,5,10\nturn,,,-90,15\n")
    limits = "max_speed = 4.0\nmax_acceleration = 2.0"
    for text, kind, path, more in (
        (WAYPOINTS, "waypoints", "way.csv", limits),
        (PROFILE, "profile", "drive.csv", "heading_deg = 90"),
    ):
        scenario = Scenario.from_toml(IN_A_FILE.format(kind=kind, path=path, more=more), tmp_path)
        assert run(scenario).motion.p_NB.tobytes() == run(Scenario.from_toml(text)).motion.p_NB.tobytes()


def test_a_motion_definition_and_its_limits(tmp_path):
    (tmp_path / "def.csv").write_text(GNSS)
    text = IN_A_FILE.format(
        kind="profile", path="def.csv", more="max_rate = 0.5\nmax_angular_acceleration = 2.0"
    )
    motion = run(Scenario.from_toml(text, tmp_path)).motion
    # From east to north at half a radian a second, and 1.875 * 0.5 / 2 s of ramp.
    assert motion.t[-1] == pytest.approx(np.pi + 0.46875, abs=0.02)
    np.testing.assert_allclose(motion.euler[-1, 2], np.pi / 2.0, atol=1e-3)


@pytest.mark.parametrize(
    ("text", "old", "new", "message"),
    [
        (WAYPOINTS, "stop = 1.0", "stp = 1.0", r"trajectory.points\[0\].stp is unknown; did you mean 'stop'"),
        (WAYPOINTS, "[10, 0, 1]", "[10, 0]", r"trajectory.points\[1\].position\[2\] is missing"),
        (WAYPOINTS, "max_speed", "max_sped", "trajectory.max_sped is unknown; did you mean 'max_speed'"),
        (WAYPOINTS, "speed = 2,", "speed = 20,", "waypoint 3 of 3 is to be passed at 20 m/s, 16 above max_speed"),
        (WAYPOINTS, "rate_hz = 50.0", "", "rate_hz is missing; only a file has times of its own"),
        (WAYPOINTS, "points = [", 'path = "p.csv"\npoints = [', "both path and points say where to go"),
        (PROFILE, "radius", "raduis", r"trajectory.segments\[1\].raduis is unknown; did you mean 'radius'"),
        (PROFILE, '"turn"', '"trun"', "do of segment 2 must be one of .* Did you mean 'turn'"),
        (PROFILE, "duration = 5", "duration = '5'", r"trajectory.segments\[0\].duration must be a number; got '5'"),
        (PROFILE, "heading_deg = 90", "path = 3", "trajectory: both path and segments"),
    ],
)  # fmt: skip
def test_mistakes_are_named_with_their_key(text, old, new, message):
    with pytest.raises(ValueError, match=message):
        Scenario.from_toml(text.replace(old, new))
