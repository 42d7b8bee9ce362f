"""Paths through waypoints: through the points, within the limits, and with the attitude that was asked for."""

import numpy as np
import pytest

from kreisel import DcmFilter, Imu, Mount, Waypoint, WaypointTrajectory, round_trip, run, waypoints
from kreisel.evaluate.attitude_errors import attitude_errors
from kreisel.maths.polynomials import smoothest_through

GARDEN = np.array([[0.0, 0.0, 0.0], [3.0, 0.5, 0.5], [5.0, 3.0, 1.0], [3.0, 5.0, 1.5], [0.0, 4.0, 1.0]])
LIMITS = {"max_speed": 3.0, "max_acceleration": 4.0, "max_jerk": 30.0}
G = np.array([0.0, 0.0, 9.80665])


def dense(path, n=8001):
    first, last = path.span if np.isfinite(path.span).all() else (0.0, path.lap)
    return path.sample(np.linspace(first, last, n))


def jerk(motion):
    return np.gradient(motion.a_NB, motion.t, axis=0)[1:-1]


def largest(vectors):
    return np.linalg.norm(vectors, axis=1).max()


def force(motion):
    return np.einsum("nji,nj->ni", motion.R_NB, motion.a_NB + G)


WAYS = {
    "limits": {"max_speed": 3.0, "max_acceleration": 4.0},
    "jerk too": LIMITS,
    "speed alone": {"max_speed": 2.0},
    "acceleration alone": {"max_acceleration": 2.0},
    "stops": {**LIMITS, "stop": [1.0, 0.0, 2.0, 0.0, 0.5]},
    "speeds": {"speed": [1.0, 2.0, np.nan, 1.5, np.nan], "max_acceleration": 4.0},
    "all at one speed": {"speed": 2.0},
    "times": {"t": [0.0, 2.0, 4.0, 5.5, 9.0]},
    "times and stops": {"t": [0.0, 2.0, 4.0, 6.5, 9.0], "stop": [0.5, 0.0, 1.0, 0.0, 1.0]},
    "times and a speed": {"t": [0.0, 2.0, 4.0, 5.5, 9.0], "speed": [np.nan, 1.8, np.nan, np.nan, np.nan]},
    "headings": {**LIMITS, "orientation": [0.0, np.nan, 3.0, -3.0, 1.0], "stop": [0.0, 1.0, 0.0, 0.0, 0.0]},
    "headings and times": {"t": [0.0, 2.0, 4.0, 6.5, 9.0], "orientation": [0.0, 1.0, 3.0, -3.0, 1.0]},
    "round and round": {**LIMITS, "closed": True},
    "round with a stop": {**LIMITS, "closed": True, "stop": [0.0, 0.0, 1.0, 0.0, 0.0]},
    "round with a corner": {
        **LIMITS,
        "closed": True,
        "stop": [0.0, 0.0, 1.0, 0.0, 0.0],
        "orientation": [0.0, 1.0, 2.0, 3.0, -2.0],
    },
}


def path(way, **more):
    settings = {"t": None, **WAYS[way], **more}
    return WaypointTrajectory(settings.pop("t"), GARDEN, **settings)


@pytest.fixture(params=WAYS)
def way(request):
    return request.param


@pytest.fixture(params=["jerk", "snap"])
def minimum(request):
    return request.param


def test_the_path_passes_through_the_points(way, minimum):
    found = path(way, minimum=minimum)
    points = np.vstack([GARDEN, GARDEN[:1]]) if found.closed else GARDEN
    np.testing.assert_allclose(found.sample(found.arrivals).p_NB, points, rtol=0.0, atol=1e-9)
    if WAYS[way].get("t") is not None:
        np.testing.assert_array_equal(found.arrivals, WAYS[way]["t"])


def test_limits_hold_everywhere(way, minimum):
    motion = dense(path(way, minimum=minimum))
    found = {
        "max_speed": largest(motion.v_NB),
        "max_acceleration": largest(motion.a_NB),
        "max_jerk": largest(jerk(motion)),
    }
    for name, limit in WAYS[way].items():
        if name in found:
            assert found[name] <= limit, name


