"""Turns a scene and a first guess into the parameters of least squares, with standard errors and what stays unseen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from kreisel.data.checks import Array
from kreisel.evaluate.align.correlation import correlation_length, effective_samples, long_run_sum, window_of
from kreisel.evaluate.align.model import SENSORS, Scene, blocks, expected_readings
from kreisel.evaluate.align.parameters import Parameters, useless
from kreisel.evaluate.align.unseen import ALONE, HIDDEN
from kreisel.maths.rotations import exp_so3, skew

# A direction in which even independent noise would leave a third of what is useless is not observed.
_OBSERVED = 10.0

# A residual below this is round-off or interpolation; as a weight it would call round-off a motion.
_FLOOR = {"gyro": 1e-4, "accel": 1e-3}  # rad/s, m/s^2

_PASSES = 30
_SETTLED = 1e-10  # of what is useless
_SETTLED_ERRORS = 1e-2  # of a standard error
_FEWEST = 50
_TURN = 1e-6  # rad


class Solution(NamedTuple):
    """Where least squares ended."""

    parameters: Parameters
    errors: Array  # (p,) standard errors; inf where not observed
    unseen: Array  # (m, p) orthonormal directions that the motion does not show, in units of `useless`
    residuals: dict[str, Array]  # sensor -> (n, 3), NaN where unused
    effective: dict[str, float]  # sensor -> number of independent samples
    settled: bool


class _Pass(NamedTuple):
    information: Array  # (p, p)
    pull: Array  # (p,)
    scores: Array  # (n, p), sum over its rows is `pull`
    residuals: dict[str, Array]


def solve(scene: Scene, start: Parameters, slots: Mapping[str, slice]) -> Solution:
    """Gauss-Newton on both sensors at once, each weighted by its residual; unseen directions stay where they are.

    Raises ValueError where too few samples lie inside the trajectory.
    """
    at, unit = start, useless(slots)
    sigma = {sensor: max(_rms(r), _FLOOR[sensor]) for sensor, r in _residuals(scene, start).items()}
    settled = False
    for _ in range(_PASSES):
        seen = _linearised(scene, at, slots, sigma)
        inverse, unseen = _observed_inverse(seen.information, unit)
        step = inverse @ seen.pull
        sigma = {sensor: max(_rms(r), _FLOOR[sensor]) for sensor, r in seen.residuals.items()}
        at, size = at.moved(slots, step), np.abs(step)
        if np.all(size <= _SETTLED * unit + _SETTLED_ERRORS * np.sqrt(np.diagonal(inverse))):
            settled = True
            break
    errors, effective = _errors(seen, inverse, unseen)
    return Solution(at, errors, unseen, seen.residuals, effective, settled)


def turned_back(found: Solution, slots: Mapping[str, slice], given: Array) -> Parameters:
    """The parameters found, with R_BS turned as near to `given` as an unseen axis of the rotation allows."""
    at = found.parameters
    if "rotation" not in slots:
        return at
    unseen = found.unseen[:, slots["rotation"]]
    values, vectors = np.linalg.eigh(unseen.T @ unseen)
    if (values > ALONE).sum() != 1:
        return at
    K, apart = skew(vectors[:, -1]), given.T @ at.R_BS
    # trace(apart Exp(angle axis)) is largest here, by Rodrigues' formula.
    angle = np.arctan2(np.trace(apart @ K), -np.trace(apart @ K @ K))
    if abs(angle) < _TURN:
        return at
    return replace(at, R_BS=at.R_BS @ exp_so3(angle * vectors[:, -1]))


def _residuals(scene: Scene, at: Parameters) -> dict[str, Array]:
    return {sensor: scene.readings[sensor] - expected_readings(scene, sensor, at) for sensor in SENSORS}


def _linearised(
    scene: Scene, at: Parameters, slots: Mapping[str, slice], sigma: Mapping[str, float]
) -> _Pass:
    """Normal equations around `at`, block by block."""
    count = sum(s.stop - s.start for s in slots.values())
    information, scores = np.zeros((count, count)), np.zeros((len(scene.stamps), count))
    residuals = {sensor: np.full((len(scene.stamps), 3), np.nan) for sensor in SENSORS}
    for sensor in SENSORS:
        for block in blocks(scene, sensor, at):
            left = scene.readings[sensor][block.rows] - block.expected
            residuals[sensor][block.rows] = left
            design = np.zeros((len(left), 3, count))
            for name, column in block.columns.items():
                if name in slots:
                    design[:, :, slots[name]] = column
            design /= sigma[sensor]
            flat = design.reshape(3 * len(left), count)
            information += flat.T @ flat
            scores[block.rows] += np.einsum("nkp,nk->np", design, left / sigma[sensor])
        _enough(sensor, residuals[sensor])
    return _Pass(information, scores.sum(axis=0), scores, residuals)


def _enough(sensor: str, residuals: Array) -> None:
    count = int(np.isfinite(residuals[:, 0]).sum())
    if count < _FEWEST:
        raise ValueError(
            f"{count} of the {sensor}'s samples lie inside the trajectory's span; {_FEWEST} are needed. "
            "Give a longer recording, or check the stamps and t0_ns of both."
        )


def _observed_inverse(information: Array, unit: Array) -> tuple[Array, Array]:
    """Inverse on the directions that the motion shows, and the others (m, p), as rows, in units of `unit`."""
    values, vectors = np.linalg.eigh(information * np.outer(unit, unit))
    shown = values > _OBSERVED
    scaled = vectors[:, shown] * unit[:, None]
    return np.asarray((scaled / values[shown]) @ scaled.T), np.asarray(vectors[:, ~shown].T)


def _errors(seen: _Pass, inverse: Array, unseen: Array) -> tuple[Array, dict[str, float]]:
    """Standard errors by the sandwich of Newey and West (1987): residuals may hang together over time.

    Every window of correlated rows counts as one when the fitted parameters are taken off the degrees of freedom.
    """
    lengths = {sensor: correlation_length(r) for sensor, r in seen.residuals.items()}
    effective = {sensor: effective_samples(r, lengths[sensor]) for sensor, r in seen.residuals.items()}
    window = window_of(max(lengths.values()), len(seen.scores))
    middle = long_run_sum(seen.scores, window)
    independent = sum(int(np.isfinite(r).sum()) for r in seen.residuals.values()) / (window + 1)
    freedom = independent / max(independent - len(inverse), 1.0)
    variance = freedom * np.diagonal(inverse @ middle @ inverse)
    hidden = np.square(unseen).sum(axis=0) > HIDDEN
    return np.where(hidden, np.inf, np.sqrt(np.maximum(variance, 0.0))), effective


def _rms(x: Array) -> float:
    return float(np.sqrt(np.nanmean(np.square(x))))
