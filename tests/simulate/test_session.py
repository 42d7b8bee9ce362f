"""Recording block by block: the bits of the recording in one piece."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest

import kreisel
from kreisel.data.temperature import TemperatureHistory
from kreisel.simulate.clock import Clock, Sampling
from kreisel.simulate.effects.temperature_bias import TemperatureBias
from kreisel.simulate.recorded import Recorded

T = np.arange(20_000) / 400.0
PATH = kreisel.figure_eight(period=8.0)


def imu(clock: Clock | None = None) -> kreisel.Imu:
    """Every effect of a datasheet, at a lever arm, in a field."""
    return kreisel.Imu.from_preset(
        "bmi088",
        mount=kreisel.Mount(p_BS=[0.1, 0.0, -0.05], name="wrist"),
        environment=kreisel.Environment(field_N_uT=[0.0, 18.5, -45.0]),
        clock=clock,
    )


def pieces(cuts: list[int]) -> Iterator[kreisel.Motion]:
    for first, last in pairwise([0, *cuts, len(T)]):
        yield PATH.sample(T[first:last])


def assert_same(blocks: list[Recorded], whole: Recorded) -> None:
    for noun in ("measured", "ideal"):
        for name in ("t", "gyro", "accel", "mag_uT"):
            joined = np.concatenate([getattr(getattr(block, noun), name) for block in blocks])
            np.testing.assert_array_equal(
                joined, getattr(getattr(whole, noun), name), err_msg=f"{noun} {name}"
            )
    for name in ("gyro_bias", "accel_bias"):
        np.testing.assert_array_equal(
            np.concatenate([getattr(b, name) for b in blocks]), getattr(whole, name)
        )
    for sensor in ("gyro", "accel", "mag_uT"):
        errors = [block.errors(sensor) for block in blocks]
        for name, column in whole.errors(sensor).items():
            np.testing.assert_array_equal(
                np.concatenate([each[name] for each in errors]), column, err_msg=name
            )


CLOCKS = {
    "plain": Clock(),
    "own": Clock(offset=1.0, rate_offset=5e-5, jitter=1e-3, loss=0.1),
    "slow": Clock(gyro=Sampling(rate=133.0), mag=Sampling(rate=50.0)),
}


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize("cuts", [[8192, 16384], [50, 51, 7000, 7001, 19_999]])
def test_blocks_have_the_bits_of_the_whole(clock: str, cuts: list[int]) -> None:
    each = imu(CLOCKS[clock])
    whole = each.record(PATH.sample(T), rng=7, run=3)
    assert_same(list(each.record_long(pieces(cuts), rng=7, run=3)), whole)


def test_temperature_goes_on() -> None:
    warming = TemperatureHistory([0.0, 60.0], [20.0, 45.0])
    each = kreisel.Imu(gyro_effects=[TemperatureBias(1e-3)], temperature=warming)
    whole = each.record(PATH.sample(T), rng=1)
    blocks = list(each.record_long(pieces([300, 12_000]), rng=1))
    np.testing.assert_array_equal(np.concatenate([b.measured.gyro for b in blocks]), whole.measured.gyro)


def test_what_cannot_be_is_said() -> None:
    first, second = pieces([10_000])
    with pytest.raises(ValueError, match="follow each other in time"):
        list(imu().record_long([second, first], rng=1))
    with pytest.raises(ValueError, match="looks back beyond a block"):
        list(imu(Clock(gyro=Sampling(latency=0.01))).record_long([first], rng=1))
    with pytest.raises(ValueError, match="two samples or more"):
        list(imu().record_long(pieces([1]), rng=1))
