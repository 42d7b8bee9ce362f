"""Turns a seed, a run, a sensor and the name of an effect into random numbers addressed by sample and channel.

Counter-based: a number is a function of its address alone, so any block has the same bits as the whole,
whatever was drawn before it, on any number of threads. Nothing here calls a mathematical library but for the
square root, which IEEE 754 defines to the last bit: the numbers are the same on every machine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from hashlib import blake2b

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import kernel, wide_vectors
from kreisel.maths.sincos import C0, C1, C2, C3, C4, C5, S0, S1, S2, S3, S4, S5

Array = npt.NDArray[np.float64]
Words = npt.NDArray[np.uint64]

# Philox4x32: the two multipliers and the two steps of the key. Source: Salmon, Moraes, Dror and Shaw 2011,
# "Parallel random numbers: as easy as 1, 2, 3", section 3.3 and the Random123 library.
MULTIPLIER_0, MULTIPLIER_1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
KEY_STEP_0, KEY_STEP_1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)

LOW_WORD, WORD = np.uint64(0xFFFFFFFF), np.uint64(32)
ZERO, ONE, TWO, FOUR = np.uint64(0), np.uint64(1), np.uint64(2), np.uint64(4)

SPARE, SPACING = np.uint64(11), 2.0**-53
"""Of the 64 random bits of a uniform the lowest 11 are spared: 53 fit a float64."""

# 64 random bits make two normals: the upper 40 a radius, the lower 24 an angle, whose uppermost two are its quadrant.
# Half as many bits per normal as a float64 has take a third off the time, and leave a lattice of 2^64 points.
RADIUS_SHIFT = np.uint64(24)
SIGN, HALF, QUADRANT, ANGLE = np.uint64(63), np.uint64(23), np.uint64(22), np.uint64(2**22 - 1)
# The angles of a quadrant lie half a step off its middle on either side: no direction is favoured.
HALF_ANGLE, ANGLE_STEP = 2.0**21 - 0.5, math.pi * 2.0**-23

MANTISSA, EXPONENT_OF_ONE, EXPONENT_SHIFT = np.uint64(2**52 - 1), np.uint64(1023 << 52), np.uint64(52)
LN2_HIGH, LN2_LOW = float.fromhex("0x1.62e42fee00000p-1"), 1.9082149292705877e-10
SQRT2 = 1.4142135623730951

CHUNK = 256
"""Philox blocks worked on at a time: the scratch of one chunk fits the first-level cache."""

UNIFORM_CHANNELS = 1 << 31
"""Uniforms are dealt from channels above this one, so that they share no bits with the normals of a stream."""

LARGEST_NORMAL = 7.446594822118068
"""sqrt(2 * 40 ln 2): with 40 bits no normal is larger; beyond it lie 1e-13 of the distribution."""


@dataclass(frozen=True, slots=True)
class Stream:
    """Random numbers of one effect of one sensor in one run; see `stream` for how it gets its key."""

    key_0: int  # 32 bits
    key_1: int  # 32 bits
    high: int  # 32 bits, highest word of every counter

    def normals(self, first: int, count: int, channels: int = 3, channel: int = 0) -> Array:
        """Standard normal numbers (count, channels) of samples first, first + 1, ... from `channel` on.

        Box-Muller: samples 4 k to 4 k + 3 of a channel are made from one Philox block. No number exceeds 7.45.
        """
        out = np.empty((count, channels))
        fill_normals(self.words(first), channel, out)
        return out

    def uniforms(self, first: int, count: int, channels: int = 3, channel: int = 0) -> Array:
        """Uniform numbers (count, channels) in [0, 1), multiples of 2^-53, independent of the normals."""
        out = np.empty((count, channels))
        _uniforms(self.words(first), UNIFORM_CHANNELS + channel, out)
        return out

    def words(self, first: int) -> Words:
        """Key, key, highest word of every counter and number of the first sample, as kernels take them."""
        return np.array([self.key_0, self.key_1, self.high, first], dtype=np.uint64)


def stream(seed: int, run: int, sensor: str, effect: str) -> Stream:
    """The stream of `effect` on `sensor` in run number `run` of `seed`.

    96 bits of BLAKE2b of the four: among 1e9 streams two are equal with probability 1e-11.
    """
    digest = blake2b(repr((int(seed), int(run), sensor, effect)).encode(), digest_size=12).digest()
    words = [int.from_bytes(digest[k : k + 4], "little") for k in (0, 4, 8)]
    return Stream(*words)


def seed_from(rng: int | np.random.Generator) -> int:
    """`rng` itself when it is a seed, or one draw from it when it is a generator."""
    if isinstance(rng, np.random.Generator):
        return int(rng.integers(2**63))
    if isinstance(rng, int | np.integer) and rng >= 0:
        return int(rng)
    raise TypeError(f"rng must be a seed, 0 or more, or a numpy.random.Generator; got {rng!r}.")


@kernel
def philox(words: Words, pair: np.uint64, channel: np.uint64, a: Words, b: Words) -> None:
    """Philox4x32-10: two 64-bit integers a[k], b[k] for each counter (pair + k, channel, words[2]).

    words: key, key and highest word of the counter; its two lowest words are pair + k. All are uint64.
    """
    wide_vectors()
    k0, k1, high = words[0] & LOW_WORD, words[1] & LOW_WORD, words[2]
    for k in range(a.shape[0]):
        index = pair + np.uint64(k)
        w0, w1, w2, w3 = index, index >> WORD, channel, high
        x, y = k0, k1
        for _ in range(10):
            # Upper halves are left to fill with rubbish: the SIMD product of 32-bit factors does not look at them.
            p, q = MULTIPLIER_0 * (w0 & LOW_WORD), MULTIPLIER_1 * (w2 & LOW_WORD)
            w0, w1, w2, w3 = (q >> WORD) ^ w1 ^ x, q, (p >> WORD) ^ w3 ^ y, p
            x, y = (x + KEY_STEP_0) & LOW_WORD, (y + KEY_STEP_1) & LOW_WORD
        a[k], b[k] = (w0 << WORD) | (w1 & LOW_WORD), (w2 << WORD) | (w3 & LOW_WORD)


@kernel
def _radius(x: Words, exponent: Words, scratch: Words, out: Array) -> None:
    """out = sqrt(-2 ln u) for u = (x + 1) 2^-40 in (0, 1], x the upper 40 bits of each integer.

    u = 2^e m with m in [sqrt(1/2), sqrt 2]; ln m = 2 artanh s, s = (m - 1) / (m + 1), by its series, whose
    first neglected term is below 4e-14 of the first.
    """
    wide_vectors()
    m, bits = scratch.view(np.float64), out.view(np.uint64)
    for k in range(x.shape[0]):
        out[k] = np.float64((x[k] >> RADIUS_SHIFT) + ONE)
    for k in range(x.shape[0]):
        scratch[k] = (bits[k] & MANTISSA) | EXPONENT_OF_ONE
        exponent[k] = bits[k] >> EXPONENT_SHIFT
    for k in range(x.shape[0]):
        large = 1.0 if m[k] > SQRT2 else 0.0
        e = np.float64(exponent[k]) - 1063.0 + large
        f = m[k] * (1.0 - 0.5 * large)
        s = (f - 1.0) / (f + 1.0)
        z = s * s
        tail = 1 / 9 + z * (1 / 11 + z * (1 / 13 + z * (1 / 15)))
        series = z * (1 / 3 + z * (1 / 5 + z * (1 / 7 + z * tail)))
        log = e * LN2_HIGH + (e * LN2_LOW + (2.0 * s + 2.0 * s * series))
        out[k] = np.sqrt(-2.0 * log)


@kernel
def _turn(x: Words, radius: Array, cosine: Array, sine: Array) -> None:
    """Radius times cosine and sine of a uniform angle, from the lower 24 bits of each integer.

    The upper two of them are the quadrant and need no arithmetic; the others are an angle in (-pi/4, pi/4).
    """
    wide_vectors()
    cosine_bits, sine_bits = cosine.view(np.uint64), sine.view(np.uint64)
    for k in range(x.shape[0]):
        r = (np.float64(x[k] & ANGLE) - HALF_ANGLE) * ANGLE_STEP
        z = r * r
        s = radius[k] * (r + r * z * (S0 + z * (S1 + z * (S2 + z * (S3 + z * (S4 + z * S5))))))
        c = radius[k] * (1.0 + z * (-0.5 + z * (C0 + z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * C5)))))))
        odd = (x[k] >> QUADRANT) & ONE
        cosine[k], sine[k] = (c, s) if odd == ZERO else (s, c)
    for k in range(x.shape[0]):
        odd, half = (x[k] >> QUADRANT) & ONE, (x[k] >> HALF) & ONE
        cosine_bits[k] ^= (odd ^ half) << SIGN
        sine_bits[k] ^= half << SIGN


@kernel
def fill_normals(words: Words, channel: int, out: Array) -> None:
    """`Stream.normals` by its `words`, into `out` (count, channels)."""
    wide_vectors()
    x, exponent = np.empty(2 * CHUNK, np.uint64), np.empty(2 * CHUNK, np.uint64)
    scratch, radius = np.empty(2 * CHUNK, np.uint64), np.empty(2 * CHUNK)
    cosine, sine = np.empty(2 * CHUNK), np.empty(2 * CHUNK)
    quad, skipped = words[3] // FOUR, np.int64(words[3] % FOUR)
    quads = (out.shape[0] + skipped + 3) // 4
    for start in range(0, quads, CHUNK):
        n = min(CHUNK, quads - start)
        for c in range(out.shape[1]):
            philox(words, quad + np.uint64(start), np.uint64(channel + c), x[:n], x[n : 2 * n])
            _radius(x[: 2 * n], exponent[: 2 * n], scratch[: 2 * n], radius[: 2 * n])
            _turn(x[: 2 * n], radius[: 2 * n], cosine[: 2 * n], sine[: 2 * n])
            _deal(cosine[:n], sine[:n], 4 * start - skipped, 4, out[:, c])
            _deal(cosine[n : 2 * n], sine[n : 2 * n], 4 * start - skipped + 2, 4, out[:, c])


@kernel
def _uniforms(words: Words, channel: int, out: Array) -> None:
    a, b = np.empty(CHUNK, np.uint64), np.empty(CHUNK, np.uint64)
    even, odd = np.empty(CHUNK), np.empty(CHUNK)
    pair, skipped = words[3] // TWO, np.int64(words[3] % TWO)
    pairs = (out.shape[0] + skipped + 1) // 2
    for start in range(0, pairs, CHUNK):
        n = min(CHUNK, pairs - start)
        for c in range(out.shape[1]):
            philox(words, pair + np.uint64(start), np.uint64(channel + c), a[:n], b[:n])
            for k in range(n):
                even[k], odd[k] = np.float64(a[k] >> SPARE) * SPACING, np.float64(b[k] >> SPARE) * SPACING
            _deal(even[:n], odd[:n], 2 * start - skipped, 2, out[:, c])


@kernel
def _deal(even: Array, odd: Array, row: np.int64, step: int, out: Array) -> None:
    """Write pairs of numbers to rows `row` and `row` + 1, `step` rows further on, ..., those that exist."""
    n = even.shape[0]
    first, last = (1 if row < 0 else 0), max(min(n, (out.shape[0] - row + step - 2) // step), 0)
    for k in range(first, last):
        out[row + step * k], out[row + step * k + 1] = even[k], odd[k]
    for k, at in ((0, row), (last, row + step * last)):
        if k < n and 0 <= at < out.shape[0]:
            out[at] = even[k]
        if k < n and 0 <= at + 1 < out.shape[0]:
            out[at + 1] = odd[k]
