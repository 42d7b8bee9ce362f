"""Attitude from directions: the identities of document 002, and what a compass and a level know."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kreisel.maths import directions
from kreisel.maths.rotations import euler_from_matrix, matrix_from_euler

# Twenty roundings of numbers of order one.
ROUND_OFF = 5e-15
UP = np.array([0.0, 0.0, 9.81])
# 66 deg of dip, a declination of zero: magnetic north is north.
FIELD = 49.0 * np.array([0.0, np.cos(1.15), -np.sin(1.15)])


def random_attitudes(rng, n=400):
    return Rotation.from_quat(rng.normal(size=(n, 4))).as_matrix()


def seen_from(R_NS, v_N):
    return np.einsum("nji,j->ni", R_NS, v_N)


def turned(declination):
    """The field where magnetic north is `declination` east of true north."""
    c, s = np.cos(declination), np.sin(declination)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ FIELD


@pytest.mark.parametrize("declination", [0.0, 0.07, -0.3])
def test_a_body_at_rest_knows_its_attitude_from_gravity_and_field(rng, declination):
    R_NS = random_attitudes(rng)
    accel, mag = seen_from(R_NS, UP), seen_from(R_NS, turned(declination))
    back = directions.attitude_from_accel_mag(accel, mag, declination=declination)
    # The horizontal part of the field is 0.4 of it: a few more roundings.
    np.testing.assert_allclose(back, R_NS, atol=3 * ROUND_OFF)


def test_east_declination_turns_a_compass_reading_clockwise():
    # Nose on magnetic north, 10 deg of east declination: the nose points 10 deg east of true north.
    mag = [1.0, 0.0, -2.0]
    R_NS = directions.attitude_from_accel_mag(UP, mag, declination=np.radians(10.0))
    np.testing.assert_allclose(R_NS[:, 0], [np.sin(np.radians(10.0)), np.cos(np.radians(10.0)), 0.0])


def test_the_three_vector_construction_is_triad_with_the_vertical_trusted(rng):
    R_NS = random_attitudes(rng)
    accel = seen_from(R_NS, UP) + rng.normal(scale=0.5, size=(400, 3))
    mag = seen_from(R_NS, FIELD) + rng.normal(scale=2.0, size=(400, 3))
    document = directions.attitude_from_accel_mag(accel, mag)
    np.testing.assert_allclose(directions.triad(accel, mag, UP, FIELD), document, atol=1e-13)


def test_triad_meets_the_vector_it_trusts_and_splits_nothing_with_the_other(rng):
    R_NS = random_attitudes(rng)
    accel = seen_from(R_NS, UP) + rng.normal(scale=0.5, size=(400, 3))
    mag = seen_from(R_NS, FIELD)
    trusting = directions.triad(mag, accel, FIELD, UP)
    np.testing.assert_allclose(directions.to_global(trusting, mag), np.tile(FIELD, (400, 1)), atol=1e-12)
    level = directions.to_global(trusting, directions.unit(accel))[:, 2]
    assert level.min() < 0.999  # the accelerometer, which was wrong, was not followed
    # Both reach the same answer where nothing is wrong.
    exact = seen_from(R_NS, UP)
    np.testing.assert_allclose(directions.triad(mag, exact, FIELD, UP), R_NS, atol=3 * ROUND_OFF)


def test_tilt_keeps_roll_and_pitch_and_has_no_yaw(rng):
    phi = np.column_stack([rng.uniform(-3.1, 3.1, 300), rng.uniform(-1.5, 1.5, 300), rng.uniform(-3, 3, 300)])
    accel = directions.to_body(matrix_from_euler(phi), UP)
    back = euler_from_matrix(directions.tilt_from_accel(accel))
    # Angles lose digits with 1 / cos(phi_y), at most 1 / cos(1.5) = 14.
    np.testing.assert_allclose(back[:, :2], phi[:, :2], atol=20 * ROUND_OFF)
    np.testing.assert_allclose(back[:, 2], 0.0, atol=20 * ROUND_OFF)


@pytest.mark.parametrize("nose", [1.0, -1.0])
def test_a_vertical_nose_hands_the_heading_to_y(nose):
    R_NS = directions.tilt_from_accel([nose * 9.8, 0.0, 0.0])
    np.testing.assert_allclose(R_NS @ [nose, 0.0, 0.0], [0.0, 0.0, 1.0], atol=ROUND_OFF)
    np.testing.assert_allclose(R_NS[:, 1], [0.0, 1.0, 0.0], atol=ROUND_OFF)


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
def test_direction_does_not_depend_on_the_unit(scale):
    R_NS = directions.attitude_from_accel_mag(scale * UP, scale * FIELD)
    np.testing.assert_allclose(R_NS, np.eye(3), atol=ROUND_OFF)


@pytest.mark.parametrize(
    ("accel", "mag"),
    [
        ([0.0, 0.0, 0.0], FIELD),
        (UP, [0.0, 0.0, 0.0]),
        ([0.1, 0.7, 0.3], [-0.3, -2.1, -0.9]),
        ([np.nan, 0.0, 9.8], FIELD),
        ([np.inf, 0.0, 9.8], FIELD),
    ],
)
def test_what_has_no_answer_is_nan_and_spoils_no_other_row(accel, mag):
    both = directions.attitude_from_accel_mag(np.stack([UP, accel]), np.stack([FIELD, mag]))
    assert np.isfinite(both[0]).all() and not np.isfinite(both[1]).all(axis=0).any()


def test_perpendicular_is_defined_until_the_vectors_are_parallel_to_half_the_digits():
    for angle, finite in ((1e-7, True), (1e-9, False)):
        b = [np.cos(angle), np.sin(angle), 0.0]
        assert np.isfinite(directions.perpendicular(b, [1.0, 0.0, 0.0])).all() == finite


def test_half_and_half_leaves_the_cube_of_the_error_and_the_one_sided_twin_none():
    error = 0.02
    I, J = np.array([1.0, 0.0, 0.0]), np.array([np.sin(error), np.cos(error), 0.0])
    I2, J2, K2 = directions.orthonormal_by_half(I, J)
    # Numerator 2 Err^3 with Err = (I.J)/2; the lengths it is divided by differ from 1 by 3 Err^2 = 3e-4.
    np.testing.assert_allclose(I2 @ J2, np.sin(error) ** 3 / 4, rtol=1e-3)
    # Both move by the same angle, towards a right angle between them.
    np.testing.assert_allclose(I @ I2, J @ J2, atol=ROUND_OFF)
    np.testing.assert_allclose(K2, np.cross(I2, J2), atol=ROUND_OFF)
    I3, J3, K3 = directions.orthonormal_keeping(I, J)
    np.testing.assert_array_equal(I3, I)
    np.testing.assert_allclose(np.stack([I3, J3, K3]), np.eye(3), atol=ROUND_OFF)


def test_rate_and_velocity_of_a_rotating_vector_undo_each_other(rng):
    r, w = rng.normal(size=(2, 50, 3))
    v = directions.velocity_of_vector(w, r)
    np.testing.assert_allclose(np.sum(v * r, axis=1), 0.0, atol=10 * ROUND_OFF)  # it only rotates
    across = w - r * np.sum(w * r, axis=1, keepdims=True) / np.sum(r * r, axis=1, keepdims=True)
    np.testing.assert_allclose(directions.rate_of_vector(r, v), across, atol=1e-12)
    # A finite rotation by 1e-6 s at that rate moves r by v dt, to second order.
    moved = Rotation.from_rotvec(1e-6 * w).apply(r)
    np.testing.assert_allclose((moved - r) / 1e-6, v, atol=1e-4)
    assert np.isnan(directions.rate_of_vector(np.zeros(3), w[0])).all()


def test_axes_as_columns_and_rows_are_the_matrix_of_the_document(rng):
    R_NB = random_attitudes(rng, 7)
    seen_from_N, seen_from_B = np.moveaxis(R_NB, -1, 0), np.moveaxis(R_NB, -2, 0)
    np.testing.assert_array_equal(directions.matrix_from_columns(*seen_from_N), R_NB)
    np.testing.assert_array_equal(directions.matrix_from_rows(*seen_from_B), R_NB)
    east, north, up = seen_from_B
    np.testing.assert_array_equal(directions.matrix_from_north_west_up(north, -east, up), R_NB)
    v_B = rng.normal(size=(7, 3))
    v_N = directions.to_global(R_NB, v_B)
    np.testing.assert_allclose(v_N[3], R_NB[3] @ v_B[3], atol=ROUND_OFF)
    np.testing.assert_allclose(directions.to_body(R_NB, v_N), v_B, atol=ROUND_OFF)


def test_leading_axes_are_free_and_broadcast(rng):
    accel, mag = rng.normal(size=(2, 4, 3)), rng.normal(size=3)
    R = directions.attitude_from_accel_mag(accel, mag)
    assert R.shape == (2, 4, 3, 3)
    np.testing.assert_array_equal(R[1, 2], directions.attitude_from_accel_mag(accel[1, 2], mag))
    assert directions.tilt_from_accel(accel).shape == (2, 4, 3, 3)


def test_a_transposed_array_is_named():
    with pytest.raises(ValueError, match=r"got \(3, 1000\)\. Did you mean v\.T\?"):
        directions.unit(np.zeros((3, 1000)))
