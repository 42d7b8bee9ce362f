"""Errors of attitude as a navigator would state them: what is heading, what is tilt, and when they are."""

import dataclasses
import json

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Poses
from kreisel.evaluate.attitude_errors import AttitudeErrors, attitude_errors
from kreisel.maths.rotations import exp_so3, geodesic, matrix_from_euler

# Elements of R carry 1e-16 each; an error is made of two products of them.
ROUND_OFF = 3e-15
T = np.arange(0.0, 10.0, 0.01)
EPOCH_NS = 1_700_000_000_123_456_789


def tumbling(t=T):
    """All three angles at incommensurable rates, level and upside down."""
    return matrix_from_euler(np.column_stack([1.5 * np.sin(0.9 * t), 1.2 * np.sin(0.7 * t + 1), 2 * t]))


def history(R=None, t=T, **more):
    return AttitudeHistory(t=t, R_NS=tumbling(t) if R is None else R, **more)


def errors_of(R_true, R_est, **options):
    return attitude_errors(history(R_true), history(R_est), **options)


@pytest.mark.parametrize("offset_deg", [-179.0, -30.0, 1e-9, 5.0, 120.0])
def test_a_compass_error_is_heading_and_nothing_else(offset_deg):
    e = errors_of(tumbling(), exp_so3([0.0, 0.0, np.radians(offset_deg)]) @ tumbling())
    np.testing.assert_allclose(e.heading, np.radians(offset_deg), atol=ROUND_OFF)
    np.testing.assert_allclose(e.total, np.radians(abs(offset_deg)), atol=ROUND_OFF)
    # Where w is small, at 179 deg, the ratio of sides is worth 1e2 roundings.
    np.testing.assert_allclose(e.inclination, 0.0, atol=ROUND_OFF)


@pytest.mark.parametrize("tilt", [1e-9, 0.3, 3.0])
def test_a_wrong_level_is_inclination_and_nothing_else(tilt):
    e = errors_of(tumbling(), exp_so3(tilt * np.array([0.6, -0.8, 0.0])) @ tumbling())
    np.testing.assert_allclose(e.inclination, tilt, atol=ROUND_OFF)
    # Near half a turn 4 w z over 2 (w^2 - z^2) is worth 1 / w^2 = 200 roundings of 2e-16.
    np.testing.assert_allclose(e.heading, 0.0, atol=20 * ROUND_OFF)
    np.testing.assert_allclose(e.total, tilt, atol=ROUND_OFF)


def test_inclination_is_the_angle_between_the_two_verticals(rng):
    R_true = Rotation.from_quat(rng.normal(size=(len(T), 4))).as_matrix()
    R_est = Rotation.from_quat(rng.normal(size=(len(T), 4))).as_matrix()
    # Up as the sensor sees it is the third row.
    between = np.arccos(np.clip(np.sum(R_true[:, 2] * R_est[:, 2], axis=1), -1, 1))
    # acos gives half of the digits near 0 and pi.
    np.testing.assert_allclose(errors_of(R_true, R_est).inclination, between, atol=1e-7)


@pytest.mark.parametrize("pitch", [np.pi / 2, -np.pi / 2])
def test_a_vertical_nose_is_no_special_case(pitch):
    R = np.tile(matrix_from_euler([0.3, pitch, -1.0]), (len(T), 1, 1))
    e = errors_of(R, exp_so3([0.0, 0.0, 0.2]) @ R)
    np.testing.assert_allclose(e.heading, 0.2, atol=ROUND_OFF)
    np.testing.assert_allclose(e.inclination, 0.0, atol=ROUND_OFF)


def test_upside_down_and_facing_backwards_are_half_a_turn():
    upside_down = errors_of(tumbling(), exp_so3([np.pi, 0.0, 0.0]) @ tumbling())
    np.testing.assert_allclose(upside_down.inclination, np.pi, atol=ROUND_OFF)
    backwards = errors_of(tumbling(), exp_so3([0.0, 0.0, np.pi]) @ tumbling())
    np.testing.assert_allclose(np.abs(backwards.heading), np.pi, atol=ROUND_OFF)
    np.testing.assert_allclose(backwards.inclination, 0.0, atol=ROUND_OFF)


