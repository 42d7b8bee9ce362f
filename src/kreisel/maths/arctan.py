"""Turns two coordinates into the angle between them, without a branch or a call, for loops over vectors.

A compiled loop calls libm once per angle (20 to 40 ns); of a loop over this function the compiler makes SIMD (2 ns).
"""

from __future__ import annotations

import math

from kreisel.maths.kernels import fused, inlined

# atan r = r + r^3 A(r^2) on [0, tan(pi/8)]; A interpolates at the Chebyshev nodes of [0, tan(pi/8)^2] and leaves 7e-18.
A0, A1, A2, A3 = -0.3333333333333333, 0.19999999999995516, -0.14285714284665682, 0.11111111015187018
A4, A5, A6, A7 = -0.0909090457530649, 0.07692183125376892, -0.06664510525508936, 0.05858140904866328
A8, A9, A10 = -0.050854078345894844, 0.03923044778479309, -0.019175404711104935

FOLD = math.sqrt(2.0) - 1.0
QUARTER, RIGHT, STRAIGHT = 0.25 * math.pi, 0.5 * math.pi, math.pi


@inlined
def arctan2(y: float, x: float) -> float:
    """Angle of (x, y) in [-pi, pi] rad to a unit or two of the last place; 0 where both are 0, NaN stays NaN."""
    high, wide = abs(y), abs(x)
    small, large = (wide, high) if high > wide else (high, wide)
    folded = small > FOLD * large
    p, q = (small - large, small + large) if folded else (small, large)
    # NaN + 1 is NaN still.
    r = p / (q if q != 0.0 else 1.0)
    z = r * r
    upper = fused(z, fused(z, fused(z, fused(z, fused(z, A10, A9), A8), A7), A6), A5)
    lower = fused(z, fused(z, fused(z, fused(z, fused(z, upper, A4), A3), A2), A1), A0)
    a = fused(r * z, lower, r)
    a = a + (QUARTER if folded else 0.0)
    a = RIGHT - a if high > wide else a
    a = STRAIGHT - a if x < 0.0 else a
    return -a if y < 0.0 else a
