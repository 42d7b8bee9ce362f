"""Motion profiles: every segment does what it says, and the joints between them are smooth."""

import numpy as np
import pytest

from kreisel import Imu, MotionProfile, Mount, Segment, profile, round_trip
from kreisel.simulate.trajectories.profile.segments import TAKES

G = np.array([0.0, 0.0, 9.80665])


def S(do, **what):
    return Segment(do, **what)


BLOCK = [
    S("rest", duration=2.0),
    S("drive", duration=10.0, speed=10.0, acceleration=2.0),
    S("turn", angle_deg=90.0, radius=20.0),
    S("climb", height=6.0, climb_rate=1.5),
    S("turn", angle_deg=-60.0, rate_deg_s=20.0, height=-2.0),
    S("drive", distance=50.0),
    S("stop", acceleration=2.5),
    S("turn", angle_deg=180.0, duration=4.0),
]


def dense(trajectory, n=8001):
    return trajectory.sample(np.linspace(0.0, trajectory.span[1], n))


def test_segments_do_what_they_say():
    made = MotionProfile(BLOCK, heading=np.pi / 2.0)
    ends = made.sample(made.ends)
    speed = np.hypot(*ends.v_NB[:, :2].T)
    np.testing.assert_allclose(speed, [0, 10, 10, 10, 10, 10, 0, 0], atol=1e-12)
    heading = np.rad2deg(np.unwrap(ends.euler[:, 2]))
    np.testing.assert_allclose(heading, [90, 90, 180, 180, 120, 120, 120, 300], atol=1e-9)
    np.testing.assert_allclose(ends.p_NB[:, 2], [0, 0, 0, 6, 4, 4, 4, 4], atol=1e-12)
    lasting = np.diff(made.ends, prepend=0.0)
    # A turn at 10 m/s and 20 m: 0.5 rad/s, and a second of ramps; 50 m at 10 m/s; 10 / 2.5 s and a second.
    expected = [2.0, 10.0, np.pi + 1.0, 5.0, 4.0, 5.0, 5.0, 4.0]
    np.testing.assert_allclose(lasting, expected, atol=1e-12)


def test_rates_and_radii_are_the_most():
    made = MotionProfile(BLOCK)
    t = np.linspace(0.0, made.span[1], 4001)
    motion = made.sample(t)
    rates = [
        np.abs(motion.omega_NB_B[(t > a) & (t < b), 2]).max()
        for a, b in zip(made.ends[:-1], made.ends[1:], strict=True)
    ]
    assert rates[1] == pytest.approx(0.5, rel=1e-6)
    assert np.rad2deg(rates[3]) == pytest.approx(20.0, rel=2e-2)  # the nose is down by 5 deg on the way
    assert np.linalg.norm(motion.a_NB[t < made.ends[1]], axis=1).max() == pytest.approx(2.0, rel=1e-6)
    assert np.linalg.norm(motion.v_NB[:, 2:], axis=1).max() == pytest.approx(1.5, rel=1e-6)


def test_a_quarter_circle_ends_where_geometry_says():
    # Ramps of no length to speak of: an arc of 20 m.
    made = MotionProfile([S("turn", angle_deg=90.0, radius=20.0)], speed=10.0, ramp=1e-4)
    end = made.sample(made.ends)
    # During a ramp of 0.1 ms at either end the body is late by half of it: 0.5 mm.
    np.testing.assert_allclose(end.p_NB[0], [20.0, 20.0, 0.0], atol=1.1e-3)


def test_the_end_is_told():
    note = (
        MotionProfile([S("drive", duration=3.0)], speed=2.0, heading=np.pi / 2.0)
        .sample(np.array([0.0]))
        .notes[0]
    )
    assert note.text == "1 segment in 3 s; at their end 2 m/s at (0, 6, 0) m, heading 90 deg"


@pytest.mark.parametrize("settings", [{}, {"banked": True}, {"orientation": "level"}])
def test_everything_is_continuous_and_belongs_together(settings):
    motion = dense(MotionProfile(BLOCK, **settings), 40001)
    h = motion.t[1]
    for value, rate in (("p_NB", "v_NB"), ("v_NB", "a_NB"), ("omega_NB_B", "alpha_NB_B")):
        slope = np.diff(getattr(motion, value), axis=0) / h
        middle = 0.5 * (getattr(motion, rate)[1:] + getattr(motion, rate)[:-1])
        # Where a ramp begins or ends the next derivative sets in: h / 8 of up to 40 a second.
        np.testing.assert_allclose(slope, middle, rtol=0.0, atol=5.0 * h, err_msg=value)
    for name in ("a_NB", "alpha_NB_B"):
        # No step from row to row: what changes does so at some 30 a second at most.
        assert np.abs(np.diff(getattr(motion, name), axis=0)).max() < 40.0 * h, name


