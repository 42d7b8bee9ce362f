"""What a perfect IMU reads, with and without a magnetic field around it."""

import numpy as np
import pytest

from kreisel.data.environment import Environment
from kreisel.data.motion import Mount
from kreisel.maths.rotations import matrix_from_euler
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.trajectories.rest import rest

FIELD = np.array([1.0, 20.0, -44.0])
T = np.arange(50) / 100.0


def test_no_field_no_magnetometer():
    assert Imu().ideal(rest().sample(T)).mag_uT is None


def test_a_level_magnetometer_reads_the_field_of_n():
    recording = Imu(environment=Environment(field_N_uT=FIELD)).ideal(rest().sample(T))
    np.testing.assert_array_equal(recording.mag_uT, np.tile(FIELD, (len(T), 1)))


def test_facing_west_the_field_to_the_north_lies_on_the_right():
    # Nose to the west, y axis to the south: forward is -east, left is -north.
    west = rest(phi=(0.0, 0.0, np.pi)).sample(T)
    recording = Imu(environment=Environment(field_N_uT=FIELD)).ideal(west)
    np.testing.assert_allclose(recording.mag_uT[0], [-1.0, -20.0, -44.0], atol=1e-14)


def test_a_turned_magnetometer_on_a_moving_body_turns_back_to_the_field():
    mount = Mount(np.array([0.3, 0.0, 0.1]), matrix_from_euler(np.deg2rad([10.0, -40.0, 90.0])))
    motion = lissajous().sample(T)
    recording = Imu(mount, environment=Environment(field_N_uT=FIELD)).ideal(motion)
    back = np.einsum("nij,nj->ni", motion.at(mount).R_NB, recording.mag_uT)
    # Two products with rotations: a few roundings of 48 uT.
    np.testing.assert_allclose(back, np.tile(FIELD, (len(T), 1)), atol=1e-13)


def test_what_is_no_mount_or_motion_is_refused_with_the_cure():
    with pytest.raises(TypeError, match=r"mount must be of type Mount; got list\. Write Mount\("):
        Imu([1, 2, 3])
    with pytest.raises(TypeError, match=r"motion must be of type Motion; got ndarray\. .*sample\(t\)"):
        Imu().ideal(T)
