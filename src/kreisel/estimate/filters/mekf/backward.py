"""Turns the log of a filter's windows into what all later windows add to each: its errors, and how far they are known.

The smoother of Bryson and Frazier: an adjoint vector and matrix go back through observations and windows, so that
no covariance is inverted. Source: Bierman 1973, "Fixed interval smoothing with discrete measurements",
International Journal of Control 18 (1), 65-75.
"""

from kreisel.estimate.filters.dcm.covariance import GRAVITY
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.covariance import known_to
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array

# Places of what is found about a window: errors of attitude before its correction, standard deviations, and
# all errors after its correction.
BEFORE = 0  # 3
SIGMA = 3  # 3
AFTER = 6  # at.ERRORS
FOUND = AFTER + at.ERRORS

ROW = -at.COVARIANCE  # from places of the state to places of a row of the log

# A variance that round-off has taken below zero is this part of what it was.
_ROUND_OFF = 1e-9


@kernel
def look_back(log: Array, adjoint: Array, found: Array) -> None:
    """Fill found (windows, FOUND) from log (windows, LOG); adjoint (n + 2, n) is scratch, n = at.ERRORS."""
    n = at.ERRORS
    whole, line, scratch = adjoint[:n], adjoint[n], adjoint[n + 1]
    _forget(adjoint)
    for w in range(log.shape[0] - 1, -1, -1):
        row = log[w]
        P = row[: n * n].reshape(n, n)
        for i in range(n):
            error = 0.0
            for a in range(n):
                error -= P[i, a] * line[a]
            found[w, AFTER + i] = error
        for i in range(3):
            found[w, BEFORE + i] = found[w, AFTER + i] + row[at.CORRECTION + ROW + i]
            found[w, SIGMA + i] = _sigma(P[i], i, whole, row[at.EXCESS + ROW])
        for k in range(int(row[at.OBSERVED + ROW]) - 1, -1, -1):
            place = at.OBSERVATIONS + ROW + k * at.OBSERVATION
            _before_observation(row[place : place + at.OBSERVATION], whole, line, scratch)
        if row[at.CHANGE_FORCE + ROW] == at.NOTHING:
            _forget(adjoint)
        else:
            _before_window(row[at.CHANGE + ROW : at.OBSERVED + ROW], whole, line)


@kernel
def _forget(adjoint: Array) -> None:
    for a in range(adjoint.shape[0]):
        for b in range(adjoint.shape[1]):
            adjoint[a, b] = 0.0


@kernel
def _sigma(row: Array, i: int, whole: Array, excess: float) -> float:
    """Standard deviation of error i, whose row of P is `row`, given all that comes later."""
    spent = 0.0
    for a in range(at.ERRORS):
        inner = 0.0
        for b in range(at.ERRORS):
            inner += whole[a, b] * row[b]
        spent += row[a] * inner
    return known_to(i, max(row[i] - spent, _ROUND_OFF * row[i]), excess)


@kernel
def _before_observation(seen: Array, whole: Array, line: Array, scratch: Array) -> None:
    """The adjoint before an observation from that after it; `seen` is row h, P h^T, surprise and variance."""
    n = at.ERRORS
    h, column = seen[:n], seen[n : 2 * n]
    weight = 1.0 / seen[2 * n + 1]
    along, total = seen[2 * n], 1.0
    for a in range(n):
        along += column[a] * line[a]
        q = 0.0
        for b in range(n):
            q += whole[a, b] * column[b]
        scratch[a] = q * weight
        total += scratch[a] * column[a]
    for a in range(n):
        if h[a] != 0.0:
            line[a] -= h[a] * along * weight
            for b in range(n):
                whole[a, b] -= h[a] * scratch[b]
                whole[b, a] -= h[a] * scratch[b]
            for b in range(n):
                whole[a, b] += h[a] * h[b] * total * weight


@kernel
def _before_window(change: Array, whole: Array, line: Array) -> None:
    """The adjoint before a window's F from that after it: F^T line and F^T whole F."""
    n = at.ERRORS
    _back(change, line)
    for a in range(n):
        _back(change, whole[a])
    for a in range(n):
        for b in range(a):
            whole[a, b], whole[b, a] = whole[b, a], whole[a, b]
    for a in range(n):
        _back(change, whole[a])


@kernel
def _back(change: Array, x: Array) -> None:
    """x <- F^T x, for the F that `propagate` has."""
    seconds = change[at.CHANGE_FORCE - at.CHANGE]
    length, kept = change[at.CHANGE_LENGTH - at.CHANGE], at.CHANGE_KEPT - at.CHANGE
    for i in range(2):
        x[at.V + i] += length * x[at.S + i]
    for k in range(at.CONSTANTS):
        for i in range(3):
            x[at.B + k] += change[at.CONSTANTS * i + k] * x[i]
    for k in range(3):
        for i in range(2):
            x[at.A + k] += seconds / length * change[at.CONSTANTS * i + k] * x[at.V + i]
    for i in range(2):
        x[at.L] += change[at.CHANGE_LAG - at.CHANGE + i] * x[at.V + i]
    x[1] += GRAVITY * seconds * x[at.V]
    x[0] -= GRAVITY * seconds * x[at.V + 1]
    for i in range(3):
        x[at.U + i] *= change[kept]
        for j in range(2):
            x[at.U + i] += change[at.CONSTANTS * j + i] * x[at.S + j]
    x[at.D] *= change[kept + 1]
    for j in range(2):
        x[at.S + j] *= change[kept + 2]
