"""Turns a smooth vector function of time into its integral from the beginning, at any time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

NODES = 16

_X, _W = np.polynomial.legendre.leggauss(NODES)
# Values at Gauss's nodes -> Legendre coefficients of the polynomial through them.
_FIT = (np.arange(NODES) + 0.5)[:, None] * np.polynomial.legendre.legvander(_X, NODES - 1).T * _W


class RunningIntegral:
    """The integral of `function`, t (n,) -> (n, c), from the first of `edges` (m + 1,) s on.

    Between two edges it takes the polynomial of degree 15 through Gauss's nodes: exact for one of such a degree, and to
    round-off where a sine runs through half a radian.
    """

    def __init__(self, function: Callable[[Array], Array], edges: Array) -> None:
        self._edges = edges
        self._half = 0.5 * np.diff(edges)
        nodes = 0.5 * (edges[:-1] + edges[1:])[:, None] + self._half[:, None] * _X
        values = function(nodes.ravel()).reshape(len(self._half), NODES, -1)
        self._series = np.einsum("kj,mjc->mkc", _FIT, values)
        # The integral over a cell is that of the constant term.
        whole = 2.0 * self._half[:, None] * self._series[:, 0]
        self._before = np.concatenate([np.zeros((1, whole.shape[1])), np.cumsum(whole, axis=0)])

    def __call__(self, t: Array) -> Array:
        """(n, c) at times t (n,)."""
        cell = np.clip(np.searchsorted(self._edges, t, side="right") - 1, 0, len(self._half) - 1)
        x = (t - self._edges[cell]) / self._half[cell] - 1.0
        return np.asarray(
            self._before[cell]
            + self._half[cell, None] * np.einsum("nk,nkc->nc", _integrals(x), self._series[cell])
        )


def _integrals(x: Array) -> Array:
    """Integrals (n, NODES) from -1 to x (n,) of the Legendre polynomials: (P_k+1 - P_k-1) / (2 k + 1)."""
    P = np.polynomial.legendre.legvander(x, NODES)
    out = np.empty((len(x), NODES))
    out[:, 0] = x + 1.0
    out[:, 1:] = (P[:, 2:] - P[:, :-2]) / (2.0 * np.arange(1, NODES) + 1.0)
    return out
