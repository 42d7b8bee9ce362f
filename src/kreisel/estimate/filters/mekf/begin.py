"""Turns the tuning into the state of a filter that has seen nothing yet."""

from kreisel.estimate.filters.dcm.covariance import GRAVITY
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.repeated import FIRST_SHARE
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array

# m/s/sqrt(Hz): noise of the velocity before any was seen.
_FIRST_ROAMING = 0.84


@kernel
def begin(state: Array, params: Array) -> None:
    """Make one filter's state fresh: its attitude waits for the first samples."""
    for i in range(at.ONE):
        state[i] = 0.0
    for i in range(3):
        state[at.R_NS + 4 * i] = 1.0
        state[at.SIGMA + i] = params[at.FIRST_SIGMA + i]
    state[at.CALM] = state[at.FLAGS] = at.HELD
    for i in range(at.ERRORS):
        state[at.COVARIANCE + i * (at.ERRORS + 1)] = params[at.FIRST_SIGMA + i] ** 2
    state[at.SPREAD] = params[at.FIRST_SIGMA + at.D] ** 2
    state[at.MEAN_FORCE + 2] = GRAVITY
    state[at.MEAN_SQUARE] = GRAVITY**2
    state[at.EXCESS] = 1.0
    state[at.REPEATING] = state[at.REPEATING + 1] = FIRST_SHARE
    state[at.ROAMING] = state[at.WANDERING] = _FIRST_ROAMING**2
