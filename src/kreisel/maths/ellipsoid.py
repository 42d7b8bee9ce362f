"""Turns readings of a vector of constant length, taken in many attitudes, into the ellipsoid they lie on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# The six freedoms of a symmetric matrix, diagonal first.
_ROWS, _COLUMNS = np.array([0, 1, 2, 0, 0, 1]), np.array([0, 1, 2, 1, 2, 2])

_PASSES = 50
_SETTLED = 1e-12  # relative to the size of the ellipsoid


class Ellipsoid(NamedTuple):
    """Points y with |W (y - centre)| = 1; W is symmetric and positive definite."""

    centre: Array  # (3,) unit of the points
    W: Array  # (3, 3) its inverse
    covariance: Array  # (p, p) of the centre and then the elements 00 11 22 01 02 12 of W, or 00 11 22 alone
    rms: float  # distance of the points, unit of the points; over degrees of freedom


def fit_ellipsoid(points: Array, diagonal: bool = False, sigma: float | None = None) -> Ellipsoid | None:
    """The ellipsoid nearest to `points` (n, 3); None where they lie on no ellipsoid that can be told.

    diagonal : keep the axes of the ellipsoid along those of the points: six unknowns in place of nine.
    sigma : standard error of a point, per axis; by default what the distances say.
    A closed form starts it (least squares on the quadric's equation), then Gauss-Newton makes the sum of
    squared distances least, each distance to first order, less the mean by which noise pushes points outwards.
    Source: T. Taubin, "Estimation of planar curves ...", IEEE PAMI 13 (1991), for the distance.
    """
    middle, size = points.mean(axis=0), float(points.std())
    if size == 0.0:
        return None
    scaled = (points - middle) / size
    start = _closed_form(scaled, diagonal)
    if start is None:
        return None
    found = _refined(scaled, *start, diagonal, None if sigma is None else sigma / size)
    if found is None:
        return None
    units = np.concatenate([np.full(3, size), np.full(len(found.covariance) - 3, 1.0 / size)])
    covariance = found.covariance * np.outer(units, units)
    return Ellipsoid(middle + size * found.centre, found.W / size, covariance, size * found.rms)


def _closed_form(y: Array, diagonal: bool) -> tuple[Array, Array] | None:
    """Centre and W of the quadric y^T A y + 2 c^T y = d of least algebraic error."""
    squares = y[:, _ROWS] * y[:, _COLUMNS] * np.where(_ROWS == _COLUMNS, 1.0, 2.0)
    used = 3 if diagonal else 6
    design = np.column_stack([squares[:, :used], 2.0 * y, -np.ones(len(y))])
    # Six sides are fewer rows than unknowns: the whole basis is wanted, of the small factor.
    v = np.linalg.svd(np.linalg.qr(design, mode="r"), full_matrices=True)[2][-1]
    v = v * np.sign(v[:3].sum())
    A = _symmetric(v[:used])
    if not np.linalg.eigvalsh(A)[0] > 1e-9:
        return None
    centre = -np.linalg.solve(A, v[used : used + 3])
    level = v[-1] + centre @ A @ centre
    if not level > 0.0:
        return None
    values, vectors = np.linalg.eigh(A / level)
    return centre, np.asarray((vectors * np.sqrt(values)) @ vectors.T)


def _symmetric(elements: Array) -> Array:
    W = np.zeros((3, 3))
    for value, i, j in zip(elements, _ROWS, _COLUMNS, strict=False):
        W[i, j] = W[j, i] = value
    return W


def _refined(y: Array, centre: Array, W: Array, diagonal: bool, sigma: float | None) -> Ellipsoid | None:
    unknowns = 6 if diagonal else 9
    free = len(y) - unknowns
    variance = 0.0
    for _ in range(_PASSES):
        distance, J = _distances(y, centre, W, variance, unknowns)
        normal = J.T @ J
        if not np.linalg.cond(normal) < 1e14:
            return None
        step: Array = np.asarray(-np.linalg.solve(normal, J.T @ distance), dtype=np.float64)
        centre, W = centre + step[:3], W + _symmetric(step[3:])
        spread = float(distance @ distance) / free if free > 0 else 0.0
        variance = spread if sigma is None else sigma**2
        if np.abs(step).max() < _SETTLED:
            break
    if not np.linalg.eigvalsh(W)[0] > 0.0:
        return None
    covariance: Array = np.asarray(np.linalg.inv(normal) * variance, dtype=np.float64)
    return Ellipsoid(centre, W, covariance, float(np.sqrt(spread)))


def _distances(y: Array, centre: Array, W: Array, variance: float, unknowns: int) -> tuple[Array, Array]:
    """Signed distances (n,) of the points and their derivatives (n, unknowns)."""
    z = y - centre
    image = z @ W
    length = np.linalg.norm(image, axis=1)
    u = image / length[:, None]
    gradient = u @ W
    steep = np.linalg.norm(gradient, axis=1)
    outwards = 0.5 * variance * (np.sum(W * W) - steep**2) / length
    # Derivatives at the ellipsoid rather than at the point: they must not go with the noise of the distance.
    z = z / length[:, None]
    dW = u[:, _ROWS] * z[:, _COLUMNS] + np.where(_ROWS == _COLUMNS, 0.0, u[:, _COLUMNS] * z[:, _ROWS])
    J = np.column_stack([-gradient, dW])[:, :unknowns] / steep[:, None]
    return (length - 1.0 - outwards) / steep, J


def spread_of_inverse(W: Array, covariance: Array) -> Array:
    """Standard errors (3, 3) of the elements of W^-1, from the `covariance` that `Ellipsoid` has."""
    M, errors = np.linalg.inv(W), covariance[3:, 3:]
    basis = np.array([_symmetric(row) for row in np.eye(6)[: len(errors)]])
    J = -(M @ basis @ M).reshape(len(errors), 9)
    return np.asarray(np.sqrt(np.einsum("ka,kl,la->a", J, errors, J)).reshape(3, 3))
