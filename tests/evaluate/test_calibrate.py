"""What was wrong with a simulated sensor is found and taken off; motion that does not show it is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kreisel import Calibration, Imu, ImuRecording, Motion, calibrate_accel, calibrate_gyro, calibrate_mag
from kreisel.data.calibration import TriadCalibration
from kreisel.data.environment import Environment
from kreisel.evaluate.stillness import still_windows
from kreisel.maths.rotations import exp_so3, log_so3
from kreisel.simulate.calibrated import effects_of
from kreisel.simulate.effects.white_noise import WhiteNoise

RATE, HOLD, TURN = 50.0, 3.0, 1.0
G = 9.80665
FIELD = np.array([0.0, 20.0, -43.0])
SKEW = np.array([[1.02, 0.004, -0.003], [0.004, 0.98, 0.006], [-0.003, 0.006, 1.01]])
TURNED = SKEW @ exp_so3(np.array([0.05, -0.03, 0.08]))
TRUE = Calibration(
    gyro=TriadCalibration(bias=[0.02, -0.01, 0.005]),
    accel=TriadCalibration(matrix=SKEW, bias=[0.2, -0.1, 0.3]),
    mag=TriadCalibration(matrix=TURNED / np.cbrt(np.linalg.det(TURNED)), bias=[12.0, -30.0, 7.0]),
)
SIDES = [
    exp_so3(np.array(v) * np.pi / 2)
    for v in [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (0, 1, 0), (0, -1, 0)]
]


def poses(attitudes) -> Motion:
    """Three seconds in each attitude with a turn of one second in between."""
    R, omega = [], []
    ends = [*attitudes[1:], attitudes[-1]]
    ramp = np.linspace(0.0, 1.0, int(TURN * RATE), endpoint=False)
    for a, b in zip(attitudes, ends, strict=True):
        turn = log_so3(a.T @ b)
        R += [np.repeat(a[None], int(HOLD * RATE), axis=0), a @ exp_so3(ramp[:, None] * turn)]
        omega += [np.zeros((int(HOLD * RATE), 3)), np.repeat(turn[None] / TURN, len(ramp), axis=0)]
    R, omega = np.concatenate(R), np.concatenate(omega)
    zero = np.zeros((len(R), 3))
    return Motion(np.arange(len(R)) / RATE, zero, zero, zero, R, omega, zero)


def any_attitudes(n, seed):
    return list(exp_so3(np.random.default_rng(seed).uniform(-2.0, 2.0, (n, 3))))


def record(motion, seed=1) -> ImuRecording:
    gyro, accel, mag = effects_of(TRUE)
    imu = Imu(
        gyro_effects=(*gyro, WhiteNoise(1e-4)),
        accel_effects=(*accel, WhiteNoise(1e-3)),
        mag_effects=(*mag, WhiteNoise(0.03)),
        environment=Environment(field_N_uT=FIELD),
    )
    return imu.record(motion, seed).measured


RECORDING = record(poses(any_attitudes(24, 2)))


def within(found, true, error, times=4.0) -> bool:
    return bool((np.abs(np.asarray(found) - true) <= times * error + 1e-12).all())


def test_the_bias_of_the_gyro_is_its_mean_at_rest() -> None:
    triad = calibrate_gyro(RECORDING)
    assert within(triad.bias, TRUE.gyro.bias, triad.bias_error)
    # 24 holds of about 2 s at 1e-4 rad/s/sqrt(Hz).
    assert (triad.bias_error < 3e-5).all()


def test_rest_is_found_and_turning_is_not() -> None:
    windows = still_windows(RECORDING)
    assert windows.pose.max() + 1 == 24
    # A turn would read its rate, a radian per second; noise of a window is 1e-4 * sqrt(2).
    assert np.abs(windows.gyro - TRUE.gyro.bias).max() < 1e-3


def test_many_poses_calibrate_the_whole_accelerometer() -> None:
    triad = calibrate_accel(RECORDING)
    assert within(triad.bias, TRUE.accel.bias, triad.bias_error)
    assert within(triad.matrix, SKEW, triad.matrix_error)
    assert (triad.bias_error < 2e-3).all() and (triad.matrix_error < 5e-4).all()


def test_six_sides_calibrate_bias_and_scale() -> None:
    motion = poses(SIDES)
    imu = Imu(
        accel_effects=effects_of(
            Calibration(accel=TriadCalibration(np.diag([1.02, 0.98, 1.01]), [0.2, -0.1, 0.3]))
        ).accel
    )
    triad = calibrate_accel(imu.record(motion, 3).measured)
    # Six perfect readings, six unknowns: round-off.
    np.testing.assert_allclose(triad.bias, [0.2, -0.1, 0.3], atol=1e-9)
    np.testing.assert_allclose(triad.matrix, np.diag([1.02, 0.98, 1.01]), atol=1e-9)


def test_the_accelerometer_tells_how_the_magnetometer_is_turned() -> None:
    level = replace(RECORDING, accel=TRUE.accel.undo(RECORDING.accel))
    fit = calibrate_mag(level)
    assert within(fit.triad.bias, TRUE.mag.bias, fit.triad.bias_error)
    # Standard errors are those of the shape; the turn is as sure as noise / field / sqrt(samples), 1e-4.
    np.testing.assert_allclose(fit.triad.matrix, TRUE.mag.matrix, atol=1e-3)
    assert fit.field_uT == pytest.approx(np.linalg.norm(FIELD), rel=1e-3)
    assert fit.dip_deg == pytest.approx(np.degrees(np.arctan2(43.0, 20.0)), abs=0.1)
    # White noise of 0.03 uT/sqrt(Hz) at 50 Hz.
    assert fit.rms_uT == pytest.approx(0.03 * np.sqrt(RATE), rel=0.05)
    assert calibrate_mag(level, 50.0).triad.matrix == pytest.approx(fit.triad.matrix * fit.field_uT / 50.0)


def test_what_is_simulated_is_taken_off_again() -> None:
    motion = poses(SIDES)
    gyro, accel, mag = effects_of(TRUE)
    imu = Imu(
        gyro_effects=gyro, accel_effects=accel, mag_effects=mag, environment=Environment(field_N_uT=FIELD)
    )
    recorded = imu.record(motion, 1)
    better = TRUE.apply(recorded.measured)
    for name in ("gyro", "accel", "mag_uT"):
        # A product and its inverse: round-off of readings of up to 60.
        np.testing.assert_allclose(getattr(better, name), getattr(recorded.ideal, name), atol=1e-12)


def test_a_missing_sample_stays_missing() -> None:
    accel = RECORDING.accel.copy()
    accel[7] = np.nan
    assert np.isnan(TRUE.apply(replace(RECORDING, accel=accel)).accel).any(axis=1).nonzero()[0].tolist() == [
        7
    ]


def test_motion_that_shows_too_little_is_refused_by_axis() -> None:
    about_z = poses([exp_so3(np.array([0.0, 0.0, a])) for a in np.linspace(0.0, 6.0, 14)])
    flat = record(about_z)
    with pytest.raises(ValueError, match=r"mag never turned enough: its z axis ranges over"):
        calibrate_mag(flat)
    with pytest.raises(ValueError, match="accel never turned"):
        calibrate_accel(flat)
    with pytest.raises(ValueError, match="needs 6 poses at rest"):
        calibrate_accel(record(poses([SIDES[0], SIDES[1], exp_so3(np.array([2.0, 2.0, 1.0])), SIDES[4]])))
    about_tilted = record(poses([exp_so3(a * np.ones(3) / np.sqrt(3.0)) for a in np.linspace(0.0, 6.0, 20)]))
    with pytest.raises(ValueError, match=r"mag (never turned enough|readings lie on no ellipsoid)"):
        calibrate_mag(about_tilted)
    moving = replace(RECORDING, gyro=RECORDING.gyro + np.sin(20.0 * RECORDING.t)[:, None])
    with pytest.raises(ValueError, match="needs 2 s of rest; this recording has 0 s"):
        calibrate_gyro(moving)
    with pytest.raises(ValueError, match="no magnetometer"):
        calibrate_mag(replace(RECORDING, mag_uT=None))
    with pytest.raises(ValueError, match="the recording none"):
        TRUE.apply(replace(RECORDING, mag_uT=None))


@pytest.mark.parametrize(("rest", "found"), [(4.0, True), (0.0, False)])
def test_slow_smooth_turning_is_no_rest(rest, found) -> None:
    """As magnetometers are to be turned: below 35 deg/s, with no tremor, for two minutes."""
    t = np.arange(6000) / 50.0
    begun = np.clip((t - rest) / 3.0, 0.0, 1.0) ** 3 if rest else np.ones_like(t)
    waves = np.sin(t[:, None] * [0.19, 0.31, 0.23] + [0.0, 1.0, 2.0])
    R = exp_so3(1.3 * begun[:, None] * waves)
    turns = 50.0 * log_so3(np.swapaxes(R[:-1], 1, 2) @ R[1:])
    assert np.quantile(np.linalg.norm(turns, axis=1), 0.95) < np.deg2rad(35.0)
    noise = np.random.default_rng(12).normal(size=(2, 6000, 3))
    recording = ImuRecording(
        t,
        np.vstack([turns, turns[-1:]]) + 0.002 * noise[0] + TRUE.gyro.bias,
        np.array([0.0, 0.0, G]) @ R + 0.02 * noise[1],
    )
    if found:
        triad = calibrate_gyro(recording)
        assert within(triad.bias, TRUE.gyro.bias, triad.bias_error)
        assert (triad.bias_error < 5e-4).all()  # 0.002 rad/s, four seconds at 50 Hz: 1.4e-4
    else:
        with pytest.raises(ValueError, match="2 s of rest"):
            calibrate_gyro(recording)
