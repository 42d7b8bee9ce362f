"""The default DCM filter on bodies that travel: steady turns, starts and stops, with perfect sensors."""

import dataclasses

import numpy as np
import pytest

from kreisel.data.recording import ImuRecording
from kreisel.estimate.filters.dcm import DcmFilter
from kreisel.estimate.run import run
from tests.estimate.filters.turning import Array, angles_deg, turning

FS = 100.0


def driven(seconds: list[float], speed: list[float], rate: list[float]) -> tuple[ImuRecording, Array]:
    """Legs of constant speed (m/s, along x_S) and yaw rate (rad/s), a third of a second from one to the next."""
    counts = np.round(np.multiply(seconds, FS)).astype(int)
    soft = np.hanning(65)[1:-1] / np.hanning(65).sum()
    v, w = (np.convolve(np.pad(np.repeat(x, counts), 31, "edge"), soft, "valid") for x in (speed, rate))
    gyro = np.outer(w, [0.0, 0.0, 1.0])
    recording, truth = turning(np.arange(len(v)) / FS, gyro)
    drive = np.stack([np.gradient(v, 1.0 / FS), v * w, np.zeros_like(v)], axis=1)
    return dataclasses.replace(recording, accel=recording.accel + drive), truth


@pytest.mark.parametrize("rest", [0.0, 20.0])
@pytest.mark.parametrize("mode", ["9", "6"])
def test_a_steady_turn_is_no_bias(rest: float, mode: str) -> None:
    # A circle of 1 m in 4 s: 2.5 m/s^2 to the side, 14 deg in the accelerometer, for as long as it lasts.
    w = 0.5 * np.pi
    recording, truth = driven([rest, 60.0], [0.0, w], [0.0, w])
    history = run(DcmFilter(mode=mode), recording)
    settled = recording.t > rest + 20.0
    # A Butterworth filter of 5 s that knows nothing of travel passes 1 / (5 w)^2 of it, 0.23 deg.
    assert angles_deg(history.R_NS, truth)[2][settled].max() < 0.3
    # A start within the turn leaves no more than the spread; 5.6 deg/s were learned from it as noise without memory.
    assert history.gyro_bias is not None
    assert np.degrees(np.linalg.norm(history.gyro_bias[settled], axis=1)).max() < 0.5


def test_corners_and_straights() -> None:
    # Begun on the way; straights seem to be rest, at 0.8 m/s. 5 deg where that is believed.
    recording, truth = driven([2.0, 0.8] * 20, [0.8] * 40, [0.0, 2.0] * 20)
    assert angles_deg(run(DcmFilter(), recording).R_NS, truth)[2][2000:].max() < 0.5


def test_a_stop_after_steady_travel_tips_little() -> None:
    recording, truth = driven([10.0, 30.0, 20.0], [0.0, 3.0, 0.0], [0.0, 0.0, 0.0])
    history = run(DcmFilter(), recording)
    assert history.rest is not None and history.rest[3500]
    # Without travel 3 m/s come and go as tilt, g times 5 s of which is 3.5 deg: 1.2 of them, and here 0.6.
    assert angles_deg(history.R_NS, truth)[2].max() < 0.9
