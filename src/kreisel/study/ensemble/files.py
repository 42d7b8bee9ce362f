"""Turns an Ensemble into a folder of scenario.toml, ensemble.npz and report.json, and back."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.atomic import replacing
from kreisel.data.archive import arrays_in
from kreisel.study.ensemble.ensemble import LEVELS, Ensemble, Estimates
from kreisel.study.run import described, json_safe
from kreisel.study.scenario import Scenario

SCHEMA = "kreisel.ensemble/1"
SCENARIO, ARRAYS, REPORT = "scenario.toml", "ensemble.npz", "report.json"

_INPUT, _FIGURE, _QUANTILES = "input", "figure", "quantiles"


def report(ensemble: Ensemble) -> dict[str, Any]:
    """See `Ensemble.report`."""
    made: dict[str, Any] = json_safe(
        {
            "schema": SCHEMA,
            "scenario": described(ensemble.base),
            "folder": str(ensemble.base.folder.absolute()),
            "runs": ensemble.runs,
            "estimates": ensemble.summary(),
        }
    )
    return made


def save(ensemble: Ensemble, folder: Path) -> Path:
    """See `Ensemble.save`."""
    folder.mkdir(parents=True, exist_ok=True)
    write_scenario(ensemble, folder / SCENARIO)
    write_report(ensemble, folder / REPORT)
    # Last: where it is, the others are.
    write_arrays(ensemble, folder / ARRAYS)
    return folder


def write_scenario(ensemble: Ensemble, path: Path) -> None:
    """Write the scenario with what varies."""
    with replacing(path) as out:
        out.write(ensemble.base.to_toml().encode())


def write_report(ensemble: Ensemble, path: Path) -> None:
    """Write statistics and correlations as JSON."""
    with replacing(path) as out:
        out.write((json.dumps(report(ensemble), indent=2, allow_nan=False) + "\n").encode())


def write_arrays(ensemble: Ensemble, path: Path) -> None:
    """Write all that `load` reads."""
    arrays = _arrays(ensemble)
    with replacing(path) as out:
        np.savez(out, allow_pickle=False, **arrays)


def load(folder: Path) -> Ensemble:
    """See `Ensemble.load`."""
    path = folder / ARRAYS
    try:
        arrays = arrays_in(path)
        if str(arrays.get("schema")) != SCHEMA:
            raise ValueError(f"it is no {SCHEMA}.")
        places = json.loads(str(arrays["folder"]))
        base = Scenario.from_toml(str(arrays["scenario"]), places, str(folder / SCENARIO))
        return _ensemble(base, arrays)
    except (ValueError, KeyError) as error:
        raise ValueError(f"{path}: {error}") from None


def _arrays(ensemble: Ensemble) -> dict[str, npt.NDArray[Any]]:
    base = ensemble.base
    arrays: dict[str, npt.NDArray[Any]] = {
        "schema": np.array(SCHEMA),
        "scenario": np.array(base.to_toml()),
        "folder": np.array(json.dumps(str(base.folder.absolute()))),
        "runs": np.array(ensemble.runs),
        "t": ensemble.t,
        "levels": np.array(LEVELS),
    }
    for path, values in ensemble.inputs.items():
        plain = values if values.dtype != object else np.array([json.dumps(v) for v in values])
        arrays[f"{_INPUT}/{path}"] = plain
    for k, each in enumerate(ensemble.estimates):
        arrays[f"estimate/{k}"] = np.array([each.imu, each.filter])
        arrays |= {f"{k}/{_FIGURE}/{name}": values for name, values in each.figures.items()}
        arrays |= {f"{k}/{_QUANTILES}/{kind}": values for kind, values in each.quantiles.items()}
    return arrays


def _ensemble(base: Scenario, arrays: Mapping[str, npt.NDArray[Any]]) -> Ensemble:
    inputs = {name: _input(values) for name, values in _under(_INPUT, arrays).items()}
    count = len(_under("estimate", arrays))
    estimates = [
        Estimates(
            str(arrays[f"estimate/{k}"][0]),
            str(arrays[f"estimate/{k}"][1]),
            _under(f"{k}/{_FIGURE}", arrays),
            _under(f"{k}/{_QUANTILES}", arrays),
        )
        for k in range(count)
    ]
    return Ensemble(base, int(arrays["runs"]), inputs, arrays["t"], tuple(estimates))


def _under(prefix: str, arrays: Mapping[str, npt.NDArray[Any]]) -> dict[str, npt.NDArray[Any]]:
    return {name.removeprefix(f"{prefix}/"): x for name, x in arrays.items() if name.startswith(f"{prefix}/")}


def _input(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    if values.dtype.kind != "U":
        return values
    objects = np.empty(len(values), dtype=np.object_)
    objects[:] = [json.loads(str(text)) for text in values]
    return objects
