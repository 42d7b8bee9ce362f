"""Streams as values and as files: what they know, and that a stop leaves no trace."""

from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.estimate.filters.dcm import DcmFilter, PublishedStep
from kreisel.estimate.run import run
from kreisel.estimate.stream import Stream
from tests.estimate.filters.turning import GRAVITY
from tests.estimate.test_run import FILTERS, recorded


def feed(stream: Stream, recording: kreisel.ImuRecording, first: int, last: int) -> None:
    assert recording.mag_uT is not None
    for k in range(first, last):
        dt = recording.t[k] - recording.t[max(k - 1, 0)]
        stream.update(recording.gyro[k], recording.accel[k], recording.mag_uT[k], dt=dt)


@pytest.mark.parametrize("filter", FILTERS)
def test_a_stop_leaves_no_trace(filter: DcmFilter, rng: np.random.Generator, tmp_path: Path) -> None:
    recording, path = recorded(rng, 700), tmp_path / "stream.npz"
    without_stop = Stream(filter)
    feed(without_stop, recording, 0, len(recording))
    # Before anything came in, within a window, and within a gap of any sensor.
    for stop in (0, *rng.integers(1, len(recording), 3)):
        stream = Stream(filter)
        feed(stream, recording, 0, stop)
        before = stream.snapshot()
        stream.save(path)
        resumed = Stream.load(path)
        assert resumed.filter == filter
        assert same(resumed.snapshot(), before)
        feed(resumed, recording, stop, len(recording))
        assert same(resumed.snapshot(), without_stop.snapshot())
        assert np.array_equal(resumed._state, without_stop._state)


def same(a: tuple, b: tuple) -> bool:
    return all(np.array_equal(x, y, equal_nan=True) for x, y in zip(a, b, strict=True))


@pytest.mark.parametrize("filter", FILTERS)
def test_a_snapshot_is_the_row_of_the_history(filter: DcmFilter, rng: np.random.Generator) -> None:
    recording = recorded(rng, 300)
    history, stream = run(filter, recording), Stream(filter)
    columns = (history.R_NS, history.gyro_bias, history.a_N, history.rest, history.disturbed, history.held)
    for k in range(len(recording)):
        feed(stream, recording, k, k + 1)
        shown = stream.snapshot()._asdict()
        del shown["heading_offset"]
        assert same(tuple(shown.values()), tuple(column[k] for column in columns))


def test_a_snapshot_stays_as_it_was(rng: np.random.Generator) -> None:
    recording, stream = recorded(rng, 300), Stream(DcmFilter())
    feed(stream, recording, 0, 200)
    shown = stream.snapshot()
    copy = [np.copy(x) for x in shown]
    feed(stream, recording, 200, 300)
    assert same(shown, copy)
    with pytest.raises(ValueError, match="read-only"):
        shown.R_NS[0, 0] = 0.0


def test_acceleration_is_what_gravity_does_not_explain(rng: np.random.Generator) -> None:
    a_N = rng.normal(size=3)
    R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    R *= np.linalg.det(R)
    stream = Stream(DcmFilter(mode="gyro"), R_NS=R)
    stream.update([0.0, 0.0, 0.0], R.T @ (a_N + np.array([0.0, 0.0, GRAVITY])), dt=0.01)
    # Two products of three numbers up to 12, rounded.
    np.testing.assert_allclose(stream.a_N, a_N, atol=1e-14)
    stream.update([0.0, 0.0, 0.0], [np.nan] * 3, dt=0.01)
    assert np.isnan(stream.a_N).all()


def test_other_files_are_refused(rng: np.random.Generator, tmp_path: Path) -> None:
    path = tmp_path / "x.npz"
    kreisel.write(path, recorded(rng, 10))
    with pytest.raises(ValueError, match=r"not a stream .* it holds ImuRecording"):
        Stream.load(path)
    path.write_text("t,gyro_x\n")
    with pytest.raises(ValueError, match="no whole NPZ archive"):
        Stream.load(path)
    with pytest.raises(FileNotFoundError):
        Stream.load(tmp_path / "none.npz")
    Stream(DcmFilter()).save(path)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match="no whole NPZ archive"):
        Stream.load(path)
    path.write_bytes(whole)
    with pytest.raises(ValueError, match="Stream"):
        kreisel.read(path)


@pytest.mark.parametrize(
    ("member", "value", "message"),
    [
        ("kreisel_schema", "Stream 9: state", "reads up to 1"),
        ("filter", "../dcm", "unknown filters plug-in"),
        ("tuning", '{"accel_tim": 1.0}', "has no 'accel_tim' in this version, but 'accel_time'"),
        ("tuning", '{"accel_time": -1.0}', "must not be negative"),
        ("state_version", 99, "does not have"),
        ("state", np.zeros(3), "does not have"),
        ("state", np.zeros(434, np.float32), "does not have"),
    ],
)
def test_altered_files_are_refused(member: str, value: object, message: str, tmp_path: Path) -> None:
    path = tmp_path / "x.npz"
    Stream(DcmFilter()).save(path)
    with np.load(path) as archive:
        arrays = dict(archive)
    np.savez(path, **(arrays | {member: np.array(value)}))
    with pytest.raises(ValueError, match=message) as refused:
        Stream.load(path)
    assert str(path) in str(refused.value)


def test_a_filter_of_ones_own_cannot_be_saved(tmp_path: Path) -> None:
    class Mine(DcmFilter):
        pass

    with pytest.raises(ValueError, match=r"only filters in .* got Mine"):
        Stream(Mine()).save(tmp_path / "x.npz")
    assert list(tmp_path.iterdir()) == []


def test_tuning_within_tuning_comes_back(tmp_path: Path) -> None:
    filter = DcmFilter(published=PublishedStep(1.0, 0.1, 1.0 / 3.0, exact=True), declination=0.1)
    Stream(filter).save(tmp_path / "x.npz")
    assert Stream.load(tmp_path / "x.npz").filter == filter