def test_the_nose_follows_the_path_and_banks():
    motion = dense(MotionProfile(BLOCK, banked=True))
    moving = np.linalg.norm(motion.v_NB, axis=1) > 1e-6
    nose = motion.v_NB[moving] / np.linalg.norm(motion.v_NB[moving], axis=1)[:, None]
    np.testing.assert_allclose(motion.R_NB[moving, :, 0], nose, atol=1e-9)
    force = np.einsum("nji,nj->ni", motion.R_NB, motion.a_NB + G)
    np.testing.assert_allclose(force[:, 1], 0.0, atol=1e-12)


def test_a_body_can_turn_on_the_spot_and_rise_when_level():
    made = MotionProfile(
        [S("climb", height=3.0, duration=2.0), S("turn", angle_deg=45.0, rate_deg_s=30.0)],
        orientation="level",
    )
    end = made.sample(made.ends[-1:])
    np.testing.assert_allclose(end.p_NB, [[0.0, 0.0, 3.0]], atol=1e-14)
    np.testing.assert_allclose(end.euler, np.deg2rad([[0.0, 0.0, 45.0]]), atol=1e-14)


def test_strapdown_integration_of_the_ideal_recording_returns_the_path():
    made = MotionProfile(BLOCK, banked=True)
    motion = made.sample(np.arange(0.0, made.span[1], 2e-3))
    imu = Imu(Mount([0.5, -0.2, 0.3]))
    errors = round_trip(imu.ideal(motion), motion.at(imu.mount))
    # 500 samples a second of ramps of a second.
    assert errors.attitude.max() < 1e-6
    assert errors.position.max() < 1e-4


BAD = {
    "no segments": ([], "a motion profile needs a segment"),
    "word": ([S("trun", angle_deg=3.0)], "do of segment 1 must be one of .*Did you mean 'turn'"),
    "use": ([S("stop", duration=3.0, angle_deg=3.0)], r"segment 1 \(stop\) has no use for angle_deg; it takes"),
    "turn": ([S("turn", duration=3.0)], r"segment 1 \(turn\) needs angle_deg"),
    "climb": ([S("climb", duration=3.0)], r"segment 1 \(climb\) needs height"),
    "length": ([S("drive", speed=3.0)], r"segment 1 \(drive\) needs one of duration, distance; got none"),
    "lengths": ([S("drive", duration=3.0, distance=2.0)], "needs one of duration, distance; got duration and distance"),
    "negative": ([S("drive", duration=-3.0)], r"segment 1 \(drive\): duration must be above 0; got -3"),
    "NaN": ([S("drive", duration=np.nan)], r"segment 1 \(drive\): duration must be a finite number"),
    "no speed": ([S("drive", duration=3.0, acceleration=2.0)], "an acceleration needs the speed to reach"),
    "too slow": (
        [S("rest", duration=1.0), S("drive", duration=3.0, speed=20.0, acceleration=2.0)],
        r"segment 2 \(drive\): from 0 to 20 m/s at 2 m/s\^2 takes 11 s, 8 more than there are",
    ),
    "too short": (
        [S("drive", distance=50.0, speed=20.0, acceleration=2.0)],
        r"segment 1 \(drive\): from 0 to 20 m/s at 2 m/s\^2 takes 110 m, 60 more than its distance",
    ),
    "at rest": ([S("drive", distance=5.0)], "at rest there is no distance to drive"),
    "climb at rest": ([S("climb", height=5.0, duration=2.0)], "cannot climb at rest. Drive first, or take"),
    "radius at rest": ([S("turn", angle_deg=5.0, radius=2.0)], "a turn by its radius needs a steady speed above 0"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_what_cannot_be_is_one_clear_sentence(case):
    segments, message = BAD[case]
    with pytest.raises(ValueError, match=message) as caught:
        MotionProfile(segments)
    assert "\n" not in str(caught.value)


def test_degrees_are_refused_where_radians_are_meant_and_taken_where_they_are():
    with pytest.raises(ValueError, match=r"heading is in rad.*got 90. Are these degrees"):
        MotionProfile([S("rest", duration=1.0)], heading=90.0)
    made = profile([S("drive", duration=1.0)], speed=1.0, heading_deg=90.0)
    np.testing.assert_allclose(made.sample(made.ends).p_NB, [[0.0, 1.0, 0.0]], atol=1e-15)


def test_the_span_is_kept():
    with pytest.raises(ValueError, match="t must lie within the profile, 0 to 1 s"):
        MotionProfile([S("rest", duration=1.0)]).sample(np.array([0.5, 2.0]))


def test_every_kind_of_segment_takes_what_a_segment_has():
    assert {key for keys in TAKES.values() for key in keys} == {*Segment.__slots__} - {"do"}