def test_limits_are_used_up():
    # Somewhere the speed or the acceleration comes within a hundredth of its limit.
    motion = dense(path("limits"))
    assert max(largest(motion.v_NB) / 3.0, largest(motion.a_NB) / 4.0) > 0.99


def test_everything_is_continuous_and_belongs_together(way, minimum):
    # A bank follows the acceleration: its own is continuous with least snap, and a nose along the path.
    bank = minimum == "snap" and "orientation" not in WAYS[way]
    motion = dense(path(way, minimum=minimum, banked=bank), 40001)
    h = motion.t[1] - motion.t[0]
    assert [note.kind for note in motion.notes] == ["method"]
    for value, rate, tolerance in (
        ("p_NB", "v_NB", 1e-5),
        ("v_NB", "a_NB", 5e-3),
        ("omega_NB_B", "alpha_NB_B", 2e-2),
    ):
        slope = np.diff(getattr(motion, value), axis=0) / h
        middle = 0.5 * (getattr(motion, rate)[1:] + getattr(motion, rate)[:-1])
        scale = 1.0 + np.abs(middle).max()
        # The trapezoidal rule errs by h^2 / 12 of a third derivative and, where that has a break, by h of a jump.
        np.testing.assert_allclose(slope, middle, rtol=0.0, atol=tolerance * scale, err_msg=value)


def test_speeds_and_stops_are_kept():
    found = path("speeds")
    speeds = np.linalg.norm(found.sample(found.arrivals).v_NB, axis=1)
    np.testing.assert_allclose(speeds[[0, 1, 3, 4]], [1.0, 2.0, 1.5, 0.0], atol=1e-9)
    still = path("stops")
    stands = still.sample(still.arrivals[2] + np.linspace(0.0, 2.0, 21))
    for name in ("v_NB", "a_NB", "omega_NB_B", "alpha_NB_B"):
        np.testing.assert_allclose(getattr(stands, name), 0.0, atol=1e-9, err_msg=name)
    # Held, and without a jump on either side.
    np.testing.assert_allclose(stands.R_NB, stands.R_NB[:1].repeat(21, axis=0), atol=1e-9)
    assert still.span[1] == still.arrivals[-1] + 0.5


def test_the_tangent_is_the_direction_of_the_path():
    motion = dense(path("limits"))
    moving = np.linalg.norm(motion.v_NB, axis=1) > 1e-3
    nose = motion.v_NB[moving] / np.linalg.norm(motion.v_NB[moving], axis=1)[:, None]
    np.testing.assert_allclose(motion.R_NB[moving, :, 0], nose, atol=1e-9)
    np.testing.assert_allclose(motion.R_NB[:, 2, 1], 0.0, atol=1e-12)
    level = dense(path("limits", orientation="level"))
    np.testing.assert_array_equal(level.R_NB[:, 2], np.tile([0.0, 0.0, 1.0], (len(level), 1)))
    np.testing.assert_allclose(level.euler[:, 2], motion.euler[:, 2], atol=1e-9)


def test_a_banked_body_feels_no_sideways_force(way):
    motion = dense(path(way, banked=True))
    np.testing.assert_allclose(force(motion)[:, 1], 0.0, atol=1e-12)
    assert (force(motion)[:, 2] > 0.0).all()


def test_a_closed_path_goes_on_as_it_began(minimum):
    found = path("round and round", minimum=minimum, banked=True)
    lap = found.lap
    assert found.span == (-np.inf, np.inf)
    t = np.linspace(0.1, lap - 0.1, 7)
    for shift in (lap, -3.0 * lap, 1000.0 * lap):
        for name in ("p_NB", "v_NB", "a_NB", "R_NB", "omega_NB_B", "alpha_NB_B"):
            here, there = getattr(found.sample(t), name), getattr(found.sample(t + shift), name)
            # A thousand laps are some 1e4 s, whose last digit is 2e-12 s.
            np.testing.assert_allclose(there, here, atol=1e-8, err_msg=name)
    seam = found.sample(np.array([lap - 1e-7, lap, lap + 1e-7]))
    for name in ("v_NB", "a_NB", "omega_NB_B"):
        np.testing.assert_allclose(np.diff(getattr(seam, name), axis=0), 0.0, atol=1e-5, err_msg=name)


