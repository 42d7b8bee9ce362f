"""What a perfect IMU reads, with and without a magnetic field around it."""

import numpy as np
import pytest

from kreisel.data.environment import Environment
from kreisel.data.motion import Mount
from kreisel.maths.rotations import matrix_from_euler
from kreisel.simulate.disturbances.dipole import Dipole
from kreisel.simulate.disturbances.step import FieldStep
from kreisel.simulate.effects.hard_soft_iron import HardSoftIron
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.line import line
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


# --- what disturbs the field ---

MAGNET = Dipole(p_ND=(1.0, 0.5, 0.0), moment_N=(0.0, 10.0, 0.0))
LIFT = FieldStep(field_N_uT=(3.0, 0.0, 0.0), start=0.2, end=0.3)


def test_past_a_magnet_the_field_swells_and_falls_again():
    passing = line((4.0, 0.0, 0.0)).sample(T)
    mag_uT = Imu(environment=Environment(field_N_uT=FIELD, disturbances=[MAGNET])).ideal(passing).mag_uT
    added = np.linalg.norm(mag_uT - FIELD, axis=1)
    # Abreast of it after 0.25 s, on its axis: 2 * 0.1 * 10 / 0.5^3 uT, and back to nearly nothing within a metre.
    assert added.argmax() == 25 and added[25] == pytest.approx(16.0, abs=1e-12)
    assert added[0] < 2.0 and added[-1] < 2.0


def test_the_magnet_is_felt_at_the_sensor_in_its_axes():
    """Two sensors on one body: the near one reads more, and turned back to N both read the formula."""
    motion = lissajous().sample(T)
    world = Environment(field_N_uT=FIELD, disturbances=[MAGNET, LIFT])
    mount = Mount(np.array([0.3, 0.0, 0.1]), matrix_from_euler(np.deg2rad([10.0, -40.0, 90.0])))
    sensor = motion.at(mount)
    back = np.einsum("nij,nj->ni", sensor.R_NB, Imu(mount, environment=world).ideal(motion).mag_uT)
    expected = FIELD + MAGNET.added_N_uT(T, sensor.p_NB) + LIFT.added_N_uT(T, sensor.p_NB)
    np.testing.assert_allclose(back, expected, atol=1e-13)


def test_without_disturbances_every_bit_is_as_before():
    motion = lissajous().sample(T)
    plain = Imu(environment=Environment(field_N_uT=FIELD)).ideal(motion)
    later = FieldStep(field_N_uT=(3.0, 0.0, 0.0), start=100.0)
    waiting = Imu(environment=Environment(field_N_uT=FIELD, disturbances=[later])).ideal(motion)
    np.testing.assert_array_equal(waiting.mag_uT, plain.mag_uT)
    np.testing.assert_array_equal(waiting.accel, plain.accel)


def test_the_truth_of_the_disturbance_comes_with_the_recording():
    """In N, before the iron of the sensor itself bends what is left of it."""
    motion, world = lissajous().sample(T), Environment(field_N_uT=FIELD, disturbances=[MAGNET, LIFT])
    mount = Mount(np.array([0.3, 0.0, 0.1]))
    iron = HardSoftIron(hard_iron_uT=(10.0, 0.0, 0.0), soft_iron=np.diag([1.1, 1.0, 0.9]))
    recorded = Imu(mount, mag_effects=[iron], environment=world).record(motion, 1)
    R = motion.at(mount).R_NB
    in_S = np.einsum("nji,nj->ni", R, FIELD + recorded.disturbance_N_uT)
    np.testing.assert_allclose(recorded.ideal.mag_uT, in_S, atol=1e-13)
    np.testing.assert_allclose(
        recorded.measured.mag_uT, in_S * [1.1, 1.0, 0.9] + [10.0, 0.0, 0.0], atol=1e-13
    )
    assert Imu(mount, environment=Environment(field_N_uT=FIELD)).record(motion, 1).disturbance_N_uT is None


def test_a_sensor_that_runs_into_a_magnet_is_told_when():
    through = Dipole(p_ND=(1.0, 0.0, 0.0), moment_N=(0.0, 10.0, 0.0))
    with pytest.raises(ValueError, match=r"p_ND \[1.0, 0.0, 0.0\] m is on the path: at t = 0.25 s"):
        Imu(environment=Environment(field_N_uT=FIELD, disturbances=[through])).ideal(
            line((4.0, 0.0, 0.0)).sample(T)
        )


def test_what_is_no_disturbance_is_refused():
    with pytest.raises(TypeError, match=r"disturbances\[1\] must be of type Disturbance; got tuple"):
        Environment(field_N_uT=FIELD, disturbances=[MAGNET, (1.0, 2.0, 3.0)])


def test_what_is_no_mount_or_motion_is_refused_with_the_cure():
    with pytest.raises(TypeError, match=r"mount must be of type Mount; got list\. Write Mount\("):
        Imu([1, 2, 3])
    with pytest.raises(TypeError, match=r"motion must be of type Motion; got ndarray\. .*sample\(t\)"):
        Imu().ideal(T)
