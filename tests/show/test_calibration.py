"""The figure of a calibration: the readings on their ellipsoid before, on a sphere about zero after."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel import ImuRecording
from kreisel.data.calibration import Calibration, TriadCalibration
from kreisel.maths.rotations import exp_so3
from kreisel.show import plot_calibration

pytestmark = pytest.mark.filterwarnings("error")

MAG = TriadCalibration(np.diag([1.2, 0.9, 1.0]), np.array([20.0, -10.0, 5.0]))
ACCEL = TriadCalibration(np.diag([1.01, 0.99, 1.0]), np.array([0.1, 0.0, -0.1]))


def recording() -> ImuRecording:
    """Ten poses of three seconds in a field of 50 uT, every second magnetometer sample missing."""
    R = np.repeat(exp_so3(np.random.default_rng(4).uniform(-3.0, 3.0, (10, 3))), 300, axis=0)
    gyro = np.zeros((3000, 3))
    gyro[np.arange(3000) % 300 < 20] = 2.0
    accel = (np.array([0.0, 0.0, 9.8]) @ R) @ ACCEL.matrix.T + ACCEL.bias
    mag = (np.array([0.0, 30.0, -40.0]) @ R) @ MAG.matrix.T + MAG.bias
    mag[1::2] = np.nan
    return ImuRecording(np.arange(3000) / 100.0, gyro, accel, mag, name="Mine")


def test_both_sensors_are_drawn_before_and_after() -> None:
    figure = plot_calibration(recording(), Calibration(accel=ACCEL, mag=MAG), gravity=9.8)
    assert figure.get_suptitle() == "Mine: before and after calibration"
    before, after, strength, rest = figure.axes
    assert "hard iron, 22.9" in before.get_legend().get_texts()[0].get_text()
    assert "sphere of 50 " in after.get_title(loc="left")
    raw, right = (line.get_ydata() for line in strength.get_lines())
    assert len(raw) == 1500 and np.ptp(raw) > 10.0
    np.testing.assert_allclose(right, 50.0, rtol=1e-12)
    lines = [line.get_ydata() for line in rest.get_lines() if len(line.get_ydata()) == 10]
    # A mean over rest of readings that do not change.
    assert np.abs(lines[0]).max() > 0.02 and np.abs(lines[1]).max() < 1e-12


def test_one_sensor_has_its_own_panels_and_a_gyro_none() -> None:
    plain = ImuRecording(recording().t, recording().gyro, recording().accel)
    assert len(plot_calibration(plain, Calibration(accel=ACCEL, mag=MAG)).axes) == 1
    assert len(plot_calibration(recording(), Calibration(mag=MAG)).axes) == 3
    with pytest.raises(ValueError, match="nothing to draw"):
        plot_calibration(recording(), Calibration(gyro=TriadCalibration()))
