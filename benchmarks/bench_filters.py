"""Turns simulated recordings into errors of attitude filters side by side: ours, smoothed and not, and vqf's.

Run: .venv/bin/python benchmarks/bench_filters.py [motions] [processes]     (12 and 1; the full count is 200)

Every motion (a hand, sport, a turntable, a limb, a car, a quadrotor, a drone's eights) is recorded by three grades of
sensors, each without magnets, among magnets in the room, and with magnets on the body: `filter_cases.py` says how.
Errors are root mean squares of a recording from 5 s on, in degrees; NEES is the mean square of error over sigma, 1
where sigma is honest.
The full count takes some seven minutes of one core.
"""

from __future__ import annotations

import os
import sys

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1")

from concurrent.futures import ProcessPoolExecutor

import numpy as np
from filter_cases import FIELDS, GRADES, MOTIONS, Case, case, motion
from vqf import VQF, offlineVQF

from kreisel import AttitudeHistory, DcmFilter, ImuRecording, MekfFilter, attitude_errors, run, smooth
from kreisel.maths.rotations import matrix_from_quat_wxyz

START = 5.0
SAMPLES = 4  # every so many are compared: neighbours err alike


def vqf(recording: ImuRecording) -> AttitudeHistory:
    step = float(np.diff(recording.t).mean())
    answer = VQF(step).updateBatch(*_copies(recording))
    return AttitudeHistory(recording.t, matrix_from_quat_wxyz(answer["quat9D"]))


def vqf_offline(recording: ImuRecording) -> AttitudeHistory:
    answer = offlineVQF(*_copies(recording), float(np.diff(recording.t).mean()))
    return AttitudeHistory(recording.t, matrix_from_quat_wxyz(answer["quat9D"]))


def _copies(recording: ImuRecording) -> list[np.ndarray]:
    """What a C++ extension may write to."""
    return [np.array(x) for x in (recording.gyro, recording.accel, recording.mag_uT)]


FILTERS = {
    "dcm": lambda recording: run(DcmFilter(), recording),
    "mekf": lambda recording: run(MekfFilter(), recording),
    "vqf": vqf,
    "mekf, smooth": lambda recording: smooth(MekfFilter(), recording),
    "vqf, offline": vqf_offline,
}


def errors(name: str, made: Case) -> list[float]:
    """Total, heading and inclination RMSE in degrees, and NEES of inclination and heading."""
    answer = FILTERS[name](made.recording)
    every = slice(int(np.searchsorted(made.recording.t, START)), None, SAMPLES)
    found = attitude_errors(made.truth.rows(every), answer)
    rms = [float(np.degrees(np.sqrt(np.mean(x**2)))) for x in (found.total, found.heading, found.inclination)]
    if answer.sigma is None:
        return [*rms, np.nan, np.nan]
    nees = (found.dtheta_N / answer.sigma[every]) ** 2
    return [*rms, float(nees[:, :2].mean()), float(nees[:, 2].mean())]


def scored(number: int) -> list[tuple[str, str, str, list[list[float]]]]:
    """All recordings of one motion: its kind, grade and field, and the errors of every filter."""
    kind = list(MOTIONS)[number % len(MOTIONS)]
    moved = motion(kind, number)
    return [
        (kind, grade, field, [errors(name, case(moved, kind, number, grade, field)) for name in FILTERS])
        for grade in GRADES
        for field in FIELDS
    ]


def print_table(rows: list[tuple[str, str, str, list[list[float]]]]) -> None:
    groups = ["all", *MOTIONS, *GRADES, *FIELDS]
    for place, (name, unit) in enumerate((("total", "deg"), ("heading", "deg"), ("inclination", "deg"))):
        print(f"\n{name}, {unit}: median and 95th percentile")
        print(f"{'':<12}" + "".join(f"{each:>18}" for each in FILTERS))
        for group in groups:
            x = np.array([row[3] for row in rows if group == "all" or group in row[:3]])[:, :, place]
            cells = zip(np.median(x, axis=0), np.percentile(x, 95.0, axis=0), strict=True)
            print(f"{group:<12}" + "".join(f"{a:>10.2f}{b:>8.2f}" for a, b in cells))
    for k, name in enumerate(FILTERS):
        if np.isfinite([row[3][k][3:] for row in rows]).all():
            print_nees(name, k, rows, groups)


def print_nees(
    name: str, k: int, rows: list[tuple[str, str, str, list[list[float]]]], groups: list[str]
) -> None:
    """Mean squares of error over sigma, run by run: their mean over runs, and how many runs are near 1.

    An error that hardly changes within a run has the square of one normal number there: 1 in the mean, 0.45 in the
    median.
    """
    print(
        f"\n{name}, NEES of a run: mean and median; inclination and heading in the mean; runs in 0.5 to 2, above 2"
    )
    for group in groups:
        x = np.array([row[3][k][3:] for row in rows if group == "all" or group in row[:3]])
        total = (2.0 * x[:, 0] + x[:, 1]) / 3.0
        near, above = np.mean((total > 0.5) & (total < 2.0)), np.mean(total > 2.0)
        print(
            f"{group:<12}{total.mean():8.2f}{np.median(total):8.2f}{x[:, 0].mean():10.2f}{x[:, 1].mean():8.2f}"
            f"{near:10.0%}{above:6.0%}"
        )


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 12
    processes = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    if processes > 1:
        with ProcessPoolExecutor(processes) as pool:
            parts = list(pool.map(scored, range(count)))
    else:
        parts = [scored(number) for number in range(count)]
    rows = [row for part in parts for row in part]
    print(f"{count} motions, {len(rows)} recordings")
    print_table(rows)


if __name__ == "__main__":
    main()
