"""Turns a Result, or files that belong together, into an Account: what is known of one run, wherever it comes from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.checks import Array
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.evaluate.attitude_errors import Align, AttitudeErrors, Truth, attitude_errors
from kreisel.study.run import Result


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """What one IMU read, and where it sat."""

    mount: Mount
    recording: ImuRecording
    gyro_bias: Array | None = None  # (n, 3) rad/s, the true one; None where nobody knows it


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """What one filter made of what one IMU read."""

    imu: str  # name of the mount
    filter: str
    attitude: AttitudeHistory  # of the sensor
    errors: AttitudeErrors | None = None  # None where there is no truth


@dataclass(frozen=True, slots=True, eq=False)
class Account:
    """One run: the truth, what the IMUs read, what the filters made of it, and how well."""

    name: str
    readings: tuple[Reading, ...]
    answers: tuple[Answer, ...] = ()
    truth: Truth | None = (
        None  # Motion and Poses of the body; Reference and AttitudeHistory of the one sensor
    )
    report: Mapping[str, Any] = field(
        default_factory=dict
    )  # as `Result.report` has it; empty for files of others


def account_of(result: Result) -> Account:
    """The account of a run that is still in memory."""
    # An IMU without errors is in no `recorded`, and its bias is none.
    known = {recorded.measured.name: recorded.gyro_bias for recorded in result.recorded}
    readings = [
        Reading(mount, recording, known.get(recording.name, np.zeros_like(recording.gyro)))
        for mount, recording in zip(result.mounts, result.recordings, strict=True)
    ]
    answers = [Answer(e.imu, e.filter, e.attitude, e.errors) for e in result.estimates]
    name = result.scenario.name or result.motion.name
    return Account(name, tuple(readings), tuple(answers), result.motion, result.report())


def account_of_files(
    recording: ImuRecording,
    estimates: Mapping[str, AttitudeHistory],
    truth: Truth | None = None,
    *,
    mount: Mount | None = None,
    align: Align | None = None,
) -> Account:
    """The account of a recording with attitudes estimated from it, by name, and where it is known the truth.

    mount : where the IMU sat on the body of which `truth` tells. align : as `attitude_errors` has it.
    Raises ValueError where a truth shows no attitude or does not overlap.
    """
    mount = mount or Mount()
    seen = None if truth is None else sensor_attitude(truth, mount)
    answers = [
        Answer(mount.name, name, found, None if seen is None else attitude_errors(seen, found, align=align))
        for name, found in estimates.items()
    ]
    return Account(recording.name, (Reading(mount, recording),), tuple(answers), truth)


def sensor_attitude(truth: Truth, mount: Mount) -> Reference:
    """True attitude of the sensor at `mount`; ValueError for positions only."""
    if isinstance(truth, Reference):
        return truth
    R = truth.R_NS if isinstance(truth, AttitudeHistory) else truth.R_NB
    if R is None:
        raise ValueError("the truth has positions only; attitude errors need attitude (R_NB).")
    turned = R if isinstance(truth, AttitudeHistory) else R @ mount.R_BS
    return Reference(truth.t, turned, np.ones(len(truth), dtype=np.bool_), truth.t0_ns, truth.name)


def body_path(truth: Truth | None) -> Motion | Poses | None:
    """The truth where it says where the body was."""
    return truth if isinstance(truth, Motion | Poses) else None
