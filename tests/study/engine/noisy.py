"""Turns a block number into the errors of a few runs of the DCM filter on simulated noise: work for the engine."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kreisel import DcmFilter, run_batch
from kreisel.maths.random import stream


@dataclass(frozen=True)
class Noisy:
    """`runs` IMUs at rest, each with white noise of its own."""

    seed: int = 1
    runs: int = 8
    samples: int = 200
    pause: float = 0.0  # s, asleep, as work that takes long

    def __call__(self, block: int) -> dict[str, np.ndarray]:
        t = np.arange(self.samples) * 0.005
        gyro, accel = np.empty((self.runs, self.samples, 3)), np.empty((self.runs, self.samples, 3))
        for k in range(self.runs):
            run = block * self.runs + k
            gyro[k] = 0.01 * stream(self.seed, run, "imu/gyro", "white").normals(0, self.samples)
            accel[k] = 0.1 * stream(self.seed, run, "imu/accel", "white").normals(0, self.samples)
        accel[..., 2] += 9.80665
        time.sleep(self.pause)
        batch = run_batch(DcmFilter(), t, gyro, accel, threads=1)
        return {"last": batch.R_NS[:, -1], "rest": batch.rest.sum(axis=1)}


@dataclass(frozen=True)
class Deadly:
    """Ends the process that works on block `deadly`, once, or always where there is no folder for its `mark`."""

    mark: Path
    deadly: int

    def __call__(self, block: int) -> dict[str, np.ndarray]:
        if block == self.deadly and not self.mark.exists():
            if self.mark.parent.is_dir():
                self.mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return Noisy()(block)


def alike(left: dict[int, dict[str, np.ndarray]], right: dict[int, dict[str, np.ndarray]]) -> bool:
    """Whether two studies have the same blocks with the same bits."""

    def bits(study: dict[int, dict[str, np.ndarray]]) -> list[object]:
        return [
            (k, [(n, a.dtype.str, a.shape, a.tobytes()) for n, a in study[k].items()]) for k in sorted(study)
        ]

    return bits(left) == bits(right)
