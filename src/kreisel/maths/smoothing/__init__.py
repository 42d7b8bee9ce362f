"""Turns noisy samples into a spline with the noise taken out, and finds the noise level on the way.

A penalised B-spline (Eilers and Marx 1996): least squares plus a penalty on its fifth derivative, solved block by
block. The weight of the penalty, the noise level and the time over which the noise is correlated are those of greatest
restricted likelihood; what does not fit, single samples and lasting jumps, is recognised, set apart and named.
"""

from kreisel.maths.smoothing.blocks import lost_share as lost_share
from kreisel.maths.smoothing.spline import SmoothSignal as SmoothSignal
from kreisel.maths.smoothing.spline import smoothing_spline as smoothing_spline
