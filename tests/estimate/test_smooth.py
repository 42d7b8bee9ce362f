"""Smoothing: no worse than looking back alone, the same in blocks, and as sure as it says."""

import dataclasses

import numpy as np
import pytest

from kreisel.data.recording import ImuRecording
from kreisel.estimate.filters.dcm import DcmFilter
from kreisel.estimate.filters.mekf import MekfFilter
from kreisel.estimate.filters.mekf import smooth as blocks
from kreisel.estimate.run import run
from kreisel.estimate.smooth import smooth, smooth_all
from tests.estimate.filters.test_mekf import worn
from tests.estimate.filters.turning import Array, angles_deg, tumbling, turning


def imperfect(seconds: float, rng: np.random.Generator) -> tuple[ImuRecording, Array]:
    """A phone in a hand, its gyro off by 0.5 deg/s and half a percent."""
    recording, truth = worn(seconds, rng, rest=0.0)
    return dataclasses.replace(recording, gyro=1.005 * recording.gyro + np.radians([0.5, -0.4, 0.3])), truth


def rms(recording: ImuRecording, truth: Array, **tuning: float) -> tuple[float, float]:
    filter = MekfFilter(**tuning)
    histories = run(filter, recording), smooth(filter, recording)
    back, both = (np.sqrt(np.mean(angles_deg(h.R_NS, truth)[0] ** 2)) for h in histories)
    return float(back), float(both)


def test_what_comes_after_helps(rng: np.random.Generator) -> None:
    back, both = rms(*imperfect(90.0, rng))
    # The first seconds alone, off by degrees when looked at from before, make twice the error.
    assert both < 0.5 * back


def test_a_start_on_its_head_is_mended_from_behind(rng: np.random.Generator) -> None:
    recording, truth = worn(60.0, rng, rest=0.0)
    upside_down = truth[0] * np.array([[1.0], [-1.0], [-1.0]])
    begun_wrong = angles_deg(smooth(MekfFilter(), recording, R_NS=upside_down).R_NS, truth)[0]
    # Looking back from where the filter began again stopped there: 100 deg and more through the first seconds.
    assert begun_wrong.max() < 3.0


def test_the_end_knows_nothing_more(rng: np.random.Generator) -> None:
    recording, _ = imperfect(60.0, rng)
    history, smoothed = run(MekfFilter(), recording), smooth(MekfFilter(), recording)
    assert history.sigma is not None and smoothed.sigma is not None
    assert (smoothed.sigma[:3000] < history.sigma[:3000] + 1e-9).all()
    # From another start, the same covariance but for where it was linearised.
    assert smoothed.sigma[-1] == pytest.approx(history.sigma[-1], rel=0.2)


def test_truth_stays_truth(rng: np.random.Generator) -> None:
    t = np.arange(6000) * 0.01
    recording, truth = turning(t, tumbling(t, rng, rate=3.0))
    smoothed = smooth(MekfFilter(), recording, R_NS=truth[0])
    # Corrections of nothing: round-off alone, of two passes and of one back.
    assert np.radians(angles_deg(smoothed.R_NS, truth)[0]).max() < 1e-9


def test_blocks_join(rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> None:
    recording, truth = imperfect(120.0, rng)
    whole = smooth(MekfFilter(), recording)
    monkeypatch.setattr(blocks, "_BLOCK", 17.3)
    monkeypatch.setattr(blocks, "_AHEAD", 60.0)
    parts = smooth(MekfFilter(), recording)
    apart = angles_deg(parts.R_NS, whole.R_NS)[0]
    # What lies more than a minute ahead tells little. In 40 draws the two were 0.04 deg apart (RMS), 0.12 at most,
    # beside 0.14 deg of error that is left anyway, and no two neighbours parted by more than 0.05 deg.
    assert apart.max() < 0.8 and np.sqrt(np.mean(apart**2)) < 0.25
    assert np.diff(apart).max() < 0.2
    for history in (whole, parts):
        assert np.sqrt(np.mean(angles_deg(history.R_NS, truth)[0] ** 2)) < 0.6


def test_a_late_magnetometer_reaches_back(rng: np.random.Generator) -> None:
    recording, truth = imperfect(60.0, rng)
    assert recording.mag_uT is not None
    mag = np.array(recording.mag_uT)
    mag[:2000] = np.nan
    total = angles_deg(smooth(MekfFilter(), dataclasses.replace(recording, mag_uT=mag)).R_NS, truth)[0]
    assert total.max() < 4.0


def test_holes_and_faults_are_survived(rng: np.random.Generator) -> None:
    recording, truth = imperfect(100.0, rng)
    gyro, accel = np.array(recording.gyro), np.array(recording.accel)
    gyro[3000:3600] = np.nan
    accel[5000:5200] = 0.0
    smoothed = smooth(MekfFilter(), dataclasses.replace(recording, gyro=gyro, accel=accel))
    assert smoothed.sigma is not None and np.isfinite(smoothed.sigma).all()
    assert angles_deg(smoothed.R_NS, truth)[0][-3000:].max() < 3.0


def test_nothing_shows_which_way_is_up() -> None:
    t = np.arange(300) * 0.01
    nothing = np.full((300, 3), np.nan)
    smoothed = smooth(MekfFilter(), ImuRecording(t, np.zeros((300, 3)), nothing))
    assert smoothed.held is not None and smoothed.held.all()
    assert len(smooth(MekfFilter(), ImuRecording(t[:1], nothing[:1], nothing[:1]))) == 1


def test_many_at_once_have_the_same_bits(rng: np.random.Generator) -> None:
    recordings = [imperfect(seconds, rng)[0] for seconds in (5.0, 8.0, 6.0)]
    together = smooth_all(MekfFilter(), recordings, threads=2)
    for history, recording in zip(together, recordings, strict=True):
        assert np.array_equal(history.R_NS, smooth(MekfFilter(), recording).R_NS)


def test_a_filter_without_covariance_is_refused(rng: np.random.Generator) -> None:
    with pytest.raises(TypeError, match="Take MekfFilter"):
        smooth(DcmFilter(), imperfect(1.0, rng)[0])
