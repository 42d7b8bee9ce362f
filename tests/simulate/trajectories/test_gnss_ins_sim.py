"""Commands of gnss-ins-sim: the motion their meaning asks for, in its axes and then in ours."""

import numpy as np
import pytest

from kreisel import CommandedMotion, MotionDefinition
from kreisel.data.frames import from_enu_flu
from kreisel.data.motion_definition import Command


def ned(definition, t=None, **limits):
    """Motion in the axes of that tool, at the end or at times t."""
    made = CommandedMotion(definition, **limits)
    return from_enu_flu(made.sample(np.array(made.span[1:]) if t is None else t), "ned-frd"), made


def C(kind, ypr, velocity, duration):
    return Command(kind, ypr, velocity, duration)


TURN = MotionDefinition(
    (C(1, (0, 0, 0), (0, 0, 0), 1.0), C(1, (-15, 0, 0), (0, 0, 0), 6.0), C(1, (0, 0, 0), (0, 0, 0), 3.0)),
    velocity=(10.0, 0.0, 0.0),
    ypr_deg=(90.0, 0.0, 0.0),
)
"""East at 10 m/s for a second, left at 15 deg/s to the north, on for three: its example of a turn by 90 degrees."""


def test_a_turn_by_rates():
    end, made = ned(TURN)
    assert made.span == (0.0, 10.0)
    np.testing.assert_allclose(end.v_NB, [[10.0, 0.0, 0.0]], atol=1e-13)
    np.testing.assert_allclose(end.euler[0], 0.0, atol=1e-13)
    # A quarter circle of 10 / (15 deg/s) = 38.2 m, begun and left 0.1 s late by the ramps.
    radius = 10.0 / np.deg2rad(15.0)
    np.testing.assert_allclose(end.p_NB[0], [radius + 29.0, 11.0 + radius, 0.0], atol=5e-3)


def test_absolute_and_relative_commands():
    for kind, yaw, vx in ((2, 30.0, 4.0), (3, -20.0, 1.0), (4, 30.0, 1.0), (5, -20.0, 4.0)):
        start = MotionDefinition(
            (C(kind, (yaw, 10.0, -5.0), (vx, 0.0, 0.0), 60.0),), (3.0, 0.0, 0.0), (50.0, 0.0, 0.0)
        )
        end, made = ned(start)
        np.testing.assert_allclose(np.rad2deg(end.euler[0]), [-5.0, 10.0, 30.0], atol=1e-9, err_msg=str(kind))
        v_B = end.R_NB[0].T @ end.v_NB[0]
        np.testing.assert_allclose(v_B, [4.0, 0.0, 0.0], atol=1e-12, err_msg=str(kind))
        # The rest of the time is not used.
        assert made.span[1] < 10.0


def test_pitch_is_nose_up_and_down_is_positive():
    end, _ = ned(
        MotionDefinition((C(5, (0.0, 45.0, 0.0), (10.0, 0.0, 0.0), 250.0), C(1, (0, 0, 0), (0, 0, 0), 100.0)))
    )
    np.testing.assert_allclose(end.v_NB[0], [np.sqrt(50.0), 0.0, -np.sqrt(50.0)], atol=1e-12)
    assert end.p_NB[0, 2] < -700.0


def test_limits_hold_and_are_used():
    made = CommandedMotion(
        MotionDefinition((C(5, (170.0, 20.0, 0.0), (20.0, 3.0, -2.0), 250.0),)),
        max_acceleration=2.0, max_angular_acceleration=0.3, max_rate=0.5,
    )  # fmt: skip
    t = np.linspace(*made.span, 20001)
    phi = np.stack([part(t, 2)[..., 0] for part in made._angles], axis=-1)
    v_B = np.stack([part(t, 1)[..., 0] for part in made._speeds], axis=-1)
    assert np.abs(phi[1]).max() == pytest.approx(0.5, rel=1e-6)
    assert np.abs(phi[2]).max() == pytest.approx(0.3, rel=1e-6)
    # In the mean over the 10 s from 0 to 20 m/s, of which ramps of 0.2 s take their share.
    assert np.abs(v_B[1, :, 0]).max() == pytest.approx(2.0 * 10.0 / 9.8, rel=1e-6)
    # The others change within a second and a half: ramps of a tenth of that.
    assert np.abs(v_B[1, :, 1:]).max() == pytest.approx(2.0 / 0.9, rel=1e-6)


