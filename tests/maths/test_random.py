"""Counter-based random numbers: published vectors, an independent transcription, and their distribution."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from kreisel.maths.kernels import LANES, argument
from kreisel.maths.random import (
    LARGEST_NORMAL,
    Stream,
    normals_abreast,
    philox,
    seed_from,
    stream,
    words_abreast,
)

# Random123 1.14, tests/kat_vectors, lines "philox4x32 10": counter, key, result.
KNOWN = [
    ("00000000 00000000 00000000 00000000", "00000000 00000000", "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
    ("ffffffff ffffffff ffffffff ffffffff", "ffffffff ffffffff", "408f276d 41c83b0e a20bc7c6 6d5451fd"),
    ("243f6a88 85a308d3 13198a2e 03707344", "a4093822 299f31d0", "d16cfe09 94fdcceb 5001e420 24126ea1"),
]


def words(text: str) -> list[int]:
    return [int(word, 16) for word in text.split()]


def plain_philox(counter: list[int], key: list[int]) -> list[int]:
    """Philox4x32-10 with Python's integers."""
    (a, b, c, d), (k, l) = counter, key
    for _ in range(10):
        p, q = 0xD2511F53 * a, 0xCD9E8D57 * c
        a, b, c, d = (q >> 32) ^ b ^ k, q % 2**32, (p >> 32) ^ d ^ l, p % 2**32
        k, l = (k + 0x9E3779B9) % 2**32, (l + 0xBB67AE85) % 2**32
    return [a, b, c, d]


def plain_bits(s: Stream, block: int, channel: int) -> tuple[int, int]:
    counter = [block % 2**32, block >> 32, channel, s.high]
    w0, w1, w2, w3 = plain_philox(counter, [s.key_0, s.key_1])
    return (w0 << 32) | w1, (w2 << 32) | w3


def plain_uniforms(s: Stream, block: int, channel: int) -> tuple[int, int]:
    a, b = plain_bits(s, block, channel)
    return a >> 11, b >> 11


def plain_normals(s: Stream, block: int, channel: int) -> list[float]:
    numbers = []
    for bits in plain_bits(s, block, channel):
        radius = math.sqrt(-2.0 * math.log(((bits >> 24) + 1) / 2**40))
        # The upper two of 24 bits are the quadrant, the others an angle in it, at the middles of 2^22 steps.
        turn = (bits >> 22) % 4 + ((bits % 2**22) + 0.5) / 2**22 - 0.5
        numbers += [radius * math.cos(0.5 * math.pi * turn), radius * math.sin(0.5 * math.pi * turn)]
    return numbers


def any_stream(rng: np.random.Generator) -> Stream:
    return stream(int(rng.integers(2**63)), 0, "imu/gyro", "white_noise")


@pytest.mark.parametrize(("counter", "key", "result"), KNOWN)
def test_known_answers(counter: str, key: str, result: str) -> None:
    c0, c1, channel, high = words(counter)
    a, b = np.empty(1, dtype=np.uint64), np.empty(1, dtype=np.uint64)
    key_and_high = np.array([*words(key), high], dtype=np.uint64)
    philox(key_and_high, np.uint64(c0 | c1 << 32), np.uint64(channel), a, b)
    assert [x for y in (int(a[0]), int(b[0])) for x in (y >> 32, y % 2**32)] == words(result)
    assert plain_philox(words(counter), words(key)) == words(result)


@pytest.mark.parametrize("block", [0, 1, 255, 256, 2**32 - 1, 2**32 + 7, 2**50])
def test_normals_are_those_of_a_plain_transcription(block: int, rng: np.random.Generator) -> None:
    s = any_stream(rng)
    ours = s.normals(4 * block, 4, 4)
    theirs = np.array([plain_normals(s, block, channel) for channel in range(4)]).T
    # The series of the logarithm leaves 4e-14; sine and cosine err by units of the last place.
    np.testing.assert_allclose(ours, theirs, rtol=5e-14, atol=2e-15)


def test_radii_are_right_where_the_logarithm_is_near_zero_and_where_it_is_large(
    rng: np.random.Generator,
) -> None:
    s = any_stream(rng)
    ours = s.normals(0, 20_000, 1)[:, 0].reshape(-1, 2)
    bits = np.array([plain_bits(s, block, 0) for block in range(5_000)], dtype=np.uint64).ravel()
    u = ((bits >> np.uint64(24)) + np.uint64(1)) / 2.0**40
    # Relative, although -ln u is as small as 1e-4 here; the series of the logarithm leaves 4e-14.
    np.testing.assert_allclose(np.hypot(*ours.T), np.sqrt(-2.0 * np.log(u)), rtol=5e-14)


def test_uniforms_are_those_of_a_plain_transcription(rng: np.random.Generator) -> None:
    s = any_stream(rng)
    theirs = [x / 2**53 for pair in range(5) for x in plain_uniforms(s, pair, 2**31)]
    np.testing.assert_array_equal(s.uniforms(0, 10, 1)[:, 0], theirs)


@pytest.mark.parametrize(("first", "count"), [(0, 1), (1, 1), (1, 2), (2, 3), (1023, 2), (777, 2049), (0, 0)])
def test_any_block_is_a_part_of_the_whole(first: int, count: int, rng: np.random.Generator) -> None:
    s = any_stream(rng)
    rows = slice(first, first + count)
    np.testing.assert_array_equal(s.normals(first, count), s.normals(0, 3000)[rows])
    np.testing.assert_array_equal(s.uniforms(first, count), s.uniforms(0, 3000)[rows])


