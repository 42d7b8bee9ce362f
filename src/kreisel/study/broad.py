"""Turns trials of the BROAD benchmark and attitude filters, ours and others', into scores by its metric.

A filter answers from the IMU alone, with one set of parameters for all trials, in real time unless its name
says otherwise. Root mean squares are over the samples that the benchmark counts, without any alignment;
beside them stand those after each trial's constant heading offset has been removed.
Source: Laidig, Caruso, Cereatti, Seel: BROAD, Data 6 (7), 2021, doi 10.3390/data6070072.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from types import ModuleType

import numpy as np

from kreisel import discovery
from kreisel.data.attitude import AttitudeHistory
from kreisel.data.checks import choice, finite
from kreisel.data.recording import ImuRecording
from kreisel.data.trial import Trial
from kreisel.evaluate.attitude_errors import attitude_errors
from kreisel.files.doors import read

FILTERS = "kreisel.estimate.filters"
PEERS = "kreisel.study.peers"

YARDSTICK = "vqf"
"""The filter that others are measured by."""

SMOOTH = "-smooth"
"""Behind the name of one of our filters: what it makes of a recording when it also looks ahead."""

_SMOOTHED = ("mekf",)

_SUFFIXES = (".mat", ".hdf5")


@dataclass(frozen=True, slots=True)
class Score:
    """How far one filter was off in one trial, or on the mean of several: RMSE in degrees."""

    filter: str
    trial: str
    total_rmse_deg: float
    heading_rmse_deg: float
    inclination_rmse_deg: float
    heading_offset_deg: float  # the constant turn about up that the next two leave out
    free_total_rmse_deg: float
    free_heading_rmse_deg: float  # and the inclination does not depend on it


def filter_names() -> list[str]:
    """Our filters, then ours smoothed, then those of others, by the names users type; nothing is imported."""
    ours, theirs = ([n.replace("_", "-") for n in discovery.names(p)] for p in (FILTERS, PEERS))
    return [*ours, *(name + SMOOTH for name in _SMOOTHED), *theirs]


def settings(name: str) -> str:
    """What runs under a name and with which tuning: one line."""
    if _is_peer(name):
        return str(_peer(name).SETTINGS)
    return "ours, defaults; sees the future" if name.endswith(SMOOTH) else "ours, defaults"


def installed(name: str) -> bool:
    """Whether the package behind a filter is there; ours always are."""
    from importlib.util import find_spec

    return not _is_peer(name) or find_spec(_peer(name).PACKAGE) is not None


def trial_files(folder: Path) -> list[Path]:
    """The trials in `folder`, one file for each, by name; ValueError where there are none."""
    if not folder.is_dir():
        raise ValueError(f"{folder} is not a folder. Give the one with the trials of BROAD (*.mat, *.hdf5).")
    # The benchmark comes in two formats: of a trial that is there twice, the one every SciPy reads.
    found = {p.stem: p for suffix in reversed(_SUFFIXES) for p in folder.iterdir() if p.suffix == suffix}
    if not found:
        raise ValueError(
            f"{folder} has no trials of BROAD (*.mat, *.hdf5). The paper, doi 10.3390/data6070072, says where "
            "they are."
        )
    return [found[stem] for stem in sorted(found)]


def read_trial(path: Path) -> Trial:
    """The trial in a file; ValueError for a file of another kind."""
    trial = read(path, kind="trial")
    assert isinstance(trial, Trial)  # the kind asked for
    return trial


def estimate(name: str, recording: ImuRecording) -> AttitudeHistory:
    """What the filter `name` makes of a recording, by its defaults.

    Raises ValueError for other names, for a package that is not installed, and where the filter of others
    would need samples that are missing.
    """
    choice("filter", name, filter_names())
    if not _is_peer(name):
        from kreisel.estimate.run import run
        from kreisel.estimate.smooth import smooth

        filter = discovery.load(FILTERS, _file(name.removesuffix(SMOOTH))).FILTER()
        return smooth(filter, recording) if name.endswith(SMOOTH) else run(filter, recording)
    if recording.mag_uT is None:
        raise ValueError(f"{name} needs a magnetometer, and {recording.name or 'the recording'} has none.")
    readings = {"gyro": recording.gyro, "accel": recording.accel, "mag_uT": recording.mag_uT}
    gyro, accel, mag_uT = (finite(key, values) for key, values in readings.items())
    step = float(recording.t[-1] - recording.t[0]) / (len(recording) - 1)
    if not installed(name):
        raise ValueError(f"{name} needs {_peer(name).PACKAGE}: pip install 'kreisel[compare]'.")
    return AttitudeHistory(recording.t, _peer(name).estimate(gyro, accel, mag_uT, step), name=name)


def score(name: str, trial: Trial) -> Score:
    """One filter on one trial."""
    answer = estimate(name, trial.recording)
    plain = attitude_errors(trial.reference, answer).summary()
    free = attitude_errors(trial.reference, answer, align="heading").summary()
    assert free.heading_offset_deg is not None  # it was asked for
    return Score(
        name,
        trial.name,
        plain.total_rmse_deg,
        plain.heading_rmse_deg,
        plain.inclination_rmse_deg,
        free.heading_offset_deg,
        free.total_rmse_deg,
        free.heading_rmse_deg,
    )


def scores(names: Sequence[str], paths: Sequence[Path]) -> Iterator[Score]:
    """Every filter on every trial, trial by trial, as they come."""
    for path in paths:
        trial = read_trial(path)
        for name in names:
            yield score(name, trial)


def mean(scores: Sequence[Score]) -> Score:
    """The mean of one filter's root mean squares over trials: the benchmark's figure.

    The offset is the mean of its magnitudes: offsets that cancel are offsets all the same.
    """
    numbers = [field.name for field in fields(Score)[2:]]
    values = {name: float(np.mean([abs(getattr(score, name)) for score in scores])) for name in numbers}
    return Score(scores[0].filter, f"mean of {len(scores)}", **values)


def _is_peer(name: str) -> bool:
    return _file(name) in discovery.names(PEERS)


def _peer(name: str) -> ModuleType:
    return discovery.load(PEERS, _file(name))


def _file(name: str) -> str:
    return name.replace("-", "_")
