"""Imu.increments: what a unit that adds up inside feels at rest, in a turn and on a cone."""

import numpy as np

from kreisel.data.motion import Motion, Mount
from kreisel.maths.rotations import matrix_from_euler
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.coning import coning

G = 9.80665


def at_rest(t, R):
    zero = np.zeros((len(t), 3))
    return Motion(t, zero, zero, zero, np.tile(R, (len(t), 1, 1)), zero, zero)


def test_rest_adds_up_gravity_upwards():
    t = np.array([0.0, 0.01, 0.03, 0.04])
    R = matrix_from_euler(np.array([0.3, -0.2, 1.0]))
    unit = Imu().increments(at_rest(t, R))
    h = np.diff(t)[:, None]
    up_S = R.T @ [0.0, 0.0, 1.0]
    np.testing.assert_allclose(unit.dtheta, 0.0, atol=1e-15)
    np.testing.assert_allclose(unit.dv, G * h * up_S, rtol=1e-14)
    np.testing.assert_allclose(unit.dp, 0.5 * G * h * h * up_S, rtol=1e-14)


def test_a_lever_arm_in_a_steady_turn_gives_the_chord_of_the_velocity():
    rate, arm, t = 2.0, 0.5, np.arange(5) / 10.0
    R = matrix_from_euler(np.stack([0 * t, 0 * t, rate * t], axis=1))
    zero = np.zeros((5, 3))
    motion = Motion(t, zero, zero, zero, R, zero + np.array([0.0, 0.0, rate]), zero)
    unit = Imu(Mount(p_BS=[arm, 0.0, 0.0])).increments(motion)
    np.testing.assert_allclose(unit.dtheta, np.tile([0.0, 0.0, rate * 0.1], (4, 1)), atol=1e-15)
    # The velocity omega r turns by omega h: its change is a chord, seen from the axes at the start.
    speed, turn = rate * arm, rate * 0.1
    chord = [-speed * np.sin(turn), speed * (np.cos(turn) - 1.0), G * 0.1]
    np.testing.assert_allclose(unit.dv, np.tile(chord, (4, 1)), atol=1e-14)


def test_coning_is_in_them():
    half_angle, rate, h = 0.01, 30.0, 0.02
    t = h * np.arange(50)
    unit = Imu().increments(coning(half_angle, rate).sample(t))
    integral = -2.0 * rate * np.sin(half_angle / 2.0) ** 2 * h
    # Half the area the rate vector sweeps in a step (Savage, Strapdown Analytics, eq. for pure coning).
    theory = 0.5 * np.sin(half_angle) ** 2 * (rate * h - np.sin(rate * h))
    # The next term is smaller by the half angle squared.
    np.testing.assert_allclose(unit.dtheta[:, 2] - integral, theory, rtol=3.0 * half_angle**2)
