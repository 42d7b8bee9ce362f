"""Turns a scenario into an Ensemble: many runs of it, on all cores, each with draws of its own."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np

from kreisel.data.checks import Array
from kreisel.study.ensemble.distributions import distributions
from kreisel.study.ensemble.draws import Draws
from kreisel.study.ensemble.ensemble import LEVELS, Ensemble, Estimates
from kreisel.study.ensemble.figures import KINDS, instants
from kreisel.study.ensemble.work import INSTANTS, Columns, Work
from kreisel.study.scenario import Scenario

# ns a sample of one filter on one IMU, noise and errors included, and s that a block of runs is to take.
_COST, _BLOCK = 150.0, 0.3
_TILE = 16
_FEWEST = 16  # blocks, where there are as many tiles


def monte_carlo(
    scenario: Scenario,
    runs: int,
    vary: Mapping[str, Any] | None = None,
    *,
    threads: int | None = None,
    on_done: Callable[[int], None] | None = None,
) -> Ensemble:
    """Run `scenario` with the noise, and with the values, of runs 0, 1, ... `runs` - 1 of its seed.

    vary : path of a value -> its distribution, as in {"imu.imu.p_BS[0]": {"normal": [0, 0.01]}}, beside those that the
        scenario's own `vary` has; docs/montecarlo.md lists them.
    threads : how many at most; None for all cores. They change no bit of the result.
    on_done : called with the number of runs done, every time it grows.
    Raises ValueError for less than one run, for paths that lead nowhere, for a scenario without filters, and with
    path, value and run where a value was drawn that cannot be.
    """
    work = prepare(scenario, runs, vary)
    done: dict[int, Columns] = {}
    count = 0
    for number, columns in _run_blocks(work, threads):
        done[number] = columns
        count += len(work.block(number))
        if on_done is not None:
            on_done(count)
    return gather(work, [done[number] for number in work.blocks])


def prepare(scenario: Scenario, runs: int, vary: Mapping[str, Any] | None = None) -> Work:
    """The work of `monte_carlo`, block by block, once all is checked that can be before a run. Raises as it does."""
    if isinstance(runs, bool) or not isinstance(runs, int) or runs < 1:
        raise ValueError(f"runs must be a whole number, 1 or more; got {runs!r}.")
    if not scenario.filters:
        raise ValueError("a scenario without filters has no errors to gather; give it one: [[filter]].")
    base = replace(scenario, run=0, vary={**scenario.vary, **distributions(vary or {})})
    draws = Draws(base)
    draws.check()
    work = Work(base, runs, size=1)
    first = work.stage(draws, 0)
    per_run = _COST * 1e-9 * len(first.motion) * len(base.imus) * len(base.filters)
    # Few runs in smaller blocks, or the last one would keep a single core busy.
    tiles = max(1, min(round(_BLOCK / per_run / _TILE), runs // (_TILE * _FEWEST)))
    return replace(work, size=tiles * _TILE)


def gather(work: Work, blocks: list[Columns]) -> Ensemble:
    """The ensemble of all blocks, in their order."""
    first = work.stage(Draws(work.scenario), 0).motion.t
    estimates, scenario = [], work.scenario
    pairs = [(imu.name, filter.name) for imu in scenario.imus for filter in scenario.filters]
    for k, (imu, filter) in enumerate(pairs):
        names = [name for name in blocks[0] if name.startswith(f"{k}/")]
        columns = {name.split("/", 1)[1]: np.concatenate([block[name] for block in blocks]) for name in names}
        quantiles = _quantiles(columns.pop("trace"))
        estimates.append(Estimates(imu, filter, columns, quantiles))
    t = first[instants(len(first), INSTANTS)] - first[0]
    return Ensemble(scenario, work.runs, Draws(scenario).columns(work.runs), t, tuple(estimates))


def _quantiles(traces: Any) -> dict[str, Array]:
    """Quantiles (len(LEVELS), m) over runs of traces (runs, 3, m), kind by kind."""
    return {
        kind: np.quantile(traces[:, k].astype(np.float64), LEVELS, axis=0) for k, kind in enumerate(KINDS)
    }


def _run_blocks(work: Work, threads: int | None) -> Iterator[tuple[int, Columns]]:
    """Blocks by their numbers, as they are done."""
    count = len(os.sched_getaffinity(0)) if threads is None else threads
    with ThreadPoolExecutor(max(count, 1)) as pool:
        try:
            yield from zip(work.blocks, pool.map(work, work.blocks), strict=True)
        except BaseException:
            # Whoever waits for an error or presses Ctrl-C need not wait for the blocks that have not begun.
            pool.shutdown(wait=False, cancel_futures=True)
            raise
