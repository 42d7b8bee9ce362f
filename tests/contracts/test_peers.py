"""What every filter of others promises behind its adapter, asked of each one that discovery finds."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from kreisel import discovery
from kreisel.data.attitude import AttitudeHistory
from kreisel.evaluate.attitude_errors import attitude_errors
from kreisel.study.broad import FILTERS, PEERS
from tests.trials import RATE_HZ, turning_trial

NAMES = discovery.names(PEERS)
SOURCE = Path(__file__).resolve().parents[2] / "src"


@pytest.fixture(params=NAMES)
def peer(request: pytest.FixtureRequest) -> ModuleType:
    module = discovery.load(PEERS, request.param)
    if find_spec(module.PACKAGE) is None:
        pytest.skip(f"{module.PACKAGE} is not installed: pip install kreisel[compare]")
    return module


def test_it_answers_in_our_frames_and_units(peer: ModuleType) -> None:
    trial = turning_trial()
    imu = trial.recording
    R_NS = peer.estimate(imu.gyro, imu.accel, imu.mag_uT, 1.0 / RATE_HZ)
    assert R_NS.shape == (len(imu), 3, 3)
    late = attitude_errors(trial.reference, AttitudeHistory(imu.t, R_NS), samples=imu.t > 10.0).summary()
    # Clean readings: what is left is the lag of each, half a degree. A wrong frame or unit makes tens.
    assert late.total_max_deg < 2.0


def test_readings_are_left_as_they_were(peer: ModuleType) -> None:
    imu = turning_trial(1.0).recording
    readings = [np.array(x) for x in (imu.gyro, imu.accel, imu.mag_uT)]
    before = [x.copy() for x in readings]
    peer.estimate(*readings, 1.0 / RATE_HZ)
    for now, then in zip(readings, before, strict=True):
        np.testing.assert_array_equal(now, then)


@pytest.mark.parametrize("name", NAMES)
def test_it_describes_itself_in_a_line(name: str) -> None:
    module = discovery.load(PEERS, name)
    assert module.SETTINGS and "\n" not in module.SETTINGS


def test_their_packages_are_loaded_at_the_first_call_only() -> None:
    """So that a missing one stops nobody who did not ask for it."""
    program = (
        "import sys\nfrom kreisel import discovery\n"
        f"packages = [discovery.load({PEERS!r}, name).PACKAGE for name in {NAMES}]\n"
        "print(*(package for package in packages if package in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": str(SOURCE)},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout.strip()) == (0, ""), done.stderr


def test_no_name_stands_for_two_filters() -> None:
    assert not set(discovery.names(FILTERS)) & set(NAMES)
