"""A recording with known faults, aligned: they are found within their errors, and what is not shown is named."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.data.motion import Mount
from kreisel.data.recording import ImuRecording
from kreisel.evaluate.align import Alignment, align
from kreisel.evaluate.align.parameters import SIZES
from kreisel.maths.rotations import exp_so3, log_so3
from kreisel.simulate.effects.gauss_markov import GaussMarkov
from kreisel.simulate.effects.white_noise import WhiteNoise
from kreisel.simulate.imu import Imu
from tests.evaluate.align.moving import PATH, TURNS, T, Truth, along, every_way, still

NOISE = (WhiteNoise(1e-3),), (WhiteNoise(5e-3),)  # 0.01 rad/s and 0.05 m/s^2 at 100 Hz


def off(found: Alignment, truth: Truth) -> dict[str, np.ndarray]:
    """Found minus true, parameter by parameter; of the rotation about the sensor's axes."""
    values = {f.name: f.values for f in found.found}
    errors = {name: values[name] - getattr(truth, name) for name in values if name != "rotation"}
    if "rotation" in values:
        errors["rotation"] = log_so3(truth.R_BS.T @ found.mount.R_BS)
    return errors


def in_errors(found: Alignment, truth: Truth) -> np.ndarray:
    return np.concatenate([error / found.errors[name] for name, error in off(found, truth).items()])


def imu_on(trajectory, mount=None) -> ImuRecording:
    return Imu(mount or Mount([0.1, 0.02, -0.05]), *NOISE).record(trajectory.sample(T), 1).measured


def test_without_noise_every_fault_is_found_exactly(rng):
    # Nor latency, which is simulated by a cubic between samples.
    truth = Truth(rng, latency=0.0)
    found = align(truth.recording(), every_way(), estimate=tuple(SIZES))
    assert found.notes == ()
    for name, error in off(found, truth).items():
        # Round-off of the spline's second derivative, 1e-10 m/s^2, and least squares' own.
        assert np.abs(error).max() < 1e-9, name


def test_faults_lie_within_their_standard_errors():
    draws = [Truth(np.random.default_rng(seed)) for seed in range(12)]
    z = np.array(
        [
            in_errors(align(truth.recording(*NOISE, rng=seed), every_way(), estimate=tuple(SIZES)), truth)
            for seed, truth in enumerate(draws)
        ]
    )
    # 276 numbers of which 0.3 % may be beyond three; of 100 such draws 98 had none.
    assert np.mean(np.abs(z) < 3.0) > 0.98
    # Twelve draws know a standard deviation to 20 %; the mean of 23 such is known better.
    assert 0.8 < np.sqrt(np.mean(z * z)) < 1.2


def test_noise_that_hangs_together_widens_the_errors():
    """Correlated over 50 ms: of a thousand samples some hundred and fifty count, as (1 - phi) / (1 + phi) says."""
    slow = (GaussMarkov(0.02, 0.05),), (GaussMarkov(0.1, 0.05),)
    z, effective = [], []
    for seed in range(12):
        truth = Truth(np.random.default_rng(seed))
        truth.drift, truth.gyro_scale, truth.accel_scale = 0.0, np.ones(3), np.ones(3)
        found = align(truth.recording(*slow, rng=seed), every_way())
        z.append(in_errors(found, truth))
        effective.append(found.gyro.effective_samples / found.gyro.samples)
    phi = np.exp(-0.01 / 0.05)
    assert np.mean(effective) == pytest.approx((1.0 - phi) / (1.0 + phi), rel=0.5)
    # Taken for white it would be 3; a tenth too small is what windows of a tenth of the record cost.
    assert np.sqrt(np.mean(np.square(z))) < 1.4


def test_the_twin_is_what_an_imu_in_that_place_reads(rng):
    truth = Truth(rng, latency=0.0)
    recording = truth.recording()
    found = align(recording, every_way(), estimate=tuple(SIZES))
    for sensor in ("gyro", "accel"):
        difference = getattr(found.twin, sensor) - getattr(recording, sensor)
        inside = np.isfinite(difference[:, 0])
        assert inside.sum() > 900
        np.testing.assert_allclose(difference[inside], 0.0, atol=1e-8)
        agreement = getattr(found, sensor)
        assert agreement.samples == inside.sum()
        np.testing.assert_allclose(
            agreement.rmse, np.sqrt(np.mean(difference[inside] ** 2, axis=0)), atol=1e-15
        )
        assert (agreement.correlation > 0.999999).all()
    better = found.calibration.apply(recording)
    np.testing.assert_allclose(better.gyro, (recording.gyro - found.gyro.bias) / found.gyro.scale, atol=1e-12)


def test_what_is_not_asked_for_stays_as_given(rng):
    truth = Truth(rng)
    mount = Mount(truth.lever_arm, truth.R_BS, "wrist")
    recording = Imu(mount).ideal(every_way().sample(T))
    found = align(recording, every_way(), estimate=("gyro_clock",), mount=mount)
    assert set(found.errors) == {"gyro_clock"} and found.mount.name == "wrist"
    np.testing.assert_array_equal(found.mount.R_BS, mount.R_BS)
    np.testing.assert_array_equal(found.mount.p_BS, mount.p_BS)
    assert abs(found.gyro.clock) < 1e-9 and found.accel.total_rmse < 1e-9
    # Nothing asked for: the two are laid over each other as they are, seldom turned by little.
    as_is = align(recording, every_way(), estimate=())
    assert as_is.errors == {} and as_is.gyro.total_rmse > 1e-3


