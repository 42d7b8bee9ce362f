"""Times exact derivatives of the figure-1 loop, alone and with its tangent angles, on one thread.

    python benchmarks/bench_jets.py

The limit of the loop: its three components need two sines and two cosines (the first two components share
theirs), then per component and order one array pass each for the chain rule, the amplitude and the output.
"trig" is the time of those sines and cosines alone. Each figure is the best of several runs.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.maths.jets import Jet, differentiate

BLOCK = 8192
SAMPLES = 50 * BLOCK


def loop(t: Any, f: float = 0.125) -> Any:
    return (
        0.8 * np.cos(2 * np.pi * f * t),
        0.8 * np.sin(2 * np.pi * f * t),
        0.3 * np.cos(2 * np.pi * 3 * f * t),
    )


def with_tangent(t: npt.NDArray[np.float64], order: int) -> None:
    """Position to `order` and heading and pitch of the path to order - 1, block by block."""
    for start in range(0, t.size, BLOCK):
        path = loop(Jet.variable(t[start : start + BLOCK], order))
        x, y, z = (component.rate() for component in path)
        angles = (np.arctan2(y, x), -np.arctan2(z, np.hypot(x, y)))
        for jet in (*path, *angles):
            for k in range(jet.order + 1):
                jet.derivative(k)


def trig(t: npt.NDArray[np.float64]) -> None:
    for start in range(0, t.size, BLOCK):
        for w in (0.8, 2.4):
            turn = w * t[start : start + BLOCK]
            np.sin(turn), np.cos(turn)


def million_per_second(work: Callable[[], object], runs: int = 7) -> float:
    best = np.inf
    for _ in range(runs):
        start = perf_counter()
        work()
        best = min(best, perf_counter() - start)
    return float(SAMPLES / best / 1e6)


def main() -> None:
    t = np.linspace(0.0, 80.0, SAMPLES)
    print(
        f"trig alone                            {million_per_second(lambda: trig(t)):6.1f} million samples/s"
    )
    for order in (3, 4):
        alone = million_per_second(partial(differentiate, loop, t, order))
        both = million_per_second(partial(with_tangent, t, order))
        print(f"loop to order {order}                       {alone:6.1f}")
        print(f"loop to order {order}, tangent to order {order - 1}   {both:6.1f}")


if __name__ == "__main__":
    main()