def test_truth_and_estimate_are_equal_partners(rng):
    R_est = exp_so3(rng.normal(size=(len(T), 3))) @ tumbling()
    there, back = errors_of(tumbling(), R_est), errors_of(R_est, tumbling())
    np.testing.assert_allclose(there.total, back.total, atol=ROUND_OFF)
    np.testing.assert_allclose(there.inclination, back.inclination, atol=ROUND_OFF)
    # Near half a turn atan(z / w) loses what w has lost.
    np.testing.assert_allclose(np.exp(1j * there.heading), np.exp(-1j * back.heading), atol=1e-9)


@pytest.mark.parametrize("size", [1e-12, 1e-9, 1e-5, 4.99e-3, 5.01e-3, 0.3, 3.14])
def test_small_angles_keep_their_digits(size):
    axis = np.array([2.0, -3.0, 6.0]) / 7.0
    e = AttitudeErrors(t=T[:1], dtheta_N=size * axis[None], counts=[True])
    with mpmath.workdps(50):
        half = mpmath.mpf(size) / 2
        w, z = mpmath.cos(half), mpmath.sin(half) * 6 / 7
        heading, inclination = 2 * mpmath.atan(z / w), 2 * mpmath.acos(mpmath.sqrt(w**2 + z**2))
    # Five roundings of the value itself: relative, not absolute.
    np.testing.assert_allclose(
        [e.total[0], e.heading[0], e.inclination[0]], [size, float(heading), float(inclination)], rtol=1e-15
    )


def test_a_picoradian_survives_the_way_through_matrices():
    dtheta = np.array([3e-13, -4e-13, 1e-12])
    e = errors_of(tumbling(), exp_so3(dtheta) @ tumbling())
    # Right to the round-off of two products of matrices; acos would have answered 0 or 1.5e-8.
    np.testing.assert_allclose(e.dtheta_N, np.tile(dtheta, (len(T), 1)), atol=1e-15)


def test_the_definition_is_the_rotation_vector_in_N(rng):
    dtheta = rng.normal(size=(len(T), 3))
    dtheta = dtheta[np.linalg.norm(dtheta, axis=1) < 3.0]
    R = tumbling()[: len(dtheta)]
    e = attitude_errors(history(R, T[: len(R)]), history(exp_so3(dtheta) @ R, T[: len(R)]))
    np.testing.assert_allclose(e.dtheta_N, dtheta, atol=10 * ROUND_OFF)


def test_every_noun_with_attitude_can_be_truth():
    zero = np.zeros((len(T), 3))
    nouns = [
        history(),
        Motion(T, zero, zero, zero, tumbling(), zero, zero),
        Poses(T, zero, tumbling()),
        Reference(T, tumbling(), np.ones(len(T), bool)),
    ]
    for truth in nouns:
        for estimate in nouns[:3]:
            np.testing.assert_allclose(attitude_errors(truth, estimate).total, 0.0, atol=ROUND_OFF)


def test_an_estimate_at_other_stamps_turns_at_constant_rate_between_its_own():
    rate = np.array([0.4, -1.0, 2.0])
    coarse, fine = np.arange(0.0, 5.0, 0.25), np.arange(-1.0, 7.0, 0.01)
    e = attitude_errors(
        history(exp_so3(fine[:, None] * rate), fine), history(exp_so3(coarse[:, None] * rate), coarse)
    )
    np.testing.assert_allclose(e.total, 0.0, atol=10 * ROUND_OFF)
    # The truth goes on at both ends; nothing is guessed there.
    np.testing.assert_allclose(e.t[[0, -1]], [0.0, 4.75], atol=1e-12)


def test_geodesic_goes_the_short_way_at_constant_rate():
    R = geodesic(np.eye(3), exp_so3([0.0, 0.0, 3.0]), np.array([0.0, 0.25, 1.0]))
    np.testing.assert_allclose(R, exp_so3(np.outer([0.0, 0.75, 3.0], [0, 0, 1])), atol=ROUND_OFF)


def test_epochs_count_to_the_nanosecond():
    on_epoch = history(t0_ns=EPOCH_NS)
    # The same instants, told from a start 2.5 s and 3 ns later.
    shifted = history(tumbling(), T - (2.5 + 3e-9), t0_ns=EPOCH_NS + 2_500_000_003)
    e = attitude_errors(on_epoch, shifted)
    assert len(e) == len(T) and e.t0_ns == EPOCH_NS
    # An epoch in float seconds would be off by up to 1e-7 s at a rate of 2 rad/s.
    np.testing.assert_allclose(e.total, 0.0, atol=1e-14)


