"""Turns a scenario into an Ensemble: many runs of it, on all cores, each with draws of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from dataclasses import replace
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np

from kreisel.data.checks import Array
from kreisel.maths.kernels import LANES
from kreisel.study.engine import run_blocks
from kreisel.study.ensemble.distributions import distributions
from kreisel.study.ensemble.draws import Draws
from kreisel.study.ensemble.ensemble import LEVELS, Ensemble, Estimates
from kreisel.study.ensemble.figures import KINDS, instants
from kreisel.study.ensemble.work import INSTANTS, Columns, Work
from kreisel.study.run import described
from kreisel.study.scenario import Scenario

# ns a sample of one filter on one IMU, noise and errors included, and s that a block of runs is to take.
_COST, _BLOCK = 150.0, 0.3
_FEWEST = 16  # blocks, where there are as many tiles


def monte_carlo(
    scenario: Scenario,
    runs: int,
    vary: Mapping[str, Any] | None = None,
    *,
    backend: str | None = None,
    threads: int | None = None,
    folder: Path | str | None = None,
    resume: bool = False,
    on_done: Callable[[int], None] | None = None,
) -> Ensemble:
    """Run `scenario` with the noise, and with the values, of runs 0, 1, ... `runs` - 1 of its seed.

    vary : path of a value -> its distribution, as in {"imu.imu.p_BS[0]": {"normal": [0, 0.01]}}, beside those that the
        scenario's own `vary` has; docs/montecarlo.md lists them.
    backend : None for threads of this process, "dask" for workers started on this machine, "tcp://host:port" for a
        scheduler that runs already.
    threads : how many at most, on this machine; None for all cores. Neither changes a bit of the result.
    folder : finished runs are written there as they come; with `resume` it goes on where it was interrupted.
    on_done : called with the number of runs done, every time it grows.
    Raises ValueError for less than one run, for paths that lead nowhere, for a scenario without filters, and with
    path, value and run where a value was drawn that cannot be; and as `kreisel.run_blocks` does, such as for a folder
    of another scenario.
    """
    work = prepare(scenario, runs, vary)
    done: dict[int, Columns] = {}
    results = run_blocks(
        work,
        len(work.blocks),
        fingerprint="" if folder is None else fingerprint(work),
        backend=backend,
        threads=threads,
        folder=folder,
        resume=resume,
    )
    count = 0
    with closing(results) as blocks:
        for number, columns in blocks:
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
    tiles = max(1, min(round(_BLOCK / per_run / LANES), runs // (LANES * _FEWEST)))
    return replace(work, size=tiles * LANES)


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


def fingerprint(work: Work) -> dict[str, Any]:
    """What decides every bit of the blocks of `work`: the scenario, what the files it names hold, how runs are cut.

    Raises ValueError for a trajectory of functions, of which nothing tells whether it is the same one.
    """
    scenario = work.scenario
    scenario.to_toml()
    table = described(scenario)
    files = {
        text: blake2b((scenario.folder / text).read_bytes(), digest_size=16).hexdigest()
        for text in sorted(set(_texts(table)))
        if _is_file(scenario.folder / text)
    }
    return {"scenario": table, "files": files, "runs": work.runs, "runs in a block": work.size}


def _texts(value: Any) -> Iterator[str]:
    """Every text in a plain value."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list | tuple):
        for part in value.values() if isinstance(value, Mapping) else value:
            yield from _texts(part)


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a text that no file can be called
        return False