def test_a_closed_path_may_repeat_its_first_point():
    once, twice = (
        path("round and round"),
        WaypointTrajectory(None, np.vstack([GARDEN, GARDEN[:1]]), closed=True, **LIMITS),
    )
    np.testing.assert_array_equal(once.arrivals, twice.arrivals)


def test_headings_are_met_by_the_shorter_way():
    heading = np.deg2rad([170.0, -170.0, np.nan, 100.0, 100.0])
    found = path("limits", orientation=heading)
    at = found.sample(found.arrivals).euler
    np.testing.assert_allclose(at[[0, 1, 3, 4], 2], heading[[0, 1, 3, 4]], atol=1e-9)
    motion = dense(found)
    assert np.ptp(np.unwrap(motion.euler[:, 2])) < np.deg2rad(111.0)
    np.testing.assert_array_equal(motion.euler[:, :2], 0.0)


def test_headings_round_a_closed_path_add_up():
    found = path("round and round", orientation=np.deg2rad([np.nan, 90.0, 180.0, -90.0, np.nan]))
    psi = np.unwrap(found.sample(np.linspace(0.0, 3.0 * found.lap, 601)).euler[:, 2])
    np.testing.assert_allclose(psi[-1] - psi[0], 6.0 * np.pi, atol=1e-9)
    assert np.diff(psi).min() > -1e-9


def test_with_headings_a_body_goes_straight_from_rest_to_rest():
    square = np.array([[0.0, 0.0, 2.0], [4.0, 0.0, 2.0], [4.0, 4.0, 2.0]])
    stops = {"stop": [0.0, 1.0, 0.0], "orientation": [0.0, np.pi / 2.0, np.pi]}
    timed = WaypointTrajectory([0.0, 4.0, 9.0], square, **stops)
    t = np.linspace(0.0, 4.0, 41)
    # Least jerk between two rests: 10 s^3 - 15 s^4 + 6 s^5 (Flash and Hogan 1985).
    s = t / 4.0
    np.testing.assert_allclose(
        timed.sample(t).p_NB[:, 0], 4.0 * (10 * s**3 - 15 * s**4 + 6 * s**5), atol=1e-12
    )
    fast = dense(WaypointTrajectory(None, square, max_acceleration=2.0, **stops))
    assert np.minimum(np.abs(fast.p_NB[:, 1]), np.abs(fast.p_NB[:, 0] - 4.0)).max() < 1e-12


@pytest.mark.parametrize("m", [3, 4])
def test_with_times_and_headings_the_path_is_the_classical_one(m):
    t, known = np.array([0.0, 2.0, 4.0, 6.5, 9.0]), np.full((5, m - 1, 3), np.nan)
    known[[0, -1]] = 0.0
    classical = smoothest_through(t, GARDEN, m, known=known)
    found = path("headings and times", minimum={3: "jerk", 4: "snap"}[m])
    times = np.linspace(0.0, 9.0, 91)
    p, v, a = classical(times, 2)
    motion = found.sample(times)
    for one, other in ((motion.p_NB, p), (motion.v_NB, v), (motion.a_NB, a)):
        np.testing.assert_allclose(one, other, atol=1e-12)


def test_a_straight_track_with_uneven_times_never_runs_back():
    track = np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0], [30.0, 0, 0], [31.0, 0, 0]])
    motion = dense(WaypointTrajectory([0.0, 1.0, 2.0, 3.0, 5.0], track))
    assert motion.v_NB[:, 0].min() > -1e-9


def test_strapdown_integration_of_the_ideal_recording_returns_the_path():
    found = path("stops", banked=True, minimum="snap")
    motion = found.sample(np.arange(0.0, found.span[1], 1e-3))
    imu = Imu(Mount([0.1, -0.05, 0.02]))
    errors = round_trip(imu.ideal(motion), motion.at(imu.mount))
    # A thousand samples a second leave 1e-5 rad of a motion whose rate bends where ramps begin.
    assert errors.attitude.max() < 1e-6
    assert errors.position.max() < 1e-4


