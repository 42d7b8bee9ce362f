"""The tutorial's step: to the letter, with its three weaknesses as facts and each cure as another."""

import dataclasses

import numpy as np
import pytest

from kreisel.data.recording import ImuRecording
from kreisel.estimate.filters.dcm import DcmFilter, PublishedStep
from kreisel.estimate.run import run
from tests.estimate.filters.transcription import Array, enu, first_attitude, ijk, published_step
from tests.estimate.filters.turning import angles_deg, tumbling, turning

WEIGHTS = (1.0, 0.02, 0.03)


def noisy(n: int, rng: np.random.Generator, dt: float = 0.01) -> ImuRecording:
    """A tumbling recording with noise on all sensors and a magnetometer at a third of the rate."""
    t = np.arange(n) * dt
    recording, _ = turning(t, tumbling(t, rng))
    mag = recording.mag_uT + rng.normal(0.0, 0.5, (n, 3))
    mag[np.arange(n) % 3 > 0] = np.nan
    accel = recording.accel + rng.normal(0.0, 0.3, (n, 3))
    return ImuRecording(t, recording.gyro + rng.normal(0.0, 0.02, (n, 3)), accel, mag_uT=mag)


def by_the_document(recording: ImuRecording, weights: tuple[float, float, float]) -> Array:
    assert recording.mag_uT is not None
    gyro, accel, mag = (x.tolist() for x in (recording.gyro, recording.accel, recording.mag_uT))
    dt = np.diff(recording.t).tolist()
    rows = first_attitude(accel[0], mag[0])
    answer = [enu(rows)]
    for k in range(1, len(recording)):
        rows = published_step(rows, gyro[k], accel[k], mag[k], dt[k - 1], weights)
        answer.append(enu(rows))
    return np.array(answer)


def test_each_step_is_the_document_s(rng: np.random.Generator) -> None:
    recording = noisy(1000, rng)
    assert recording.mag_uT is not None
    # The filter itself: a stream shows the nearest rotations, while the document's axes are off by dtheta^4.
    filter = DcmFilter.as_published(*WEIGHTS)
    state, parameters = filter.start(), filter.parameters()
    samples = np.hstack([recording.gyro, recording.accel, recording.mag_uT])
    filter.update(state, parameters, samples[0], 0.0)
    for sample in samples[1:]:
        gyro, accel, mag = sample.reshape(3, 3).tolist()
        expected = enu(published_step(ijk(state[:9].reshape(3, 3)), gyro, accel, mag, 0.01, WEIGHTS))
        filter.update(state, parameters, sample, 0.01)
        # Some twenty operations on numbers below one, each rounded to 1.1e-16.
        assert np.abs(state[:9].reshape(3, 3) - expected).max() < 1e-14


def test_a_hundred_thousand_steps_stay_with_the_document_s(rng: np.random.Generator) -> None:
    recording = noisy(100_000, rng)
    assert recording.mag_uT is not None
    found = run(DcmFilter.as_published(*WEIGHTS), recording).R_NS
    # `run` returns the nearest rotations, while the document's axes are off by dtheta^4.
    left, _, right = np.linalg.svd(by_the_document(recording, WEIGHTS))
    # Differences of 1e-15 per step are forgotten within 100 steps, so that this leaves room for ten thousand.
    assert np.abs(found - left @ right).max() < 1e-9


def ten_turns(dt: float = 0.01) -> tuple[ImuRecording, Array]:
    t = np.arange(round(100.0 / dt) + 1) * dt
    return turning(t, np.tile([0.0, 0.0, np.radians(36.0)], (len(t), 1)))


def error_after_ten_turns(step: PublishedStep, dt: float = 0.01) -> float:
    recording, truth = ten_turns(dt)
    history = run(DcmFilter(mode="6", published=step), recording, R_NS=truth[0])
    return float(angles_deg(history.R_NS[-1], truth[-1])[1])


def test_published_weights_lose_36_degrees_in_ten_turns() -> None:
    # Every turn is short by s_a / (s_g + s_a) = 0.01 / 1.01, of 3600 degrees: 35.64.
    assert error_after_ten_turns(PublishedStep(1.0, 0.01, 0.0, exact=True)) == pytest.approx(
        36.0 / 1.01, abs=1e-6
    )
    # The first-order step turns by atan(dtheta) < dtheta: a further 3600 deg * (2 pi / 1000)^2 / 3 = 0.047.
    assert error_after_ten_turns(PublishedStep(1.0, 0.01, 0.0)) == pytest.approx(35.64, abs=0.06)


def test_weights_where_a_sensor_observes_lose_nothing() -> None:
    # 1e4 exact steps that round to 1e-16 each.
    assert error_after_ten_turns(PublishedStep(1.0, 0.01, 0.0, observed=True, exact=True)) < 1e-9


@pytest.mark.parametrize("dt", [0.01, 0.05])
def test_the_first_order_step_falls_short_by_a_third_of_its_square(dt: float) -> None:
    # atan(a) = a - a^3 / 3 per step of a, here up to 0.03 rad: the next term is a^2 smaller, 0.1 %.
    a = np.radians(36.0) * dt
    short = error_after_ten_turns(PublishedStep(1.0, 0.01, 0.0, observed=True), dt)
    assert short == pytest.approx(3600.0 * a**2 / 3.0, rel=2e-3)
    assert error_after_ten_turns(PublishedStep(1.0, 0.01, 0.0, observed=True, exact=True), dt) < 1e-9


def tilt_left(step: PublishedStep, dt: float) -> float:
    """What one second of rest leaves of a tilt of 0.1 rad, as a fraction."""
    t = np.arange(round(1.0 / dt) + 1) * dt
    recording, truth = turning(t, np.zeros((len(t), 3)))
    tilted = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(0.1), -np.sin(0.1)], [0.0, np.sin(0.1), np.cos(0.1)]])
    history = run(DcmFilter(mode="6", published=step), recording, R_NS=tilted)
    return float(np.radians(angles_deg(history.R_NS[-1], truth[-1])[2])) / 0.1


def test_weights_of_a_rate_keep_their_time_constant_at_others() -> None:
    step = PublishedStep(1.0, 0.01, 0.0, observed=True, exact=True)
    with_rate = dataclasses.replace(step, rate_hz=100.0)
    # Without the cure ten times the steps forget ten times as fast.
    assert tilt_left(step, 0.001) == pytest.approx(tilt_left(step, 0.01) ** 10, rel=0.02)
    # sin(a) stands for a in the correction: a^2 / 6 = 0.2 % of it.
    assert tilt_left(with_rate, 0.001) == pytest.approx(tilt_left(with_rate, 0.01), rel=4e-3)


def test_negative_weights_are_refused() -> None:
    with pytest.raises(ValueError, match="weights must be > 0 for the gyro"):
        DcmFilter.as_published(0.0, 0.01, 0.01)
