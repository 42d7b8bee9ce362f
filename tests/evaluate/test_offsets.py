"""Constant offsets are found, removed and reported; what the motion does not show is refused."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kreisel.data.attitude import AttitudeHistory
from kreisel.evaluate.attitude_errors import attitude_errors
from kreisel.maths.rotations import exp_so3, matrix_from_euler

T = np.arange(0.0, 20.0, 0.01)


def tumbling(t):
    angles = [1.1 * np.sin(1.9 * t), 0.9 * np.sin(1.3 * t + 1), 2 * np.sin(0.8 * t) + 0.4 * t]
    return matrix_from_euler(np.column_stack(angles))


def history(R, t=T, **more):
    return AttitudeHistory(t=t, R_NS=R, **more)


def random_rotvec(rng):
    return Rotation.from_quat(rng.normal(size=4)).as_rotvec()


TRUTH = history(tumbling(T))


def test_nothing_is_aligned_unasked():
    s = attitude_errors(TRUTH, history(exp_so3([0.0, 0.0, 0.2]) @ TRUTH.R_NS)).summary()
    assert s.heading_rmse_deg == pytest.approx(np.degrees(0.2))
    assert (s.align, s.heading_offset_deg, s.frame_offset_deg, s.sensor_offset_deg) == (None,) * 4
    assert s.clock_offset_s == 0.0


@pytest.mark.parametrize("turn", [-3.0, 0.4, 3.1])
def test_a_heading_offset_is_removed_and_reported(turn):
    e = attitude_errors(TRUTH, history(exp_so3([0.0, 0.0, turn]) @ TRUTH.R_NS), align="heading")
    # Matrices of up to pi rad go through some hundred roundings: the fit, its mean and the product.
    assert e.total.max() < 3e-14
    assert e.summary().heading_offset_deg == pytest.approx(np.degrees(turn), abs=1e-12)
    assert e.summary().align == "heading" and e.summary().frame_offset_deg is None


def test_heading_alignment_leaves_the_level_alone():
    tilted = history(exp_so3([0.0, 0.0, 1.0]) @ exp_so3([0.0, 0.3, 0.0]) @ TRUTH.R_NS)
    before, after = attitude_errors(TRUTH, tilted), attitude_errors(TRUTH, tilted, align="heading")
    np.testing.assert_allclose(after.inclination, before.inclination, atol=1e-14)
    assert after.summary().heading_rmse_deg < 1e-10


def test_a_frame_of_any_orientation_is_removed(rng):
    frame = random_rotvec(rng)
    e = attitude_errors(TRUTH, history(exp_so3(frame) @ TRUTH.R_NS), align="frame")
    assert e.total.max() < 3e-14
    np.testing.assert_allclose(exp_so3(np.radians(e.summary().frame_offset_deg)), exp_so3(frame), atol=1e-13)


def test_frame_and_sensor_are_told_apart_however_large(rng):
    frame, sensor = random_rotvec(rng), random_rotvec(rng)
    turned = history(exp_so3(frame) @ TRUTH.R_NS @ exp_so3(sensor))
    e = attitude_errors(TRUTH, turned, align="frame+sensor")
    assert e.total.max() < 1e-13
    found = exp_so3(np.radians(e.summary().sensor_offset_deg))
    np.testing.assert_allclose(found, exp_so3(sensor), atol=1e-12)


@pytest.mark.parametrize("align", ["heading", "frame", "frame+sensor"])
def test_no_other_offset_of_the_kind_leaves_less(rng, align):
    noise = exp_so3(0.3 * rng.normal(size=(len(T), 3)))
    estimate = noise @ exp_so3([0.2, -0.1, 0.5]) @ TRUTH.R_NS
    e = attitude_errors(TRUTH, history(estimate), align=align)
    least = np.mean(e.total**2)
    kept = estimate @ exp_so3(-e.removed.sensor_S)
    for axis in np.eye(3)[2 if align == "heading" else 0 :]:
        for step in (-1e-3, 1e-3):
            moved = exp_so3(step * axis) @ exp_so3(-e.removed.frame_N) @ kept
            assert np.mean(attitude_errors(TRUTH, history(moved)).total ** 2) > least


def test_samples_that_do_not_count_do_not_align():
    wrong = exp_so3(np.outer(np.where(T < 10.0, 1.0, 0.3), [0, 0, 1])) @ TRUTH.R_NS
    e = attitude_errors(TRUTH, history(wrong), align="heading", samples=T >= 10.0)
    assert e.summary().heading_offset_deg == pytest.approx(np.degrees(0.3))


@pytest.mark.parametrize("late", [-1.234567, 0.0004, 3.5])
def test_a_clock_that_is_ahead_is_set_back(late):
    fine = np.arange(-5.0, 25.0, 0.005)
    estimate = history(exp_so3([0.0, 0.0, 0.7]) @ tumbling(fine), fine + late)
    e = attitude_errors(TRUTH, estimate, align="frame", clock_offset="estimate")
    # Between samples 5 ms apart a turn that changes by 7 rad/s^2 leaves constant rate by 7 dt^2 / 8.
    assert e.total.max() < 2.5e-5
    assert e.summary().clock_offset_s == pytest.approx(late, abs=2e-6)
    given = attitude_errors(TRUTH, estimate, align="frame", clock_offset=late)
    np.testing.assert_allclose(given.total, e.total, atol=1e-5)


def test_a_clock_is_found_beneath_noise_and_without_alignment(rng):
    noisy = exp_so3(0.01 * rng.normal(size=(len(T), 3))) @ exp_so3([0.0, 0.0, 0.3]) @ TRUTH.R_NS
    e = attitude_errors(TRUTH, history(noisy, T + 0.08), clock_offset="estimate")
    # 0.01 rad over 2000 samples at a rate of about 1.5 rad/s: 1.5e-4 s, seven times.
    assert e.removed.clock == pytest.approx(0.08, abs=1e-3)
    assert e.summary().heading_rmse_deg == pytest.approx(np.degrees(0.3), rel=0.02)


@pytest.mark.parametrize(
    ("R", "options", "message"),
    [
        (exp_so3(np.outer(T, [0, 0, 1])), {"align": "frame+sensor"}, "rotation about two axes"),
        (exp_so3(np.outer(T, [0, 0, 1])), {"clock_offset": "estimate"}, "rate of turn that changes"),
        (np.tile(np.eye(3), (len(T), 1, 1)), {"clock_offset": "estimate"}, "rate of turn that changes"),
    ],
)
def test_what_the_motion_does_not_show_is_refused(R, options, message):
    with pytest.raises(ValueError, match=message):
        attitude_errors(history(R), history(R), **options)
