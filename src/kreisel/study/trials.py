"""Turns recordings and their truth, or a scenario and its draws, into trials: recordings with attitude beside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.data.trial import Trial
from kreisel.study.run import run
from kreisel.study.scenario import Scenario


def paired(recording: ImuRecording, truth: Motion | AttitudeHistory | Poses, name: str = "") -> Trial:
    """A recording with the attitude of its sensor from elsewhere; ValueError where `truth` has positions only."""
    R_NS = truth.R_NS if isinstance(truth, AttitudeHistory) else truth.R_NB
    if R_NS is None:
        raise ValueError(f"the truth of {name or 'a recording'} has positions only; errors need attitude.")
    counts = np.ones(len(truth), dtype=np.bool_)
    return Trial(recording, Reference(truth.t, R_NS, counts, truth.t0_ns, truth.name), name)


def simulated(scenario: Scenario, draws: int) -> list[Trial]:
    """What the IMUs of `scenario` read, run with as many seeds, its own first: one trial an IMU and draw."""
    trials = []
    for seed in range(scenario.seed, scenario.seed + draws):
        # Filters would only cost time: whoever asks for trials brings their own.
        made = run(replace(scenario, seed=seed, filters=()))
        for mount, recording in zip(made.mounts, made.recordings, strict=True):
            name = "/".join(filter(None, (scenario.name, recording.name, f"seed {seed}")))
            trials.append(paired(recording, made.motion.at(mount), name))
    return trials
