"""Runs read abreast: each has the bits that `Imu.record` gives it, whatever its sensors and its clock are like."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kreisel import Environment, Imu, Mount, figure_eight
from kreisel.maths.kernels import LANES
from kreisel.simulate.clock import Clock, Sampling
from kreisel.simulate.effects.scale_factor import ScaleFactor
from kreisel.simulate.effects.turn_on_bias import TurnOnBias
from kreisel.simulate.effects.white_noise import WhiteNoise
from kreisel.simulate.many import ROWS, Abreast

SENSORS = ("gyro", "accel", "mag_uT")
MOTION = figure_eight(period=8.0).sample(np.arange(1100) / 200.0)
WHITE = Imu(
    mount=Mount(p_BS=[0.1, 0.0, -0.05], name="wrist"),
    gyro_effects=[WhiteNoise(1e-3)],
    accel_effects=[WhiteNoise(2e-3)],
    mag_effects=[WhiteNoise(0.1)],
    environment=Environment(field_N_uT=[0.0, 18.5, -45.0]),
)
IMUS = {
    "white noise": WHITE,
    "one sensor without errors": replace(WHITE, accel_effects=[]),
    "two noises": replace(WHITE, gyro_effects=[WhiteNoise(1e-3), WhiteNoise(1e-4, name="more")]),
    "other effects": replace(WHITE, gyro_effects=[ScaleFactor(0.01), TurnOnBias(0.1), WhiteNoise(1e-3)]),
    "no magnetometer": replace(WHITE, mag_effects=[], environment=Environment()),
    "a slow magnetometer": replace(WHITE, clock=Clock(mag=Sampling(rate=60.0))),
    "lost samples": replace(WHITE, clock=Clock(loss=0.1)),
}


@pytest.mark.parametrize("name", IMUS)
@pytest.mark.parametrize("samples", [64, 500, 2000])
def test_runs_abreast_have_the_bits_of_runs_alone(name: str, samples: int) -> None:
    imu = IMUS[name]
    ideal = imu.ideal(MOTION)
    draws = [(7, run) for run in range(LANES - 1)] + [(8, 0)]
    room = np.empty((samples, ROWS, LANES))
    abreast = Abreast(imu, MOTION, ideal, samples)
    # Twice: what runs share does not wear out.
    for _ in range(2):
        blocks = [(rows, readings.copy()) for rows, readings in abreast.read(draws, room)]
    assert [rows.start for rows, _ in blocks] == list(range(0, len(MOTION), samples))
    readings = np.concatenate([block for _, block in blocks])
    for lane, (seed, run) in enumerate(draws):
        measured = imu.record(MOTION, seed, run).measured
        for k, sensor in enumerate(SENSORS):
            alone = getattr(measured, sensor)
            expected = np.full((len(MOTION), 3), np.nan) if alone is None else alone
            np.testing.assert_array_equal(readings[:, 3 * k : 3 * k + 3, lane], expected, err_msg=sensor)
