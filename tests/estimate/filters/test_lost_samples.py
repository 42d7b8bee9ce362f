"""Samples that never arrive: a few cost next to nothing, and a long gap costs what nobody measured."""

import dataclasses

import numpy as np
import pytest

from kreisel.data.recording import ImuRecording
from kreisel.estimate.filters.dcm import DcmFilter
from kreisel.estimate.filters.mekf import MekfFilter
from kreisel.estimate.run import run
from tests.estimate.filters.turning import turning

FS, NOISE = 100.0, np.radians(0.1)
BIAS = np.radians([0.5, -0.4, 0.3])


def at_rest(seconds: float, rng: np.random.Generator) -> ImuRecording:
    t = np.arange(round(seconds * FS)) / FS
    recording, _ = turning(t, np.zeros((len(t), 3)))
    gyro = recording.gyro + BIAS + rng.normal(0.0, NOISE, recording.gyro.shape)
    accel = recording.accel + rng.normal(0.0, 0.05, gyro.shape)
    return dataclasses.replace(recording, gyro=gyro, accel=accel)


def without(recording: ImuRecording, lost: np.ndarray) -> ImuRecording:
    gyro, accel = recording.gyro.copy(), recording.accel.copy()
    gyro[lost], accel[lost] = np.nan, np.nan
    return dataclasses.replace(recording, gyro=gyro, accel=accel)


@pytest.mark.parametrize("filter", [DcmFilter(), MekfFilter()], ids=lambda f: type(f).__name__)
@pytest.mark.parametrize("share", [0.02, 0.1])
def test_samples_lost_here_and_there_do_not_hide_rest(filter, share, rng: np.random.Generator) -> None:
    recording = at_rest(10.0, rng)
    history = run(filter, without(recording, rng.random(len(recording)) < share))
    assert history.rest is not None and history.gyro_bias is not None
    # Five lost in a row, once in a thousand seconds, begin the half second anew, a sixteenth of these eight.
    assert history.rest[200:].mean() > 0.9
    # Seven seconds of 0.1 deg/s at 100 Hz have a mean good to 0.004 deg/s; six of those, for held ones count twice.
    assert np.abs(np.degrees(history.gyro_bias[-1] - BIAS)).max() < 0.024


def test_a_gap_costs_little_while_the_latest_rate_stands_for_it_and_all_beyond(
    rng: np.random.Generator,
) -> None:
    recording = at_rest(6.0, rng)
    known = run(MekfFilter(mode="6"), recording)

    def growth(samples: int) -> float:
        """Variance of the heading, rad^2, that a gap of so many samples adds; nothing here takes it back."""
        lost = np.zeros(len(recording), dtype=bool)
        lost[400 : 400 + samples] = True
        gappy = run(MekfFilter(mode="6"), without(recording, lost))
        assert known.sigma is not None and gappy.sigma is not None
        return float(gappy.sigma[450, 2] ** 2 - known.sigma[450, 2] ** 2)

    # One sample: a rate that changes by 20 rad/s^2 turns by 1e-3 rad in 10 ms; beside it 0.7 deg/s of bias are nothing.
    assert growth(1) == pytest.approx(1e-6, rel=0.1)
    # Thirty: nothing stands for the rotation any more, 1 rad^2/s.
    assert growth(30) == pytest.approx(0.3, rel=0.1)