def test_a_filter_follows_a_body_through_waypoints():
    found = path("stops", stop=[3.0, 0.0, 2.0, 0.0, 0.0])
    motion = found.sample(np.arange(0.0, found.span[1], 0.01))
    errors = attitude_errors(motion, run(DcmFilter(mode="6"), Imu().ideal(motion)))
    assert np.rad2deg(errors.inclination).max() < 3.0


def test_latitude_and_longitude():
    found = WaypointTrajectory.from_geodetic(
        None,
        [47.0, 47.001, 47.001],
        [8.0, 8.0, 8.001],
        [400.0, 420.0, 420.0],
        max_speed=10.0,
        max_acceleration=2.0,
    )
    np.testing.assert_allclose(found.position[1:], [[0.0, 111.18, 20.0], [76.06, 111.18, 20.0]], atol=5e-3)


def test_points_that_say_what_they_know():
    found = waypoints(
        [
            Waypoint((0.0, 0.0, 0.0), stop=1.0),
            Waypoint((5.0, 0.0, 1.0), speed=2.0),
            Waypoint((5.0, 5.0, 1.0), heading_deg=90.0),
        ],
        max_acceleration=3.0,
    )
    at = found.sample(found.arrivals)
    assert np.linalg.norm(at.v_NB[1]) == pytest.approx(2.0)
    # The only heading given holds throughout.
    np.testing.assert_allclose(at.euler[:, 2], np.pi / 2.0)
    places = waypoints(
        [Waypoint(latitude_deg=47.0, longitude_deg=8.0), Waypoint(latitude_deg=47.0001, longitude_deg=8.0)],
        max_speed=1,
    )
    assert places.position[1, 1] == pytest.approx(11.12, abs=0.01)


def given(t=None, points=GARDEN, **settings):
    return lambda: WaypointTrajectory(t, points, **settings)


