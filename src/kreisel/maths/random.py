"""Turns a seed, a run, a sensor and the name of an effect into random numbers addressed by sample and channel.

Counter-based: a number is a function of its address alone, so any block has the same bits as the whole,
whatever was drawn before it, on any number of threads. Nothing here calls a mathematical library but for the
square root, which IEEE 754 defines to the last bit: the numbers are the same on every machine.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import blake2b

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import LANES, fused, inlined, kernel, put_in_lanes, wide_vectors
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
SIGN, ANGLE = np.uint64(1 << 63), np.uint64(2**22 - 1)
ODD, ODD_TO_SIGN, HALF_TO_SIGN = np.uint64(1 << 22), np.uint64(41), np.uint64(40)
# The angles of a quadrant lie half a step off its middle on either side: no direction is favoured.
HALF_ANGLE, ANGLE_STEP = 2.0**21 - 0.5, math.pi * 2.0**-23

MANTISSA, EXPONENT_OF_ONE, EXPONENT_SHIFT = np.uint64(2**52 - 1), np.uint64(1023 << 52), np.uint64(52)
LN2, SQRT2 = 0.6931471805599453, 1.4142135623730951

# ln(1 + f) = f L(f) on [sqrt(1/2) - 1, sqrt 2 - 1]; L interpolates at the Chebyshev nodes and leaves 1.5e-14.
L0, L1, L2 = 0.9999999999999978, -0.5000000000005124, 0.3333333333366278
L3, L4, L5 = -0.24999999980097665, 0.19999999913523026, -0.16666668870064102
L6, L7, L8 = 0.14285723158995764, -0.12499895335731784, 0.11110667407062838
L9, L10, L11 = -0.1000239910190662, 0.091026777139586, -0.0830874085245487
L12, L13, L14 = 0.07525682174652285, -0.07175470440668202, 0.07808645964311096
L15, L16 = -0.07434589714878563, 0.03550255209682033

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


def words_abreast(streams: Sequence[Stream]) -> Words:
    """`Stream.words` of several streams side by side (4, streams), at their first samples."""
    return np.stack([each.words(0) for each in streams], axis=1)


def seed_from(rng: int | np.random.Generator) -> int:
    """`rng` itself when it is a seed, or one draw from it when it is a generator."""
    if isinstance(rng, np.random.Generator):
        return int(rng.integers(2**63))
    if isinstance(rng, int | np.integer) and rng >= 0:
        return int(rng)
    raise TypeError(f"rng must be a seed, 0 or more, or a numpy.random.Generator; got {rng!r}.")


@inlined
def _rounds(
    pair: np.uint64, channel: np.uint64, high: np.uint64, key_0: np.uint64, key_1: np.uint64
) -> tuple[np.uint64, np.uint64]:
    """Philox4x32-10 of the counter (pair, channel, high), as two 64-bit integers."""
    w0, w1, w2, w3 = pair, pair >> WORD, channel, high
    x, y = key_0, key_1
    for _ in range(10):
        # Upper halves are left to fill with rubbish: the SIMD product of 32-bit factors does not look at them.
        p, q = MULTIPLIER_0 * (w0 & LOW_WORD), MULTIPLIER_1 * (w2 & LOW_WORD)
        w0, w1, w2, w3 = (q >> WORD) ^ w1 ^ x, q, (p >> WORD) ^ w3 ^ y, p
        x, y = x + KEY_STEP_0, y + KEY_STEP_1
    return (w0 << WORD) | (w1 & LOW_WORD), (w2 << WORD) | (w3 & LOW_WORD)


@kernel
def philox(words: Words, pair: np.uint64, channel: np.uint64, a: Words, b: Words) -> None:
    """Philox4x32-10: two 64-bit integers a[k], b[k] for each counter (pair + k, channel, words[2]).

    words: key, key and highest word of the counter; its two lowest words are pair + k. All are uint64.
    """
    wide_vectors()
    k0, k1, high = words[0], words[1], words[2]
    for k in range(a.shape[0]):
        a[k], b[k] = _rounds(pair + np.uint64(k), channel, high, k0, k1)


@kernel
def _philox_abreast(words: Words, pair: np.uint64, channel: np.uint64, a: Words, b: Words) -> None:
    """`philox` of LANES streams, their words (4, n) repeated and the counters in their last row: LANES of each."""
    wide_vectors()
    k0, k1, high, pairs = words[0], words[1], words[2], words[3]
    for k in range(a.shape[0]):
        a[k], b[k] = _rounds(pair + pairs[k], channel, high[k], k0[k], k1[k])


@kernel
def _pairs(x: Words, scratch: Words, radius: Array, cosine: Array, sine: Array) -> None:
    """The two normals of each integer: a radius from its upper 40 bits, an angle from its lower 24.

    The radius is sqrt(-2 ln u) for u = (x + 1) 2^-40 in (0, 1]: u = 2^e m with m = 1 + f in [sqrt(1/2), sqrt 2], and
    ln m = f times the series L. Of the angle the upper two bits are the quadrant and need no arithmetic; the others
    are an angle in (-pi/4, pi/4).
    """
    wide_vectors()
    m, bits = scratch.view(np.float64), radius.view(np.uint64)
    for k in range(x.shape[0]):
        radius[k] = np.float64((x[k] >> RADIUS_SHIFT) + ONE)
    for k in range(x.shape[0]):
        scratch[k] = (bits[k] & MANTISSA) | EXPONENT_OF_ONE
    for k in range(x.shape[0]):
        large = 1.0 if m[k] > SQRT2 else 0.0
        e = np.float64(bits[k] >> EXPONENT_SHIFT) - 1063.0 + large
        log = fused(e, LN2, _log_of(fused(m[k], -0.5 * large, m[k]) - 1.0))
        r = np.sqrt(-2.0 * log)
        angle = fused(np.float64(x[k] & ANGLE), ANGLE_STEP, -HALF_ANGLE * ANGLE_STEP)
        c, s = _cosine_and_sine(angle)
        c, s = r * c, r * s
        cosine[k], sine[k] = (c, s) if x[k] & ODD == ZERO else (s, c)
    cosine_bits, sine_bits = cosine.view(np.uint64), sine.view(np.uint64)
    for k in range(x.shape[0]):
        half = (x[k] << HALF_TO_SIGN) & SIGN
        cosine_bits[k] ^= half ^ ((x[k] << ODD_TO_SIGN) & SIGN)
        sine_bits[k] ^= half


@inlined
def _log_of(f: float) -> float:
    """ln(1 + f) for f in [sqrt(1/2) - 1, sqrt 2 - 1], to 2e-14 of itself."""
    tail = fused(f, fused(f, fused(f, fused(f, L16, L15), L14), L13), L12)
    tail = fused(f, fused(f, fused(f, fused(f, tail, L11), L10), L9), L8)
    tail = fused(f, fused(f, fused(f, fused(f, tail, L7), L6), L5), L4)
    return f * fused(f, fused(f, fused(f, fused(f, tail, L3), L2), L1), L0)


@inlined
def _cosine_and_sine(r: float) -> tuple[float, float]:
    """Of an angle r in [-pi/4, pi/4], by the polynomials of `sincos`."""
    z = r * r
    s = fused(z, fused(z, fused(z, fused(z, fused(z, S5, S4), S3), S2), S1), S0)
    c = fused(z, fused(z, fused(z, fused(z, fused(z, C5, C4), C3), C2), C1), C0)
    return fused(z, fused(z, c, -0.5), 1.0), fused(r * z, s, r)


@kernel
def fill_normals(words: Words, channel: int, out: Array) -> None:
    """`Stream.normals` by its `words`, into `out` (count, channels)."""
    wide_vectors()
    x, scratch, radius = np.empty(2 * CHUNK, np.uint64), np.empty(2 * CHUNK, np.uint64), np.empty(2 * CHUNK)
    cosine, sine = np.empty(2 * CHUNK), np.empty(2 * CHUNK)
    quad, skipped = words[3] // FOUR, np.int64(words[3] % FOUR)
    quads = (out.shape[0] + skipped + 3) // 4
    for start in range(0, quads, CHUNK):
        n = min(CHUNK, quads - start)
        for c in range(out.shape[1]):
            philox(words, quad + np.uint64(start), np.uint64(channel + c), x[:n], x[n : 2 * n])
            _pairs(x[: 2 * n], scratch[: 2 * n], radius[: 2 * n], cosine[: 2 * n], sine[: 2 * n])
            _deal(cosine[:n], sine[:n], 4 * start - skipped, 4, out[:, c])
            _deal(cosine[n : 2 * n], sine[n : 2 * n], 4 * start - skipped + 2, 4, out[:, c])


@kernel
def normals_abreast(words: Words, channel: int, shared: Array, by: Array, row: int, out: Array) -> None:
    """shared + by times the normals of LANES streams, into rows from `row` on of `out` (n, rows, LANES).

    words : (4, LANES), the `words` of each stream, all with the same first sample; the numbers are those of `normals`.
    shared, by : (n, channels).
    """
    wide_vectors()
    x, scratch, radius = np.empty(2 * CHUNK, np.uint64), np.empty(2 * CHUNK, np.uint64), np.empty(2 * CHUNK)
    normals, together = np.empty(4 * CHUNK), CHUNK // LANES
    flat, rows, n = out.reshape(-1), out.shape[1], out.shape[0]
    spread = np.empty((4, CHUNK), np.uint64)
    for k in range(CHUNK):
        for i in range(3):
            spread[i, k] = words[i, k % LANES]
        spread[3, k] = np.uint64(k // LANES)
    quad, skipped = words[3, 0] // FOUR, int(words[3, 0] % FOUR)
    for start in range(0, (n + skipped + 3) // 4, together):
        first = 4 * start - skipped
        for c in range(by.shape[1]):
            _philox_abreast(spread, quad + np.uint64(start), np.uint64(channel + c), x[:CHUNK], x[CHUNK:])
            _pairs(x, scratch, radius, normals[: 2 * CHUNK], normals[2 * CHUNK :])
            for i in range(max(first, 0), min(first + 4 * together, n)):
                q, number = (i - first) // 4, (i - first) % 4
                source = q * LANES + number // 2 * CHUNK + number % 2 * 2 * CHUNK
                put_in_lanes(flat, (i * rows + row + c) * LANES, shared[i, c], by[i, c], normals, source)


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
