"""Turns a seed, a run, a sensor and the name of an effect into random numbers addressed by sample and channel.

Counter-based: a number is a function of its address alone, so any block has the same bits as the whole,
whatever was drawn before it, on any number of threads. Nothing here calls a mathematical library but for the
square root, which IEEE 754 defines to the last bit: the numbers are the same on every machine.
"""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import blake2b

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import kernel
from kreisel.maths.sincos import sincos

Array = npt.NDArray[np.float64]
Words = npt.NDArray[np.uint64]

# Philox4x32: the two multipliers and the two steps of the key. Source: Salmon, Moraes, Dror and Shaw 2011,
# "Parallel random numbers: as easy as 1, 2, 3", section 3.3 and the Random123 library.
MULTIPLIER_0, MULTIPLIER_1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
KEY_STEP_0, KEY_STEP_1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)

LOW_WORD, WORD = np.uint64(0xFFFFFFFF), np.uint64(32)
ONE, TWO = np.uint64(1), np.uint64(2)

# 53 random bits are 32 of one word and the upper 21 of the next.
UPPER_SHIFT, LOWER_SHIFT, SPACING = np.uint64(21), np.uint64(11), 2.0**-53

MANTISSA, EXPONENT_OF_ONE, EXPONENT_SHIFT = np.uint64(2**52 - 1), np.uint64(1023 << 52), np.uint64(52)
LN2_HIGH, LN2_LOW = float.fromhex("0x1.62e42fee00000p-1"), 1.9082149292705877e-10
SQRT2, TWO_PI = 1.4142135623730951, 6.283185307179586

PAIRS = 512
"""Pairs of numbers made at a time: the scratch of one chunk fits the first-level cache."""

UNIFORM_CHANNELS = 1 << 31
"""Uniforms are dealt from channels above this one, so that they share no bits with the normals of a stream."""

LARGEST_NORMAL = 8.571674348652905
"""sqrt(2 * 53 ln 2): with 53 bits no normal is larger; beyond it lie 1e-17 of the distribution."""


@dataclass(frozen=True, slots=True)
class Stream:
    """Random numbers of one effect of one sensor in one run; see `stream` for how it gets its key."""

    key_0: int  # 32 bits
    key_1: int  # 32 bits
    high: int  # 32 bits, highest word of every counter

    def normals(self, first: int, count: int, channels: int = 3, channel: int = 0) -> Array:
        """Standard normal numbers (count, channels) of samples first, first + 1, ... from `channel` on.

        Box-Muller on 53-bit uniforms: samples 2 k and 2 k + 1 of a channel are made from one Philox block.
        No number exceeds 8.57.
        """
        out = np.empty((count, channels))
        _normals(self._words(first), channel, out)
        return out

    def uniforms(self, first: int, count: int, channels: int = 3, channel: int = 0) -> Array:
        """Uniform numbers (count, channels) in [0, 1), multiples of 2^-53, independent of the normals."""
        out = np.empty((count, channels))
        _uniforms(self._words(first), UNIFORM_CHANNELS + channel, out)
        return out

    def _words(self, first: int) -> Words:
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
def philox(c0: Words, c1: Words, c2: Words, c3: Words, k0: int, k1: int) -> None:
    """Philox4x32-10 in place: counters (n,) become random words; all are uint64 below 2^32, as is the key."""
    for _ in range(5):
        _two_rounds(c0, c1, c2, c3, k0, k1)
        k0, k1 = (k0 + TWO * KEY_STEP_0) & LOW_WORD, (k1 + TWO * KEY_STEP_1) & LOW_WORD


@kernel
def _two_rounds(c0: Words, c1: Words, c2: Words, c3: Words, k0: int, k1: int) -> None:
    # The masks tell the compiler that the products are of 32-bit words, for which there is a SIMD instruction.
    k2, k3 = (k0 + KEY_STEP_0) & LOW_WORD, (k1 + KEY_STEP_1) & LOW_WORD
    for k in range(c0.shape[0]):
        p, q = MULTIPLIER_0 * (c0[k] & LOW_WORD), MULTIPLIER_1 * (c2[k] & LOW_WORD)
        a, b = (q >> WORD) ^ c1[k] ^ k0, (p >> WORD) ^ c3[k] ^ k1
        r, s = MULTIPLIER_0 * (a & LOW_WORD), MULTIPLIER_1 * (b & LOW_WORD)
        c0[k], c1[k] = (s >> WORD) ^ (q & LOW_WORD) ^ k2, s & LOW_WORD
        c2[k], c3[k] = (r >> WORD) ^ (p & LOW_WORD) ^ k3, r & LOW_WORD


