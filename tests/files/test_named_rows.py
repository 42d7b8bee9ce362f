"""Tables of waypoints, of segments and of gnss-ins-sim's commands, sound and not."""

import numpy as np
import pytest

from kreisel import MotionDefinition, Segment, Waypoint, read_profile, read_waypoints
from kreisel.data.motion_definition import Command

GNSS = """\
ini lat (deg),ini lon (deg),ini alt (m),ini vx_body (m/s),ini vy,ini vz,ini yaw (deg),ini pitch,ini roll
32,120,5,10,0,0,90,1,2
command type,yaw (deg),pitch (deg),roll (deg),vx_body (m/s),vy,vz,command duration (s),GPS visibility
1,-15,0,0,0,0,0,6,1
5,0,45,0,10,,,250,0
"""


@pytest.fixture
def file(tmp_path):
    def written(text):
        path = tmp_path / "table.csv"
        path.write_text(text, encoding="utf-8")
        return path

    return written


def test_waypoints_in_metres(file):
    path = file(
        "x [m], y [cm], z, t [s], speed [km/h], stop, heading [deg]\n0, 0, 0, 0, , 2,\n# on\n3,400,1,5,36,,-90\n"
    )
    assert read_waypoints(path) == (
        Waypoint((0.0, 0.0, 0.0), t=0.0, stop=2.0),
        Waypoint((3.0, 4.0, 1.0), t=5.0, speed=10.0, heading_deg=-90.0),
    )


def test_waypoints_by_latitude_and_compass(file):
    path = file("lat;lon;alt;course [deg]\n47.1;8.2;400;0\n47.2;8.3;;270\n")
    first, second = read_waypoints(path)
    assert (first.latitude_deg, first.longitude_deg, first.height_m) == (47.1, 8.2, 400.0)
    # North is 90 deg from east; a course of west is a heading of half a turn.
    assert first.heading_deg == 90.0
    assert second.heading_deg == -180.0
    assert second.height_m == 0.0


def test_radians_are_known_by_their_unit(file):
    (point, _) = read_waypoints(file("x,y,yaw [rad]\n0,0,1.5707963267948966\n1,0,0\n"))
    assert point.heading_deg == pytest.approx(90.0)


def test_segments(file):
    path = file(
        "do, duration [s], speed [km/h], angle [deg], rate [rad/s], height\nDrive,10,36\nturn,,,-90,0.5\nclimb,5,,,,3\n"
    )
    drive, turn, climb = read_profile(path)
    assert drive == Segment("drive", duration=10.0, speed=10.0)
    assert turn == Segment("turn", angle_deg=-90.0, rate_deg_s=pytest.approx(np.rad2deg(0.5)))
    assert climb == Segment("climb", duration=5.0, height=3.0)


def test_a_motion_definition(file):
    found = read_profile(file(GNSS))
    assert found == MotionDefinition(
        (
            Command(1, (-15.0, 0.0, 0.0), (0.0, 0.0, 0.0), 6.0),
            Command(5, (0.0, 45.0, 0.0), (10.0, 0.0, 0.0), 250.0),
        ),
        (10.0, 0.0, 0.0),
        (90.0, 1.0, 2.0),
        32.0,
        120.0,
        5.0,
        "table",
    )


BAD_WAYPOINTS = {
    "speeed": ("x,y,speeed\n0,0,1\n", "no use for a column 'speeed'. Did you mean 'speed'"),
    "twice": ("x,y,x\n0,0,1\n", "has two columns for x"),
    "unit": ("x [furlong],y\n0,1\n", "column 'x': 'furlong' is no unit of length"),
    "no unit": ("x,y,heading\n0,1,2\n", r"column 'heading' has no unit. Write it as heading \[deg\]"),
    "word": ("x,y\n0,1\n2,three\n", "line 3, column 'y': 'three' is not a number"),
    "long": ("x,y\n0,1,2\n", "line 2: 3 fields where 2 are expected"),
    "no rows": ("x,y\n", "has a header but no rows below it"),
    "no place": ("t,speed\n1,2\n", "line 2: no place. Needed are x and y, or latitude and longitude"),
    "half a place": ("x,y\n1,\n", "line 2: x and y are needed"),
    "two noses": ("x,y,heading [deg],compass [deg]\n1,2,3,4\n", "both a heading and a compass course"),
    "empty": ("", "is empty"),
}


@pytest.mark.parametrize("case", BAD_WAYPOINTS)
def test_bad_tables_of_waypoints_are_named(case, file):
    text, message = BAD_WAYPOINTS[case]
    with pytest.raises(ValueError, match=message):
        read_waypoints(file(text))


BAD_PROFILES = {
    "nothing to do": ("do,duration [s]\n,3\n", "line 2, column 'do': nothing to do"),
    "no commands": ("\n".join([*GNSS.split("\n")[:3], ""]), "it has no commands below its third line"),
    "fields": (GNSS + "1,2,3\n", "line 6: 3 fields where 9 are expected"),
    "kind": (GNSS + "6,0,0,0,0,0,0,1,0\n", "line 6: command type 6 is none; there are 1 to 5"),
    "duration": (GNSS + "1,0,0,0,0,0,0,0,0\n", "line 6: a command needs a duration above 0; got 0 s"),
    "number": (GNSS + "1,x,0,0,0,0,0,1,0\n", "line 6: 'x' is not a number"),
}


@pytest.mark.parametrize("case", BAD_PROFILES)
def test_bad_profiles_are_named(case, file):
    text, message = BAD_PROFILES[case]
    with pytest.raises(ValueError, match=message):
        read_profile(file(text))


def test_a_file_that_is_not_there(tmp_path):
    for read in (read_waypoints, read_profile):
        with pytest.raises(FileNotFoundError, match=r"cannot read .*nothing.csv"):
            read(tmp_path / "nothing.csv")