@pytest.mark.parametrize(
    ("first", "count"), [(0, 1), (0, 64), (3, 2), (5, 300), (1022, 513), (2**34 - 7, 70)]
)
def test_streams_abreast_are_each_its_own_to_the_bit(
    first: int, count: int, rng: np.random.Generator
) -> None:
    streams = [any_stream(rng) for _ in range(LANES)]
    words, room = words_abreast(streams), np.full((count + 2, 5, LANES), np.nan)
    out = room[1:-1]
    words[3] = first
    shared, by = rng.normal(size=(2, count, 3))
    normals_abreast(words, 0, argument(shared), argument(by), 1, out)
    for lane, each in enumerate(streams):
        np.testing.assert_array_equal(out[:, 1:4, lane], shared + by * each.normals(first, count))
    # Nobody checks where these kernels write.
    assert np.isnan(out[:, [0, 4]]).all() and np.isnan(room[[0, -1]]).all()


def test_a_channel_does_not_depend_on_how_many_there_are(rng: np.random.Generator) -> None:
    s = any_stream(rng)
    np.testing.assert_array_equal(s.normals(5, 100, 2, channel=4), s.normals(5, 100, 9)[:, 4:6])


def test_normals_are_normal(rng: np.random.Generator) -> None:
    x = any_stream(rng).normals(0, 500_000, 2).reshape(-1)
    n = len(x)
    # Moments within five standard deviations of theirs: 1, 2, 15 and 96 over n in variance.
    deviations = [x.mean(), (x**2).mean() - 1.0, (x**3).mean(), (x**4).mean() - 3.0]
    for deviation, variance in zip(deviations, [1.0, 2.0, 15.0, 96.0], strict=True):
        assert abs(deviation) < 5.0 * math.sqrt(variance / n)
    assert stats.kstest(x, "norm").pvalue > 1e-6


@pytest.mark.parametrize("beyond", [2.0, 3.0, 4.0])
def test_tails_hold_as_much_as_they_should(beyond: float, rng: np.random.Generator) -> None:
    x = any_stream(rng).normals(0, 2_000_000, 1)
    for tail in (x > beyond, x < -beyond):
        expected = len(x) * stats.norm.sf(beyond)
        assert abs(tail.sum() - expected) < 5.0 * math.sqrt(expected) + 1.0


def test_the_largest_normal_is_that_of_the_smallest_uniform() -> None:
    assert math.isclose(LARGEST_NORMAL, math.sqrt(-2.0 * math.log(2.0**-40)), rel_tol=1e-15)


def test_uniforms_are_even(rng: np.random.Generator) -> None:
    x = any_stream(rng).uniforms(0, 300_000).reshape(-1)
    assert x.min() >= 0.0 and x.max() < 1.0
    assert stats.kstest(x, "uniform").pvalue > 1e-6


def test_streams_neighbours_and_channels_are_independent(rng: np.random.Generator) -> None:
    seed, n = int(rng.integers(2**62)), 100_000
    keys = [(seed, 0, "a/gyro", "noise"), (seed + 1, 0, "a/gyro", "noise"), (seed, 1, "a/gyro", "noise")]
    keys += [(seed, 0, "a/accel", "noise"), (seed, 0, "a/gyro", "walk")]
    columns = [stream(*key).normals(0, n) for key in keys]
    # The next three rows share a Philox block, and the next one a radius.
    later = [columns[0][k : n - 3 + k] for k in (1, 2, 3)]
    x = np.concatenate([column[: n - 3] for column in columns] + later, axis=1)
    x = np.concatenate([x, stats.norm.ppf(stream(*keys[0]).uniforms(0, n - 3))], axis=1)
    # 27 columns: 351 correlations, each of deviation 1/sqrt(n).
    for moment in (x, x**2 - 1.0):
        correlation = np.corrcoef(moment.T)[np.triu_indices(moment.shape[1], 1)]
        assert len(correlation) == 351
        assert np.abs(correlation).max() < 5.5 / math.sqrt(n)


def test_names_do_not_run_into_each_other() -> None:
    assert stream(1, 0, "ab", "c") != stream(1, 0, "a", "bc")
    assert stream(1, 23, "a", "b") != stream(12, 3, "a", "b")


def test_a_stream_is_the_same_for_ever() -> None:
    """A release that changes these numbers changes everybody's recordings: say so in the changelog."""
    x = stream(7, 0, "imu/gyro", "white_noise").normals(0, 2)
    np.testing.assert_allclose(x, FROZEN, rtol=1e-15)


FROZEN = np.array(
    [
        [-1.1043879180317016, -0.025274313907186832, 0.04191024562480618],
        [-0.6218755541406489, 0.5071322757791595, -0.09516722085111955],
    ]
)


def test_a_seed_is_a_number_or_a_draw(rng: np.random.Generator) -> None:
    assert seed_from(5) == seed_from(np.int64(5)) == 5
    assert seed_from(np.random.default_rng(3)) == seed_from(np.random.default_rng(3))
    assert seed_from(rng) != seed_from(rng)
    for wrong in (-1, 1.5, "7", None):
        with pytest.raises(TypeError, match=r"rng must be a seed, 0 or more, or a numpy\.random\.Generator"):
            seed_from(wrong)  # type: ignore[arg-type]