def test_missing_samples_and_epochs_change_nothing(rng):
    truth = Truth(rng)
    recording = truth.recording(*NOISE)
    whole = align(recording, every_way())
    gyro, accel = recording.gyro.copy(), recording.accel.copy()
    gyro[100:140], accel[500] = np.nan, np.nan
    epoch = 1_600_000_000_000_000_000
    trajectory = along(PATH, TURNS)
    object.__setattr__(trajectory, "t0_ns", epoch)
    shifted = ImuRecording(recording.t + 3.0, gyro, accel, t0_ns=epoch - 3_000_000_000)
    found = align(shifted, trajectory)
    assert found.gyro.samples == whole.gyro.samples - 40 and found.accel.samples == whole.accel.samples - 1
    # Forty samples in a thousand move an estimate by a fifth of its error, seldom by one.
    assert np.abs(found.mount.p_BS - whole.mount.p_BS).max() < 2.0 * whole.errors["lever_arm"].max()
    assert found.gyro.clock == pytest.approx(whole.gyro.clock, abs=2.0 * whole.errors["gyro_clock"][0])


@pytest.mark.parametrize("noise_m", [0.0, 1e-3])
def test_rotation_about_one_axis_hides_what_lies_along_it(noise_m):
    """A turn about z shows neither a lever arm along z nor a turn of the sensor about it, however noisy the poses."""
    turning = (still, still, lambda t: np.sin(3.0 * t))
    recording = imu_on(along((still,) * 3, turning))
    seen = along((still,) * 3, turning, noise_m, np.random.default_rng(1) if noise_m else None)
    found = align(recording, seen)
    assert np.isinf(found.errors["lever_arm"]).tolist() == [False, False, True]
    assert np.isinf(found.errors["rotation"]).tolist() == [False, False, True]
    assert found.mount.p_BS[2] == pytest.approx(0.0, abs=1e-4)
    assert np.abs(log_so3(found.mount.R_BS)).max() < 2e-3
    np.testing.assert_allclose(found.mount.p_BS[:2], [0.1, 0.02], atol=2e-3)
    texts = [note.text for note in found.notes]
    assert "lever_arm along z of the body is not shown by this motion and stays as given." in texts
    assert "rotation along z of the sensor is not shown by this motion and stays as given." in texts


def test_a_hidden_axis_may_be_oblique():
    tilted = (still, lambda t: 0.7 + 0.0 * t, lambda t: np.sin(3.0 * t))
    found = align(imu_on(along((still,) * 3, tilted)), along((still,) * 3, tilted))
    # z of N in body axes: the body is pitched by 0.7 rad.
    axis = f"({-np.sin(0.7):.2f}, "
    assert any(n.text.startswith("lever_arm along " + axis) for n in found.notes), found.notes


def test_translation_alone_shows_no_lever_arm_but_the_rotation():
    R_BS = exp_so3(np.array([0.3, -2.0, 1.0]))
    gliding = along(PATH, (still,) * 3)
    found = align(imu_on(gliding, Mount(R_BS=R_BS)), gliding)
    assert np.isinf(found.errors["lever_arm"]).all() and np.isinf(found.errors["gyro_clock"]).all()
    np.testing.assert_allclose(found.mount.p_BS, 0.0, atol=1e-12)
    turn = log_so3(R_BS.T @ found.mount.R_BS)
    assert (np.abs(turn) < 4.0 * found.errors["rotation"]).all()
    assert np.isnan(found.gyro.correlation).all()


def test_a_level_path_takes_bias_and_scale_of_its_vertical_for_one():
    flat = along((PATH[0], PATH[1], still), (still, still, lambda t: np.sin(t)))
    found = align(imu_on(flat), flat, estimate=("accel_bias", "accel_scale", "rotation", "gyro_bias"))
    assert np.isinf(found.errors["accel_bias"][2]) and np.isinf(found.errors["accel_scale"][2])
    assert any("accel_bias along z" in n.text and "apart from accel_scale" in n.text for n in found.notes)


def test_bad_input_is_told_in_a_sentence(rng):
    resting = along((still,) * 3, (still,) * 3)
    with pytest.raises(ValueError, match="too little motion to align by: the body turns at 0 rad/s"):
        align(imu_on(resting), resting)
    # Biases need no motion.
    rest = align(imu_on(resting), resting, estimate=("gyro_bias", "accel_bias"))
    assert (np.abs(rest.gyro.bias) < 4.0 * rest.errors["gyro_bias"]).all()
    recording = Truth(rng).recording(*NOISE)
    late = ImuRecording(recording.t + 100.0, recording.gyro, recording.accel)
    with pytest.raises(ValueError, match="do not overlap in time: the recording spans 10"):
        align(late, every_way())
    other = along(
        (lambda t: np.sin(t), still, still), (lambda t: 0.6 * np.sin(1.3 * t + 0.1 * t * t), still, still)
    )
    with pytest.raises(ValueError, match="do not show the same motion"):
        align(recording, other)
    with pytest.raises(
        ValueError, match=r"45 of the gyro.s samples lie inside the trajectory's span; 50 are needed"
    ):
        few = slice(0, 45)
        align(ImuRecording(T[few], recording.gyro[few], recording.accel[few]), every_way(), estimate=())
    with pytest.raises(ValueError, match="Did you mean 'lever_arm'"):
        align(recording, every_way(), estimate=("leverarm",))
    with pytest.raises(TypeError, match="trajectory must have a span and sample"):
        align(recording, every_way().sample(T))
    nothing = ImuRecording(T, np.full((len(T), 3), np.nan), recording.accel)
    with pytest.raises(ValueError, match="no gyro sample"):
        align(nothing, every_way())