@kernel
def _integers(words: Words, pair: int, channel: int, a: Words, b: Words, c: Words, d: Words) -> None:
    """Fill a and b with 53-bit integers of the pairs `pair`, `pair` + 1, ... of one channel."""
    for k in range(a.shape[0]):
        index = pair + np.uint64(k)
        a[k], b[k], c[k], d[k] = index & LOW_WORD, index >> WORD, channel, words[2]
    philox(a, b, c, d, words[0], words[1])
    for k in range(a.shape[0]):
        a[k] = (a[k] << UPPER_SHIFT) | (b[k] >> LOWER_SHIFT)
        b[k] = (c[k] << UPPER_SHIFT) | (d[k] >> LOWER_SHIFT)


@kernel
def _radius(x: Words, scratch: Words, out: Array) -> None:
    """out = sqrt(-2 ln u) for u = (x + 1) 2^-53, which is in (0, 1]; the logarithm errs by 2 ulp at most.

    u = 2^e m with m in [sqrt(1/2), sqrt 2]; ln m = 2 artanh s, s = (m - 1) / (m + 1), by its series, whose
    first neglected term is below 1e-17 of the first.
    """
    u, m = out, scratch.view(np.float64)
    bits = u.view(np.uint64)
    for k in range(x.shape[0]):
        u[k] = np.float64(x[k] + ONE)
    for k in range(x.shape[0]):
        scratch[k] = (bits[k] & MANTISSA) | EXPONENT_OF_ONE
        x[k] = bits[k] >> EXPONENT_SHIFT
    for k in range(x.shape[0]):
        large = 1.0 if m[k] > SQRT2 else 0.0
        e = np.float64(x[k]) - 1076.0 + large
        f = m[k] * (1.0 - 0.5 * large)
        s = (f - 1.0) / (f + 1.0)
        z = s * s
        tail = 1 / 13 + z * (1 / 15 + z * (1 / 17 + z * (1 / 19 + z * (1 / 21))))
        series = z * (1 / 3 + z * (1 / 5 + z * (1 / 7 + z * (1 / 9 + z * (1 / 11 + z * tail)))))
        log = e * LN2_HIGH + (e * LN2_LOW + (2.0 * s + 2.0 * s * series))
        out[k] = np.sqrt(-2.0 * log)


@kernel
def _normals(words: Words, channel: int, out: Array) -> None:
    a, b = np.empty(PAIRS, np.uint64), np.empty(PAIRS, np.uint64)
    x, y = np.empty(PAIRS, np.uint64), np.empty(PAIRS, np.uint64)
    radius, angle, sine, cosine = np.empty(PAIRS), np.empty(PAIRS), np.empty(PAIRS), np.empty(PAIRS)
    first, count = words[3], np.int64(out.shape[0])
    skipped = np.int64(first % TWO)
    for c in range(out.shape[1]):
        for start in range(0, (count + skipped + 1) // 2, PAIRS):
            size = min(PAIRS, (count + skipped + 1) // 2 - start)
            pair, of = first // TWO + np.uint64(start), np.uint64(channel + c)
            _integers(words, pair, of, a[:size], b[:size], x[:size], y[:size])
            _radius(a[:size], x[:size], radius[:size])
            for k in range(size):
                angle[k] = np.float64(b[k]) * (TWO_PI * SPACING)
            sincos(angle[:size], sine[:size], cosine[:size])
            for k in range(size):
                cosine[k] *= radius[k]
                sine[k] *= radius[k]
            _deal(cosine[:size], sine[:size], 2 * start - skipped, c, out)


@kernel
def _uniforms(words: Words, channel: int, out: Array) -> None:
    a, b = np.empty(PAIRS, np.uint64), np.empty(PAIRS, np.uint64)
    x, y = np.empty(PAIRS, np.uint64), np.empty(PAIRS, np.uint64)
    even, odd = np.empty(PAIRS), np.empty(PAIRS)
    first, count = words[3], np.int64(out.shape[0])
    skipped = np.int64(first % TWO)
    for c in range(out.shape[1]):
        for start in range(0, (count + skipped + 1) // 2, PAIRS):
            size = min(PAIRS, (count + skipped + 1) // 2 - start)
            pair, of = first // TWO + np.uint64(start), np.uint64(channel + c)
            _integers(words, pair, of, a[:size], b[:size], x[:size], y[:size])
            for k in range(size):
                even[k], odd[k] = np.float64(a[k]) * SPACING, np.float64(b[k]) * SPACING
            _deal(even[:size], odd[:size], 2 * start - skipped, c, out)


@kernel
def _deal(even: Array, odd: Array, row: int, column: int, out: Array) -> None:
    """Write the pairs to rows `row`, `row` + 1, ... of one column, leaving out rows that do not exist."""
    inner = min(even.shape[0], (out.shape[0] - row) // 2)
    if row < 0:
        out[row + 1, column] = odd[0]
    for k in range(1 if row < 0 else 0, inner):
        out[row + 2 * k, column] = even[k]
        out[row + 2 * k + 1, column] = odd[k]
    if inner < even.shape[0] and row + 2 * inner >= 0:
        out[row + 2 * inner, column] = even[inner]
