"""Turns the folder that `kreisel run` wrote back into an Account of that run."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.checks import Array
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.evaluate.attitude_errors import attitude_errors
from kreisel.files.doors import read
from kreisel.maths.rotations import matrix_from_euler
from kreisel.study.account import Account, Answer, Reading
from kreisel.study.run import SCHEMA

REPORT = "report.json"
"""The file by which such a folder is known."""


def estimate_stem(imu: str, filter: str) -> str:
    """What the files of an estimate are called, without suffix."""
    return f"attitude-{imu}-{filter}".replace(" ", "-")


def read_account(folder: Path) -> Account:
    """The account of the run whose data is in `folder`; its pictures are not looked at.

    Raises ValueError with the file for a folder that `kreisel run` did not write, OSError where a file is missing.
    """
    report = _report(folder / REPORT)
    try:
        return _account(folder, report)
    except KeyError as missing:
        raise ValueError(f"{folder / REPORT} is no report of `kreisel run`: it lacks {missing}.") from None


def _account(folder: Path, report: dict[str, Any]) -> Account:
    scenario = report["scenario"]
    motion = read(folder / "truth.npz", kind="motion")
    assert isinstance(motion, Motion)  # the kind asked for
    readings = [_reading(folder, imu) for imu in scenario["imus"]]
    answers = [
        _answer(folder, reading, filter, motion) for reading in readings for filter in scenario["filters"]
    ]
    return Account(scenario["name"] or motion.name, tuple(readings), tuple(answers), motion, report)


def _report(path: Path) -> dict[str, Any]:
    try:
        report = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise FileNotFoundError(
            f"cannot read {path}: there is no such file. `kreisel run SCENARIO -o {path.parent}` writes it."
        ) from None
    except ValueError:
        raise ValueError(f"{path} is no report of `kreisel run`: it is not JSON.") from None
    found = report.get("schema") if isinstance(report, dict) else None
    if found != SCHEMA:
        raise ValueError(
            f"{path} is no report of `kreisel run`: its schema is {found!r}, {SCHEMA!r} is needed."
        )
    return dict(report)


def _reading(folder: Path, imu: Mapping[str, Any]) -> Reading:
    name = imu["name"]
    mount = Mount(np.array(imu["p_BS"]), matrix_from_euler(np.deg2rad(imu["rotation_deg"])), name)
    recording = read(folder / f"{name}.csv", kind="imu")
    assert isinstance(recording, ImuRecording)  # the kind asked for
    return Reading(mount, recording, _gyro_bias(folder / f"{name}-errors.npz", recording))


def _gyro_bias(path: Path, recording: ImuRecording) -> Array:
    """The true one; only of an IMU with errors is there a file."""
    if not path.exists():
        return np.zeros_like(recording.gyro)
    with np.load(path) as terms:
        return np.asarray(terms["gyro_bias"])


def _answer(folder: Path, reading: Reading, filter: Mapping[str, Any], motion: Motion) -> Answer:
    imu, name = reading.mount.name, filter["name"]
    attitude = read(folder / f"{estimate_stem(imu, name)}.npz", kind="attitude")
    assert isinstance(attitude, AttitudeHistory)  # the kind asked for
    truth = motion.at(reading.mount)
    errors = attitude_errors(truth, attitude, align=filter["align"], clock_offset=filter["clock_offset"])
    return Answer(imu, name, attitude, errors)
