"""Facts about a file a person would check first: rate, gaps and units that cannot be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.environment import STANDARD_GRAVITY as G
from kreisel.data.facts import Units, clock_of, facts, unit_doubts
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.maths.rotations import exp_so3

N = 200
T = np.arange(N) / 100.0


def level(scale: float = 1.0, gyro: float = 0.1, mag: float | None = None, up: float = 1.0) -> ImuRecording:
    accel = np.tile([0.0, 0.0, up * G * scale], (N, 1))
    field = None if mag is None else np.tile([0.4 * mag, 0.0, -0.9 * mag], (N, 1))
    return ImuRecording(T, np.full((N, 3), gyro), accel, field)


def test_a_clock_with_two_lost_samples_has_one_gap() -> None:
    clock = clock_of(np.delete(T, [50, 51]), 0)
    assert clock.rows == N - 2
    assert clock.rate_hz == pytest.approx(100.0)
    assert [(gap.t, pytest.approx(gap.length)) for gap in clock.gaps] == [(0.49, 0.03)]
    assert clock.jitter < 1e-12


def test_jitter_is_the_spread_of_the_steps(rng: np.random.Generator) -> None:
    clock = clock_of(T + rng.normal(scale=1e-5, size=N), 0)
    # The difference of two independent stamps spreads sqrt(2) wider; 200 samples give 5 %, five sigma 25 %.
    assert clock.jitter == pytest.approx(np.sqrt(2) * 1e-5, rel=0.25)


def test_sound_recordings_raise_no_doubt() -> None:
    assert unit_doubts(level(mag=48.0)) == []


@pytest.mark.parametrize(
    ("recording", "likely"),
    [
        (level(scale=1.0 / G), "looks like g,"),
        (level(scale=1e3 / G), "looks like mg or cm/s^2,"),
        (level(gyro=50.0), "looks like deg/s"),
        (level(mag=0.48), "looks like gauss"),
        (level(mag=480.0), "looks like mgauss"),
        (level(mag=48e3), "looks like nT"),
        (level(up=-1.0), "--frame ned-frd"),
        (replace(level(), accel=np.zeros((N, 3))), "reads zero"),
        (replace(level(), t=1e3 * T), "every 10 s: stamps in ms,"),
        (replace(level(), t=1e6 * T), "stamps in us,"),
        (replace(level(), t=1e9 * T), "stamps in ns,"),
    ],
)
def test_units_that_cannot_be_name_the_likely_one(recording: ImuRecording, likely: str) -> None:
    doubts = unit_doubts(recording)
    assert len(doubts) == 1
    assert likely in doubts[0]


def test_poses_tell_extent_path_and_rate() -> None:
    angle = 2.0 * np.pi * T / T[-1]
    circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(N)])
    R_NB = exp_so3(np.column_stack([np.zeros((N, 2)), angle]))
    numbers = facts(Poses(T, circle, R_NB)).numbers
    assert numbers["path length m"] == pytest.approx(2 * np.pi, rel=1e-3)  # a 199-gon: 4e-5 short
    assert numbers["largest rate rad/s"] == pytest.approx(2 * np.pi / T[-1], rel=1e-9)
    assert numbers["uprightness"] == pytest.approx(1.0)


def test_millimetres_taken_for_metres_are_doubted() -> None:
    walk = np.column_stack([1000.0 * T, np.zeros((N, 2))])
    assert "in mm" in facts(Poses(T, walk)).doubts[0]


def test_a_silent_sensor_has_facts_too() -> None:
    silent = np.full((N, 3), np.nan)
    what = facts(ImuRecording(T, silent, silent))
    assert what.numbers["missing rows"] == N
    assert what.doubts == ()


def spinning(rate: float) -> np.ndarray:
    return exp_so3(np.outer(rate * T, [0.0, 0.0, 1.0]))


def test_attitude_tells_its_rates_and_flags() -> None:
    rest = np.arange(N) < 30
    found = facts(AttitudeHistory(T, spinning(2.0), np.full((N, 3), 0.01), rest=rest))
    assert found.noun == "AttitudeHistory"
    assert found.holds == ("attitude", "gyro bias", "rest")
    assert found.numbers["median rate rad/s"] == pytest.approx(2.0)
    assert found.numbers["largest gyro bias rad/s"] == pytest.approx(0.01 * np.sqrt(3.0))
    assert found.numbers["rows rest"] == 30.0
    assert found.doubts == ()


def test_a_reference_is_judged_by_the_rows_that_count() -> None:
    R, counts = spinning(2.0), np.ones(N, dtype=bool)
    R[50:60], counts[50:60] = np.nan, False
    found = facts(Reference(T, R, counts))
    assert found.numbers["rows that count"] == N - 10
    assert found.numbers["largest rate rad/s"] == pytest.approx(2.0)
    assert found.numbers["uprightness"] == pytest.approx(1.0)


def test_attitude_that_jumps_is_doubted() -> None:
    R = spinning(0.0)
    R[100:] = np.diag([-1.0, -1.0, 1.0])
    assert "jumps at 314.2 rad/s" in facts(AttitudeHistory(T, R)).doubts[0]


def test_a_sensor_that_never_reads_is_named() -> None:
    nothing = np.full((N, 3), np.nan)
    assert Units.of(level()).silent() == []
    assert Units.of(replace(level(), gyro=nothing)).silent() == ["gyroscope"]
    assert Units.of(replace(level(), gyro=nothing, accel=nothing)).silent() == ["gyroscope", "accelerometer"]