def test_a_command_without_time_goes_as_far_as_it_can_and_says_so():
    short = MotionDefinition((C(2, (0.0, 0.0, 0.0), (10.0, 0.0, 0.0), 5.0), C(1, (0, 0, 0), (0, 0, 0), 1.0)))
    end, made = ned(short)
    assert made.span == (0.0, 6.0)
    # At 1 m/s^2.
    np.testing.assert_allclose(end.v_NB[0], [5.0, 0.0, 0.0], atol=1e-12)
    notes = made.sample(np.array([0.0])).notes
    assert "command 1 is carried out in part: it has 5 s and would take 10 s" in notes[1].text


def test_what_takes_all_of_its_time_is_carried_out():
    stop = MotionDefinition((C(5, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 10.0),), velocity=(10.0, 0.0, 0.0))
    end, made = ned(stop)
    np.testing.assert_allclose(end.v_NB, 0.0, atol=1e-12)
    assert len(made.sample(np.array([0.0])).notes) == 1


def test_rates_that_are_left_over_fade():
    both = MotionDefinition(
        (C(1, (20.0, 0.0, 0.0), (1.0, 0.0, 0.0), 3.0), C(4, (90.0, 0.0, 0.0), (0.0, 0.0, 0.0), 30.0))
    )
    end, made = ned(both)
    assert np.rad2deg(end.euler[0, 2]) == pytest.approx(90.0)
    np.testing.assert_allclose(end.omega_NB_B, 0.0, atol=1e-12)
    t = np.linspace(0.0, made.span[1], 20001)
    omega = made.sample(t).omega_NB_B
    assert np.abs(np.diff(omega, axis=0)).max() < 5.0 * t[1]


def test_a_thousand_commands_of_ten_milliseconds_are_one_of_ten_seconds():
    many = MotionDefinition((C(1, (0, 0, 0), (10.0, 0.0, 0.0), 0.01),) * 300)
    one = MotionDefinition((C(1, (0, 0, 0), (10.0, 0.0, 0.0), 3.0),))
    # The ramp is 0.2 s where there is room for it and a single command where not.
    np.testing.assert_allclose(ned(many)[0].v_NB, ned(one)[0].v_NB, atol=1.0)
    np.testing.assert_allclose(ned(many)[0].v_NB[0], [29.95, 0.0, 0.0], atol=1e-9)


def test_derivatives_belong_together():
    _, made = ned(TURN)
    h, t = 1e-5, np.linspace(0.5, 9.5, 101)
    before, now, after = (made.sample(t + shift) for shift in (-h, 0.0, h))
    for value, rate in (("p_NB", "v_NB"), ("v_NB", "a_NB"), ("omega_NB_B", "alpha_NB_B")):
        slope = (getattr(after, value) - getattr(before, value)) / (2.0 * h)
        np.testing.assert_allclose(slope, getattr(now, rate), atol=2e-6, err_msg=value)


def test_bad_definitions_and_limits_are_refused():
    with pytest.raises(ValueError, match="a motion definition needs a command"):
        CommandedMotion(MotionDefinition(()))
    with pytest.raises(ValueError, match="max_rate must be above 0"):
        CommandedMotion(TURN, max_rate=0.0)
    with pytest.raises(ValueError, match="t must lie within the commands, 0 to 10 s"):
        CommandedMotion(TURN).sample(np.array([11.0]))