NAN = np.nan
TRACK = np.array([[0.0, 0, 0], [4.0, 0, 0], [20.0, 0, 0], [40.0, 0, 0]])
BAD = {
    "one point": (given(points=GARDEN[:1]), "two waypoints or more; got 1"),
    "equal points": (
        given(points=GARDEN[[0, 1, 1, 2]], **LIMITS),
        r"waypoint 2 of 4 and the next are the same place.*stop",
    ),
    "NaN": (given(points=np.where(GARDEN == 5.0, NAN, GARDEN), **LIMITS), "position must be finite; row 2"),
    "turned": (
        given(points=np.zeros((3, 5)), **LIMITS),
        r"position must be \(n, 3\); got \(3, 5\). Did you mean position.T",
    ),
    "times run back": (
        given([0.0, 2.0, 1.0, 3.0, 4.0]),
        "t must increase strictly; it runs back from 2 to 1 s at row 2",
    ),
    "too few times": (given([0.0, 1.0]), "t must have one value per waypoint; got 2 for 5"),
    "no time for the stop": (
        given([0.0, 1.0, 2.0, 3.0, 4.0], stop=[0, 1.5, 0, 0, 0]),
        "waypoint 2 of 5: its stop of 1.5 s leaves no time",
    ),
    "stop and speed": (
        given(stop=[0, 1, 0, 0, 0], speed=[0, 2, 1, 1, 0], max_acceleration=2),
        "waypoint 2 of 5 has a stop of 1 s and a speed",
    ),
    "negative speed": (
        given(speed=[0, -2, 1, 1, 0], max_acceleration=2),
        "speed of waypoint 2 must be 0 or more",
    ),
    "degrees": (
        given(orientation=[0, 90, 180, 0, 0], **LIMITS),
        "headings are in rad.*waypoint 3 has 180. Are these degrees",
    ),
    "headings of others": (given(orientation=[0.0, 1.0], **LIMITS), "one heading per waypoint; got 2 for 5"),
    "no heading": (given(orientation=[NAN] * 5, **LIMITS), "no heading at all"),
    "orientation": (given(orientation="tangential", **LIMITS), "Did you mean 'tangent'"),
    "minimum": (given(minimum="jolt", **LIMITS), "minimum must be one of 'jerk', 'snap'"),
    "limit": (given(max_speed=0.0), "max_speed must be above 0"),
    "nothing": (given(), "nothing says how fast to go from waypoint 1 of 5 to the next"),
    "speed above the limit": (
        given(speed=[0, 5, NAN, NAN, 0], **LIMITS),
        "waypoint 2 of 5 is to be passed at 5 m/s, 2 above max_speed = 3",
    ),
    "too fast in a bend": (
        given(speed=[NAN, NAN, 6.0, NAN, NAN], max_acceleration=4.0),
        r"waypoint 3 of 5 is to be passed at 6 m/s: in the bend there that takes 22.99 m/s\^2, "
        "19 above max_acceleration = 4, which allows 2.503",
    ),
    "too far apart": (
        given(points=TRACK, speed=[0, 10, NAN, 0], max_acceleration=12.0),
        # 1.5 v^2 / 2 a of a ramp of least jerk.
        "waypoint 2 of 4 cannot be reached within the limits: from 0 m/s at waypoint 1 of 4 to 10 m/s "
        r"takes 6.25\d* m, "
        r"2.2\d more than the 4 m between them",
    ),
    "times against the limit": (
        given([0.0, 1.0, 2.0, 3.0, 4.0], max_speed=3.0),
        "from waypoint 1 of 5 to the next the speed reaches .* above max_speed = 3. "
        "The leg takes 1 s .* would need about",
    ),
    "speed against the times": (
        given([0.0, 2.0, 4.0, 6.0, 8.0], speed=[NAN, 20.0, NAN, NAN, NAN]),
        r"waypoint 1 of 5 to the next .* 3.082 m in the time given, 1.541 m/s.* at 20 m/s",
    ),
    "closed with two": (
        given(points=GARDEN[:2], closed=True, **LIMITS),
        "a closed path needs three different waypoints; got 2",
    ),
    "closed without the return": (
        given([0, 1, 2, 3, 4.0], closed=True),
        "give the first waypoint again as the last",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_what_cannot_be_is_one_clear_sentence(case):
    make, message = BAD[case]
    with pytest.raises(ValueError, match=message) as caught:
        make()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("latitude", "longitude", "message"),
    [
        (
            [47.0, 120.0],
            [8.0, 8.0],
            "latitude of waypoint 2 must lie between -90 and 90 deg; got 120. Are latitude and",
        ),
        (
            [47.0, 8.0],
            [8.0, 47.0],
            r"waypoint 2 at latitude 8, longitude 47 deg is .* km from the first. Are latitude",
        ),
        ([47.0, 47.0], [8.0, 400.0], "longitude of waypoint 2 must lie between -360 and 360"),
        ([47.0, NAN], [8.0, 8.0], "latitude_deg must be finite; row 1"),
        ([47.0, 47.0], [8.0], "longitude_deg must have one value per waypoint"),
    ],
)
def test_places_that_are_none_are_named(latitude, longitude, message):
    with pytest.raises(ValueError, match=message):
        WaypointTrajectory.from_geodetic(None, latitude, longitude, max_speed=5.0)


def test_points_that_say_too_little_or_too_much():
    here, there = Waypoint((0.0, 0.0, 0.0)), Waypoint((5.0, 0.0, 0.0), t=3.0)
    with pytest.raises(ValueError, match="waypoint 1 has no t while others have"):
        waypoints([here, there])
    with pytest.raises(ValueError, match="waypoint 2 needs either a position or a latitude_deg"):
        waypoints([here, Waypoint(latitude_deg=3.0)], max_speed=1.0)
    with pytest.raises(ValueError, match="some waypoints have positions and others latitudes"):
        waypoints([here, Waypoint(latitude_deg=3.0, longitude_deg=4.0)], max_speed=1.0)
    with pytest.raises(ValueError, match="heading_deg of waypoint 2 must lie between -360 and 360; got 900"):
        waypoints([here, Waypoint((5.0, 0.0, 0.0), heading_deg=900.0)], max_speed=1.0)
    with pytest.raises(ValueError, match="points have headings"):
        waypoints([here, Waypoint((5.0, 0.0, 0.0), heading_deg=9.0)], "level", max_speed=1.0)
