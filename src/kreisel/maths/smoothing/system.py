"""Turns noisy samples of one stretch into the spline that a given smoothness asks for, and says how likely that is."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.linalg import cho_solve_banded, cholesky_banded

from kreisel.maths.smoothing.bands import (
    DEGREE,
    ORDER,
    Rows,
    basis_rows,
    correlated,
    gram,
    penalty_rows,
    product,
    quadratic_forms,
    transposed,
    whitened,
    whitened_rows,
)

Array = npt.NDArray[np.float64]


TYPICAL_LENGTHS = {1: (0.67449, 1.64485), 2: (1.17741, 2.14597), 3: (1.53817, 2.50028), 4: (1.83213, 2.78925)}
"""Lengths below which half, and nine in ten, of the vectors of so many normal variables of variance 1 are."""


class Samples(NamedTuple):
    """Columns that share their smoothness and, in every one of its dimensions, the size of their noise."""

    t: Array  # (n,) s
    x: Array  # (n, c)
    rate: Array | None = None  # (n, c) of dx/dt, where the source has it
    dimensions: int = 1  # of the noise; three for the four components of a unit quaternion
    sigma: float | None = None  # of the noise in a dimension, where it is given

    @property
    def degrees_of_freedom(self) -> int:
        """What the samples know beyond the polynomials that no penalty touches."""
        return self.dimensions * (len(self.t) * (1 if self.rate is None else 2) - ORDER)

    def part(self, rows: slice | npt.NDArray[np.bool_] | npt.NDArray[np.intp]) -> Samples:
        """Some of the samples, in order."""
        return self._replace(
            t=self.t[rows], x=self.x[rows], rate=None if self.rate is None else self.rate[rows]
        )


class Smoothness(NamedTuple):
    """What there is to choose."""

    penalty: float  # variance of the noise over that of the fifth derivative, time in units of the spacing
    memory: float = 0.0  # s, time constant of the noise: its correlation is exp(-dt / memory)
    weight: float = 1.0  # s^2, variance of the noise of samples over that of the noise of rates


class Solution(NamedTuple):
    """The spline of least penalised squares."""

    coefficients: Array  # (size, c)
    energy: float  # its penalised squares
    log_determinant: float  # what the likelihood adds per dimension for its freedom


class System:
    """The normal equations of one stretch of samples, for any smoothness."""

    def __init__(self, samples: Samples, knots: Array, unit: float) -> None:
        self.samples, self.knots, self.unit = samples, knots, unit
        self.size = len(knots) - DEGREE - 1
        self.rows = basis_rows(knots, samples.t)
        self.penalties = penalty_rows(knots, unit)
        self.penalty = gram(self.penalties, self.size)
        # A search goes back and forth between no memory and some.
        self._values = lru_cache(4)(self._whitened)
        if samples.rate is not None:
            rows = basis_rows(knots, samples.t, 1)
            self.rate_rows = rows
            self.rate_gram, self.rate_moments = (
                gram(rows, self.size),
                transposed(rows, samples.rate, self.size),
            )

    def _whitened(self, memory: float) -> tuple[Rows, Array, Array, Array, float]:
        """Rows and samples whose noise is white; Gram matrix, moments, and log determinant of the change."""
        kept, new = correlated(self.samples.t, self.rows.starts, memory)
        rows = self.rows if memory == 0.0 else whitened_rows(self.rows, kept, new)
        x = whitened(self.samples.x, kept, new)
        log_size = 2.0 * float(np.log(new).sum())
        return rows, x, gram(rows, self.size), transposed(rows, x, self.size), log_size

    def factor(self, smoothness: Smoothness) -> Array:
        """Banded Cholesky factor of the normal equations."""
        matrix = self._values(smoothness.memory)[2].copy()
        matrix[: len(self.penalty)] += smoothness.penalty * self.penalty
        if self.samples.rate is not None:
            matrix[: len(self.rate_gram)] += smoothness.weight * self.rate_gram
        return np.asarray(cholesky_banded(matrix, lower=True, check_finite=False))

    def solve(self, smoothness: Smoothness) -> Solution:
        """Best spline for a smoothness."""
        _, x, _, moments, log_size = self._values(smoothness.memory)
        factor = self.factor(smoothness)
        if self.samples.rate is not None:
            moments = moments + smoothness.weight * self.rate_moments
            log_size -= len(x) * np.log(smoothness.weight)
        c = cho_solve_banded((factor, True), moments, check_finite=False)
        energy = self.penalised_squares(c, smoothness)
        freedom = 2.0 * np.log(factor[0]).sum() - (self.size - ORDER) * np.log(smoothness.penalty)
        return Solution(c, energy, float(freedom + log_size))

    def penalised_squares(
        self,
        c: Array,
        smoothness: Smoothness,
        first: int = 0,
        last: int | None = None,
        columns: int | None = None,
    ) -> float:
        """What `solve` makes least; of the coefficients from `first` up to `last`, and the first columns, alone."""
        last = self.size if last is None else last
        mine = slice(*np.searchsorted(self.rows.starts, [first, last]))
        energy = np.square(self.news(c, smoothness.memory)[1][mine, :columns]).sum()
        energy += smoothness.penalty * np.square(product(self.penalties, c)[first:last, :columns]).sum()
        if self.samples.rate is not None:
            left = (self.samples.rate - product(self.rate_rows, c))[mine, :columns]
            energy += smoothness.weight * np.square(left).sum()
        return float(energy)

    def news(self, c: Array, memory: float) -> tuple[Array, Array]:
        """(n, c) what is new in every sample and in what is left of it, per standard deviation of noise."""
        rows, x, *_ = self._values(memory)
        return x, x - product(rows, c)

    def residuals(self, c: Array) -> Array:
        """(n, c) what is left of the samples."""
        return self.samples.x - product(self.rows, c)

    def variance(self, t: Array, order: int, band: Array) -> Array:
        """(n,) variance of a column's derivative at increasing times, for noise of variance 1.

        band: of the inverse of the normal equations, `inverse_band(factor(...))`. Source: Wahba 1983.
        """
        return quadratic_forms(basis_rows(self.knots, t, order), band)

    def minus_log_likelihood(self, smoothness: Smoothness) -> float:
        """Twice the restricted likelihood's negative logarithm, up to a constant; the noise level is the best
        one where none is given."""
        try:
            solution = self.solve(smoothness)
        except np.linalg.LinAlgError:
            # Round-off has left no positive matrix: nothing to trust.
            return np.inf
        samples = self.samples
        freedom = samples.dimensions * solution.log_determinant
        if samples.sigma is not None:
            return solution.energy / samples.sigma**2 + freedom
        # Kept off zero: constant samples are fitted without any residual.
        free = samples.degrees_of_freedom
        return float(free * np.log(max(solution.energy, 1e-300) / free) + freedom)
