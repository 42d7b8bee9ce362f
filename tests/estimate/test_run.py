"""Batch runs and streams: the same bits, and doors that teach."""

import numpy as np
import pytest

from kreisel.data.recording import ImuRecording
from kreisel.estimate.filters import AttitudeFilter
from kreisel.estimate.filters.dcm import DcmFilter, PublishedStep
from kreisel.estimate.filters.mekf import MekfFilter
from kreisel.estimate.run import run
from kreisel.estimate.stream import Stream
from tests.estimate.filters.turning import tumbling, turning

FILTERS = [
    DcmFilter(),
    DcmFilter(mode="6"),
    DcmFilter(mode="gyro", coning=True),
    MekfFilter(),
    MekfFilter(mode="6"),
    MekfFilter(mode="gyro", coning=True),
    DcmFilter.as_published(1.0, 0.01, 0.01),
    DcmFilter(published=PublishedStep(exact=True)),
    DcmFilter(published=PublishedStep(exact=True, observed=True, rate_hz=100.0)),
]


def recorded(rng: np.random.Generator, n: int = 2000) -> ImuRecording:
    """Tumbling with noise, uneven time, and holes in all sensors."""
    t = np.cumsum(rng.uniform(0.005, 0.015, n))
    recording, _ = turning(t, tumbling(t, rng))
    sensors = [
        np.array(x) + rng.normal(0.0, 0.05, (n, 3))
        for x in (recording.gyro, recording.accel, recording.mag_uT)
    ]
    for sensor in sensors:
        sensor[rng.random(n) < 0.1] = np.nan
    return ImuRecording(t, sensors[0], sensors[1], mag_uT=sensors[2])


@pytest.mark.parametrize("filter", FILTERS)
def test_stream_equals_batch_bit_for_bit(filter: AttitudeFilter, rng: np.random.Generator) -> None:
    recording = recorded(rng)
    assert recording.mag_uT is not None
    history = run(filter, recording)
    assert history.gyro_bias is not None and history.held is not None
    stream = Stream(filter)
    for k in range(len(recording)):
        dt = recording.t[k] - recording.t[max(k - 1, 0)]
        stream.update(recording.gyro[k], recording.accel[k], recording.mag_uT[k], dt=dt)
        assert np.array_equal(stream.R_NS, history.R_NS[k])
        assert np.array_equal(stream.gyro_bias, history.gyro_bias[k])
        assert stream.held == history.held[k]
        assert (stream.sigma is None) == (history.sigma is None)
        if history.sigma is not None:
            assert np.array_equal(stream.sigma, history.sigma[k])


@pytest.mark.parametrize("filter", FILTERS)
def test_no_time_no_change(filter: AttitudeFilter, rng: np.random.Generator) -> None:
    recording, _ = turning(np.arange(500) * 0.01, rng.normal(size=(500, 3)))
    assert recording.mag_uT is not None
    stream, twice = Stream(filter), Stream(filter)
    for gyro, accel, mag in zip(recording.gyro, recording.accel, recording.mag_uT, strict=True):
        stream.update(gyro, accel, mag, dt=0.01)
        twice.update(gyro, accel, mag, dt=0.01)
        twice.update(*rng.normal(size=(3, 3)), dt=0.0)
    assert np.array_equal(stream.R_NS, twice.R_NS)


def test_time_that_runs_back_is_refused() -> None:
    stream = Stream(DcmFilter())
    for dt in (-0.01, np.nan):
        with pytest.raises(ValueError, match="Time must not run back"):
            stream.update([0.0, 0.0, 0.0], [0.0, 0.0, 9.8], dt=dt)


def test_a_missing_magnetometer_is_refused_where_it_was_asked_for(rng: np.random.Generator) -> None:
    recording = recorded(rng)
    without = ImuRecording(recording.t, recording.gyro, recording.accel)
    with pytest.raises(ValueError, match="needs a magnetometer"):
        run(DcmFilter(mode="9"), without)
    assert len(run(DcmFilter(), without)) == len(without)


def test_unknown_modes_and_impossible_tuning_are_refused() -> None:
    with pytest.raises(ValueError, match="mode must be one of"):
        DcmFilter(mode="12")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="accel_time must not be negative"):
        DcmFilter(accel_time=-1.0)
    with pytest.raises(ValueError, match="mag_time must be finite"):
        DcmFilter(mag_time=np.inf)


def test_held_until_something_shows_which_way_is_up() -> None:
    stream = Stream(DcmFilter())
    nothing = [np.nan] * 3
    stream.update([0.0, 0.0, 0.1], nothing, dt=0.0)
    assert stream.held
    stream.update([0.0, 0.0, 0.1], [0.0, 9.81, 0.0], dt=0.01)
    assert not stream.held
    up = stream.R_NS @ [0.0, 9.81, 0.0]
    assert up == pytest.approx([0.0, 0.0, 9.81])


def test_inputs_are_left_alone(rng: np.random.Generator) -> None:
    recording = recorded(rng)
    assert recording.mag_uT is not None
    before = [x.copy() for x in (recording.t, recording.gyro, recording.accel, recording.mag_uT)]
    run(DcmFilter(), recording)
    after = (recording.t, recording.gyro, recording.accel, recording.mag_uT)
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(before, after, strict=True))