def test_rows_that_do_not_count_keep_their_error_but_not_in_the_statistics():
    R, counts = tumbling().copy(), np.ones(len(T), bool)
    R[100:200], counts[100:300] = np.nan, False
    R_est = tumbling().copy()
    R_est[250] = exp_so3([0.0, 0.0, 1.0]) @ R_est[250]
    e = attitude_errors(Reference(T, R, counts), history(R_est))
    assert np.isnan(e.total[100:200]).all() and e.total[250] == pytest.approx(1.0)
    assert e.summary().samples == len(T) - 200 and e.summary().total_max_deg < 1e-12
    chosen = attitude_errors(Reference(T, R, counts), history(R_est), samples=T > 5.0)
    assert chosen.summary().samples == np.sum(T > 5.0)


def test_statistics_are_those_of_the_magnitudes():
    heading = np.radians(np.linspace(-10.0, 10.0, 201))
    R, t = np.tile(np.eye(3), (201, 1, 1)), 0.1 * np.arange(201)
    turned = exp_so3(np.outer(heading, [0, 0, 1]))
    s = attitude_errors(history(R, t), history(turned, t)).summary(limit_deg=9.0)
    # Uniform in [0, 10]: mean 5, rms 10 / sqrt(3), 95th percentile 9.5; to half the step of 0.1.
    assert s.heading_mean_deg == pytest.approx(5.0, abs=0.05)
    assert s.total_rmse_deg == pytest.approx(10 / np.sqrt(3), abs=0.05)
    assert s.heading_median_deg == pytest.approx(5.0, abs=0.05)
    assert s.total_p95_deg == pytest.approx(9.5, abs=0.05)
    assert s.heading_max_deg == pytest.approx(10.0)
    assert s.inclination_rmse_deg < 1e-12
    assert s.convergence_time_s is None  # at the end it is above 9 deg again
    assert json.loads(json.dumps(dataclasses.asdict(s)))["samples"] == 201


def test_convergence_is_the_time_after_which_the_error_stays_small():
    t = np.arange(200) * 0.1 + 100.0
    heading = np.radians(20.0 * np.exp(-(t - 100.0) / 3.0))
    heading[70] = np.radians(30.0)  # a relapse at 7 s
    R = np.tile(np.eye(3), (len(t), 1, 1))
    e = attitude_errors(history(R, t), history(exp_so3(np.outer(heading, [0, 0, 1])), t))
    assert e.summary(limit_deg=5.0).convergence_time_s == pytest.approx(7.1)
    # 20 exp(-t / 3) = 1 at 8.99 s; the level was never wrong.
    assert e.summary(limit_deg=1.0, of="heading").convergence_time_s == pytest.approx(9.0)
    assert e.summary(of="inclination").convergence_time_s == 0.0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: attitude_errors(history(), history(t=T + 100.0)), "not overlap: the truth spans 0 to 9.99"),
        (lambda: attitude_errors(history(), history(t0_ns=EPOCH_NS)), "their epochs t0_ns are 0 and 17"),
        (lambda: attitude_errors(history(), history(), samples=T < 0), "no sample of the truth that counts"),
        (lambda: attitude_errors(history(), history(), samples=[True]), "samples must have one row per time"),
        (lambda: attitude_errors(history(), Poses(T, np.zeros((len(T), 3)))), "estimate has positions only"),
        (lambda: attitude_errors(history(), history(), align="headin"), "Did you mean 'heading'"),
        (lambda: attitude_errors(history(), history(), clock_offset="auto"), "clock_offset must be one of"),
        (lambda: attitude_errors(history(), history(), clock_offset=np.nan), "clock_offset must be finite"),
        (lambda: attitude_errors(history(), history()).summary(of="yaw"), "of must be one of"),
        (lambda: attitude_errors(history(t=T[:0]), history()), "truth has no samples"),
    ],
)
def test_mistakes_are_explained(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_wrong_types_are_named():
    with pytest.raises(TypeError, match="estimate must be AttitudeHistory, Motion or Poses; got ndarray"):
        attitude_errors(history(), tumbling())
    with pytest.raises(TypeError, match="truth must be Motion, Reference"):
        attitude_errors(tumbling(), history())
