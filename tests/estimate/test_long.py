"""A recording in blocks: the bits of the whole, whatever the blocks."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
import pytest

import kreisel
from kreisel.estimate.filters import AttitudeFilter
from kreisel.estimate.filters.dcm import DcmFilter
from tests.estimate.test_run import FILTERS, recorded

FIELDS = ("t", "R_NS", "gyro_bias", "a_N", "sigma", "rest", "disturbed", "held")


def pieces(recording: kreisel.ImuRecording, cuts: Sequence[int]) -> Iterator[kreisel.ImuRecording]:
    edges = [0, *sorted(cuts), len(recording)]
    for first, last in pairwise(edges):
        yield recording.rows(slice(first, last))


def assert_same(blocks: Sequence[kreisel.AttitudeHistory], whole: kreisel.AttitudeHistory) -> None:
    for name in FIELDS:
        if getattr(whole, name) is not None:
            joined = np.concatenate([getattr(block, name) for block in blocks])
            np.testing.assert_array_equal(joined, getattr(whole, name), err_msg=name)
    assert {block.t0_ns for block in blocks} == {whole.t0_ns}


@pytest.mark.parametrize("filter", FILTERS)
def test_blocks_have_the_bits_of_the_whole(filter: AttitudeFilter, rng: np.random.Generator) -> None:
    recording = recorded(rng, 900)
    whole = kreisel.run(filter, recording)
    for count in (1, 5, 60):
        cuts = rng.integers(0, len(recording) + 1, count).tolist()  # some blocks are empty, some one sample
        blocks = list(kreisel.run_long(filter, pieces(recording, cuts)))
        assert_same(blocks, whole)


@pytest.mark.parametrize("filter", FILTERS)
def test_a_start_that_waits_for_its_samples(filter: AttitudeFilter, rng: np.random.Generator) -> None:
    """The first samples are missing, some sensor by sensor: nothing counts twice where blocks meet."""
    whole = recorded(rng, 200)
    gyro, accel, mag = (np.array(x) for x in (whole.gyro, whole.accel, whole.mag_uT))
    gyro[:7], accel[:13], mag[:31] = np.nan, np.nan, np.nan
    recording = kreisel.ImuRecording(whole.t, gyro, accel, mag, t0_ns=17)
    expected = kreisel.run(filter, recording)
    assert_same(list(kreisel.run_long(filter, pieces(recording, range(1, 60)))), expected)


def test_a_given_start_and_no_magnetometer(rng: np.random.Generator) -> None:
    recording = recorded(rng, 300)
    without = kreisel.ImuRecording(recording.t, recording.gyro, recording.accel)
    R = kreisel.run(DcmFilter(), recording).R_NS[50]
    expected = kreisel.run(DcmFilter(), without, R)
    assert_same(list(kreisel.run_long(DcmFilter(), pieces(without, [100, 200]), R)), expected)


def test_a_block_is_answered_before_the_next_is_asked_for(rng: np.random.Generator) -> None:
    recording, asked = recorded(rng, 100), []

    def blocks() -> Iterator[kreisel.ImuRecording]:
        for k in range(4):
            asked.append(k)
            yield recording.rows(slice(25 * k, 25 * k + 25))

    answers = kreisel.run_long(DcmFilter(), blocks())
    assert asked == []
    next(answers)
    assert asked == [0]


def test_blocks_that_do_not_follow_are_refused(rng: np.random.Generator) -> None:
    recording = recorded(rng, 100)
    first, second = pieces(recording, [50])
    with pytest.raises(ValueError, match="must follow each other in time"):
        list(kreisel.run_long(DcmFilter(), [second, first]))
    with pytest.raises(ValueError, match="same t0_ns; got 9 after 0"):
        later = kreisel.ImuRecording(second.t, second.gyro, second.accel, second.mag_uT, t0_ns=9)
        list(kreisel.run_long(DcmFilter(), [first, later]))
    with pytest.raises(ValueError, match="needs a magnetometer"):
        without = kreisel.ImuRecording(first.t, first.gyro, first.accel)
        list(kreisel.run_long(DcmFilter(mode="9"), [without]))
