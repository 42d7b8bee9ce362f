"""Turns recordings with faults into how often a filter finds back: after two minutes of trouble a minute of clean data.

Run: .venv/bin/python benchmarks/bench_faults.py [recordings] [filter]     (10000 and mekf; one thread)

A filter is back where its last second is within 5 degrees of heading and 2 of inclination. Faults are drawn at
random, one
to three to a recording: sensors that are silent, saturate or freeze, single wild numbers, magnets on the body and in
the room,
and a first heading that is wrong by 180 degrees.
"""

from __future__ import annotations

import os
import sys
from collections import Counter

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1")

import numpy as np
from filter_cases import Case, case, motion

from kreisel import discovery
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters import Array
from kreisel.maths.kernels import argument
from kreisel.maths.rotations import exp_so3

TROUBLE, CLEAN = 120.0, 60.0
# Cars are not among them: of those one in six is 2 deg of inclination off without any fault.
KINDS = ("hand", "table", "sport", "limb", "quadrotor")
MOTIONS = 50

Data = dict[str, Array]


def span(rng: np.random.Generator, t: Array, least: float, most: float) -> slice:
    """Some seconds of the troubled part."""
    length = rng.uniform(least, most)
    first = rng.uniform(0.0, TROUBLE - length)
    return slice(*np.searchsorted(t, [first, first + length]))


def silent(rng: np.random.Generator, t: Array, data: Data, truth: Array) -> None:
    for sensor in rng.choice(list(data), rng.integers(1, 4), replace=False):
        data[sensor][span(rng, t, 0.05, 20.0)] = np.nan


def saturated(rng: np.random.Generator, t: Array, data: Data, truth: Array) -> None:
    sensor, share = rng.choice(list(data)), rng.uniform(0.2, 0.9)
    part = data[sensor][span(rng, t, 1.0, 30.0)]
    limit = share * np.nanmax(np.abs(part), initial=0.0)
    np.clip(part, -limit, limit, out=part)


def frozen(rng: np.random.Generator, t: Array, data: Data, truth: Array) -> None:
    part = data[rng.choice(list(data))][span(rng, t, 0.5, 20.0)]
    part[:] = part[:1]


def wild(rng: np.random.Generator, t: Array, data: Data, truth: Array) -> None:
    rows = rng.integers(0, np.searchsorted(t, TROUBLE), rng.integers(1, 50))
    values = rng.choice([0.0, 1e2, -1e3, 1e30, np.inf, -np.inf, np.nan], (len(rows), 3))
    data[rng.choice(list(data))][rows] = values


def magnet_on_body(rng: np.random.Generator, t: Array, data: Data, truth: Array) -> None:
    data["mag"][span(rng, t, 10.0, 110.0)] += rng.normal(0.0, rng.choice([5.0, 20.0, 100.0]), 3)


def magnet_in_room(rng: np.random.Generator, t: Array, data: Data, truth: Array) -> None:
    rows = span(rng, t, 10.0, 110.0)
    data["mag"][rows] += rng.normal(0.0, rng.choice([5.0, 20.0, 100.0]), 3) @ truth[rows]


FAULTS = (silent, saturated, frozen, wild, magnet_on_body, magnet_in_room)


def angles_deg(R: Array, truth: Array) -> tuple[float, float]:
    """Largest heading and inclination error, of the twist about up and the swing that is left."""
    E = R @ truth.swapaxes(1, 2)
    inclination = np.arccos(np.clip(E[:, 2, 2], -1.0, 1.0))
    heading = np.arctan2(E[:, 1, 0] - E[:, 0, 1], E[:, 0, 0] + E[:, 1, 1])
    return float(np.degrees(np.abs(heading).max())), float(np.degrees(inclination.max()))


def trial(filter, base: Case, number: int) -> tuple[str, float, float, bool]:
    """Faults of one recording, its errors at the end, and whether the state is finite."""
    rng = np.random.default_rng(number)
    recording, truth = base.recording, base.truth.R_NB
    data = {
        "gyro": np.array(recording.gyro),
        "accel": np.array(recording.accel),
        "mag": np.array(recording.mag_uT),
    }
    chosen = rng.choice(len(FAULTS), rng.integers(1, 4), replace=False)
    for k in chosen:
        FAULTS[k](rng, recording.t, data, truth)
    names = [FAULTS[k].__name__ for k in sorted(chosen)]
    first = None
    if rng.random() < 0.25:
        first, names = exp_so3(np.array([0.0, 0.0, np.pi])) @ truth[0], [*names, "turned"]
    state, out = filter.start(first), Columns.room_for(filter, (len(truth),))
    inputs = [argument(x) for x in (recording.t, *data.values())]
    filter.batch(state, filter.parameters(), *inputs, out)
    last = slice(int(np.searchsorted(recording.t, TROUBLE + CLEAN - 1.0)), None)
    heading, inclination = angles_deg(out.R_NS[last], truth[last])
    return " ".join(names), heading, inclination, bool(np.isfinite(state).all())


def main() -> None:
    count = int(float(sys.argv[1])) if len(sys.argv) > 1 else 10_000
    name = sys.argv[2] if len(sys.argv) > 2 else "mekf"
    filter = discovery.load("kreisel.estimate.filters", name).FILTER()
    lost: Counter[str] = Counter()
    seen: Counter[str] = Counter()
    worst, infinite, away = [], 0, 0
    each = -(-count // MOTIONS)
    for m in range(MOTIONS):
        kind = KINDS[m % len(KINDS)]
        base = case(motion(kind, m, TROUBLE + CLEAN), kind, m, "industrial", "clean")
        for k in range(each):
            faults, heading, inclination, finite = trial(filter, base, m * each + k)
            infinite += not finite
            is_lost = not (heading < 5.0 and inclination < 2.0)
            away += is_lost
            for fault in faults.split():
                seen[fault] += 1
                lost[fault] += is_lost
            if is_lost:
                worst.append(
                    (max(heading / 5.0, inclination / 2.0), heading, inclination, kind, m * each + k, faults)
                )
    print(f"{MOTIONS * each} recordings: {infinite} not finite, {away} not back within 5 and 2 degrees")
    for fault in seen:
        print(f"{fault:<16}{lost[fault]:>6} of {seen[fault]}")
    for _, heading, inclination, kind, number, faults in sorted(worst, reverse=True)[:20]:
        print(f"{heading:8.1f} {inclination:8.1f}  {kind:<6} {number:>6}  {faults}")


if __name__ == "__main__":
    main()
