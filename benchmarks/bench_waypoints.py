"""Paths through waypoints against the classical curve of least jerk: cost, time within limits, rate at the start.

    python benchmarks/bench_waypoints.py

The figures of docs/decisions/0041. Classical: one polynomial of degree 5 a leg, at rest at both ends.
"""

import numpy as np

from kreisel import WaypointTrajectory
from kreisel.maths.following.exact import follow
from kreisel.maths.polynomials import Polynomials, smoothest_through

LIMITS = {"max_speed": 6.0, "max_acceleration": 3.0}
COURSES, POINTS = 6, 7


def main() -> None:
    """Print one line for every random course."""
    rng = np.random.default_rng(0)
    print(
        "course  by limits [s]  classical [s]  jerk at the same times  rate at the start, classical [rad/s]"
    )
    for course in range(COURSES):
        points = np.cumsum(rng.normal(size=(POINTS, 3)) * [8.0, 8.0, 1.5], axis=0)
        fast = WaypointTrajectory(None, points, **LIMITS)
        curve = classical(fast.arrivals, points)
        longer = max(
            largest(curve, 1) / LIMITS["max_speed"], np.sqrt(largest(curve, 2) / LIMITS["max_acceleration"])
        )
        ours = WaypointTrajectory(fast.arrivals, points)
        share = jerk(lambda t, p=ours: p.sample(t).a_NB, fast.lap) / jerk(
            lambda t, c=curve: c(t, 2)[2], fast.lap
        )
        start = follow(curve, np.array([0.0, 1e-3]), (0.0, fast.lap)).attitude.omega_NB_B[0]
        print(
            f"{course:6}  {fast.lap:13.2f}  {fast.lap * longer:13.2f}  {share:22.2f}  {np.linalg.norm(start):13.3f}"
        )


def classical(t: np.ndarray, points: np.ndarray) -> Polynomials:
    """At the same times, from rest to rest."""
    known = np.full((len(t), 2, 3), np.nan)
    known[[0, -1]] = 0.0
    return smoothest_through(t, points, 3, known=known)


def largest(curve: Polynomials, order: int) -> float:
    t = np.linspace(curve.breaks[0], curve.breaks[-1], 20001)
    return float(np.linalg.norm(curve(t, order)[order], axis=1).max())


def jerk(acceleration, last: float) -> float:
    """Integral of the squared jerk."""
    t = np.linspace(0.0, last, 40001)
    return float((np.diff(acceleration(t), axis=0) ** 2).sum() / (t[1] - t[0]))


if __name__ == "__main__":
    main()
