"""Turns one block of motion after the other into what an IMU records, with the bits of a recording in one piece."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from kreisel.data.checks import Array, choice, read_only
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.tables import CONSTANTS
from kreisel.maths.random import stream
from kreisel.simulate.chain import BLOCK, Felt, Sensed, sense
from kreisel.simulate.clock import Sampling, SoFar, count, part, spread, steps
from kreisel.simulate.context import Context
from kreisel.simulate.effects import Effect
from kreisel.simulate.effects.white_noise import WhiteNoise
from kreisel.simulate.recorded import Recorded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kreisel.simulate.imu import Imu

SENSORS = ("gyro", "accel", "mag_uT")


@dataclass(slots=True)
class _Channel:
    """One sensor of the IMU: what acts on it, and how far it has come."""

    effects: Sequence[Effect]
    sampling: Sampling
    states: list[Array] = field(default_factory=list)
    count: int = 0  # samples so far
    last: float | None = None  # s, time of the last of them

    def copy(self) -> _Channel:
        """The same, to go on from twice."""
        return replace(self, states=[state.copy() for state in self.states])


class Session:
    """An IMU that is recording."""

    def __init__(self, imu: Imu, seed: int, run: int, step: float | None = None) -> None:
        self._imu, self._seed, self._run, self._step = imu, seed, run, step
        self._so_far: SoFar | None = None
        self._noises: dict[str, Array] = {}
        self._channels = {sensor: _Channel(*parts_of(imu, sensor)) for sensor in SENSORS}

    def record(self, motion: Motion, ideal: ImuRecording | None = None) -> Recorded[ImuRecording]:
        """What is read at the times of `motion`, which follows that of the call before; `ideal` where it is known."""
        imu, so_far = self._imu, self._so_far
        ideal = imu.ideal(motion) if ideal is None else ideal
        sensors = [sensor for sensor in SENSORS if getattr(ideal, sensor) is not None]
        before = {sensor: self._channels[sensor].copy() for sensor in sensors}
        sensed = {
            sensor: self._sense(sensor, self._channels[sensor], motion, ideal, so_far) for sensor in sensors
        }
        clock_stream = stream(self._seed, self._run, imu.mount.name, "clock")
        first, begin = (0, float(motion.t[0])) if so_far is None else so_far[:2]
        lost = imu.clock.lost(len(motion), clock_stream, first)
        for each in sensed.values():
            each.reading[lost] = np.nan
        self._noises = self._noises or self._white_noises(motion, sensors)
        self._so_far = SoFar(first + len(motion), begin, float(motion.t[-1]))
        return Recorded(
            measured=ImuRecording(
                t=read_only(imu.clock.stamps(motion.t, clock_stream, so_far)),
                **{sensor: read_only(each.reading) for sensor, each in sensed.items()},
                t0_ns=motion.t0_ns,
                name=imu.mount.name,
                **self._noises,
            ),
            ideal=ideal,
            gyro_bias=read_only(sensed["gyro"].bias),
            accel_bias=read_only(sensed["accel"].bias),
            disturbance_N_uT=self._disturbance(motion),
            temperature_degC=None if imu.temperature is None else read_only(imu.temperature.at(motion.t)),
            seed=self._seed,
            run=self._run,
            replay=partial(self._errors, before, motion, ideal, so_far),
        )

    def _disturbance(self, motion: Motion) -> Array | None:
        world = self._imu.environment
        if not world.disturbances:
            return None
        p_NS = motion.p_NB + motion.R_NB @ self._imu.mount.p_BS
        return read_only(world.disturbance_N_uT(motion.t, p_NS))

    def _errors(
        self,
        before: Mapping[str, _Channel],
        motion: Motion,
        ideal: ImuRecording,
        so_far: SoFar | None,
        sensor: str,
    ) -> dict[str, Array]:
        channel = before[choice("sensor", sensor, list(before))].copy()
        rows = channel.sampling.rows(motion.t, so_far)
        errors = {effect.name: np.zeros((count(rows), 3)) for effect in channel.effects}
        self._sense(sensor, channel, motion, ideal, so_far, errors)
        return {name: spread(added, rows, len(motion)) for name, added in errors.items()}

    def _sense(
        self,
        sensor: str,
        channel: _Channel,
        motion: Motion,
        ideal: ImuRecording,
        so_far: SoFar | None,
        errors: Mapping[str, Array] | None = None,
    ) -> Sensed:
        """What one sensor reads; its channel moves on to the end of the motion."""
        felt = felt_by(channel.sampling, sensor, motion, ideal, so_far, channel.last)
        stream_of = partial(stream, self._seed, self._run, f"{self._imu.mount.name}/{sensor}")
        contexts = contexts_of(self._imu, sensor, motion, felt, channel.count)
        sensed = sense(channel.effects, felt.reading, contexts, stream_of, errors, channel.states)
        channel.count += len(felt.reading)
        channel.last = float(motion.t[felt.rows][-1]) if len(felt.reading) else channel.last
        return Sensed(*(spread(column, felt.rows, len(motion)) for column in sensed))

    def _white_noises(self, motion: Motion, sensors: Sequence[str]) -> dict[str, Array]:
        """Deviations (3,) of the white noise in one sample at the median step, of the sensors that have some."""
        noises = {}
        for name, sensor in zip(CONSTANTS, SENSORS, strict=True):
            channel = self._channels[sensor]
            densities = [effect.density for effect in channel.effects if isinstance(effect, WhiteNoise)]
            if sensor in sensors and np.any(densities):
                step = self._step or np.median(steps(motion.t[channel.sampling.rows(motion.t)]))
                noises[name] = np.linalg.norm(densities, axis=0) / np.sqrt(step)
        return noises


def parts_of(imu: Imu, sensor: str) -> tuple[Sequence[Effect], Sampling]:
    """The effects of one sensor, and when it samples."""
    name = sensor.removesuffix("_uT")
    return getattr(imu, f"{name}_effects"), getattr(imu.clock, name)


def felt_by(
    sampling: Sampling,
    sensor: str,
    motion: Motion,
    ideal: ImuRecording,
    so_far: SoFar | None = None,
    last: float | None = None,
) -> Felt:
    """What a sensor that samples so hands on to its effects; `last` is the time of its sample before, s."""
    rows = sampling.rows(motion.t, so_far)
    reading = sampling.collect(motion.t, getattr(ideal, sensor), rows)
    return Felt(reading, rows, steps(motion.t[rows], last), ideal.accel[rows])


def contexts_of(
    imu: Imu, sensor: str, motion: Motion, felt: Felt, count: int = 0, block: int = BLOCK
) -> Iterator[Context]:
    """What surrounds the blocks of what one sensor has felt, of which came `count` before."""
    t = motion.t[felt.rows]
    for rows in blocks(len(t), block):
        yield Context(
            sensor=sensor,
            first=count + rows.start,
            t=t[rows],
            dt=felt.dt[rows],
            specific_force=felt.force[rows],
            environment=imu.environment,
            mount=imu.mount,
            body=motion,
            rows=part(felt.rows, rows),
            history=imu.temperature,
            averaged=felt.averaged,
        )


def blocks(n: int, size: int = BLOCK) -> Iterator[slice]:
    """Rows of n samples, so many at a time that they fit the second-level cache with what is made of them."""
    return (slice(first, min(first + size, n)) for first in range(0, n, size))
