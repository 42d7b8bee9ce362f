"""Turns the motion of a body into what an IMU mounted on it reads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from kreisel.data.cards import Shown
from kreisel.data.checks import Array, choice, instance, read_only, whole_number
from kreisel.data.environment import Environment
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.data.tables import CONSTANTS
from kreisel.data.temperature import TemperatureHistory
from kreisel.maths.kinematics import specific_force, specific_force_sigma
from kreisel.maths.random import seed_from, stream
from kreisel.maths.turning import felt_acceleration, felt_rate
from kreisel.simulate.chain import BLOCK, Felt, Sensed, checked_effects, sense
from kreisel.simulate.clock import Clock, Sampling, count, part, spread, steps
from kreisel.simulate.context import Context
from kreisel.simulate.effects import Effect
from kreisel.simulate.effects.white_noise import WhiteNoise
from kreisel.simulate.increments import added_up, ideal_increments
from kreisel.simulate.recorded import Recorded

if TYPE_CHECKING:
    from kreisel.data.noise import NoiseModel
    from kreisel.simulate.datasheet import Triads

SENSORS = ("gyro", "accel", "mag_uT")

# Increments are sums of what these read.
_SUMS = MappingProxyType({"dtheta": "gyro", "dv": "accel"})

# m; there the plumb line leans by 1 deg against that of the origin, 300 times what the centrifugal term varies.
FARTHEST = 1e5


@dataclass(frozen=True, slots=True, eq=False)
class Imu(Shown):
    """An inertial measurement unit at a place on the body.

    The effects of a sensor act in the order given, from the outer world to the output: commonly
    misalignment, scale, biases, noise, bandwidth, range, quantisation.
    """

    mount: Mount = field(default_factory=Mount)
    gyro_effects: Sequence[Effect] = ()
    accel_effects: Sequence[Effect] = ()
    mag_effects: Sequence[Effect] = ()
    environment: Environment = field(default_factory=Environment)
    clock: Clock = field(default_factory=Clock)
    temperature: TemperatureHistory | None = None

    def __post_init__(self) -> None:
        instance("mount", self.mount, Mount, "Write Mount(p_BS=[x, y, z]).")
        instance("environment", self.environment, Environment, "Write Environment(...).")
        instance("clock", self.clock, Clock, "Write Clock(jitter=1e-4), say.")
        if self.temperature is not None:
            instance(
                "temperature", self.temperature, TemperatureHistory, "Write TemperatureHistory(t, degC)."
            )
        for name in ("gyro_effects", "accel_effects", "mag_effects"):
            object.__setattr__(self, name, checked_effects(name, getattr(self, name)))
        if self.mag_effects and self.environment.field_N_uT is None:
            raise ValueError(
                "mag_effects need a magnetic field to act on; give environment=Environment(field_N_uT=...)."
            )

    @classmethod
    def from_datasheet(
        cls,
        *,
        mount: Mount | None = None,
        environment: Environment | None = None,
        clock: Clock | None = None,
        temperature: TemperatureHistory | None = None,
        **values: Any,
    ) -> Imu:
        """An IMU from the numbers of its datasheet, each under a name that wears its unit.

        As in gyro_noise_deg_per_s_rthz=0.014, accel_noise_ug_rthz=175, gyro_range_deg_per_s=2000; all names are
        in `kreisel.simulate.datasheet.PARAMETERS` and docs/datasheets.md. What is not given is perfect.
        Raises ValueError for unknown names, for two that say the same and for values that cannot be.
        """
        from kreisel.simulate.datasheet import triads

        return cls._of(triads(values), mount, environment, clock, temperature)

    @classmethod
    def from_preset(
        cls,
        name: str,
        *,
        mount: Mount | None = None,
        environment: Environment | None = None,
        clock: Clock | None = None,
        temperature: TemperatureHistory | None = None,
        **values: Any,
    ) -> Imu:
        """The IMU of a datasheet that comes along, such as "bmi088", or of a preset file "mine.toml".

        values: numbers as `from_datasheet` takes them, in place of the preset's or beside them.
        Its magnetometer reads where `environment` has a field; one without a magnetometer then has a perfect one.

        Raises ValueError with the nearest name where there is no such preset, and as `from_datasheet` does.
        """
        from kreisel.simulate.datasheet import completed, triads
        from kreisel.simulate.presets import load

        made = triads(completed(load(name).values, values))
        return cls._of(made, mount, environment, clock, temperature)

    @classmethod
    def from_noise(
        cls,
        gyro: NoiseModel,
        accel: NoiseModel,
        *,
        mount: Mount | None = None,
        environment: Environment | None = None,
        clock: Clock | None = None,
        temperature: TemperatureHistory | None = None,
    ) -> Imu:
        """An IMU with the noise of a gyroscope (rad/s) and an accelerometer (m/s^2), and no other errors."""
        from kreisel.simulate.datasheet import Triads
        from kreisel.simulate.triad import Triad

        triads = Triads(Triad(gyro), Triad(accel), Triad())
        return cls._of(triads, mount, environment, clock, temperature)

    @classmethod
    def _of(
        cls,
        triads: Triads,
        mount: Mount | None,
        environment: Environment | None,
        clock: Clock | None,
        temperature: TemperatureHistory | None,
    ) -> Imu:
        environment = environment or Environment()
        in_a_field = environment.field_N_uT is not None
        return cls(
            mount or Mount(),
            triads.gyro.effects(),
            triads.accel.effects(),
            triads.mag.effects() if in_a_field else (),
            environment=environment,
            clock=clock or Clock(),
            temperature=temperature,
        )

    def ideal(self, motion: Motion) -> ImuRecording:
        """What a perfect IMU at the mount reads at the times of `motion`; with a field around it, a magnetometer too.

        Where the motion knows its standard errors, so does the reading.

        Source: document 000, eq. (9), with the specific force R_SN (a_N - g_N) for its a_S. Where the environment
        turns N, the gyroscope reads that rate too, and Coriolis and the centrifugal term are in a_N
        (kreisel.maths.turning). Raises ValueError then for a motion that leaves the 100 km around the origin, and
        for one that runs into a magnet.
        """
        self._check_motion(motion)
        field_N_uT, turn = self.environment.field_N_uT, self.environment.omega_IN_N
        gyro, accel, mag_uT = (np.empty((len(motion), 3)) for _ in SENSORS)
        for rows in _blocks(len(motion)):
            at_sensor = motion.rows(rows).at(self.mount)
            gyro[rows] = felt_rate(at_sensor.omega_NB_B, at_sensor.R_NB, turn)
            a_N = felt_acceleration(at_sensor.a_NB, at_sensor.v_NB, at_sensor.p_NB, turn)
            accel[rows] = specific_force(a_N, at_sensor.R_NB, self.environment.g_N)
            if field_N_uT is not None:
                mag_uT[rows] = self._field_in_S(field_N_uT, at_sensor)
        gyro_sigma, accel_sigma = self._sigmas(motion, accel)
        return ImuRecording(
            t=motion.t,
            gyro=read_only(gyro),
            accel=read_only(accel),
            mag_uT=None if field_N_uT is None else read_only(mag_uT),
            t0_ns=motion.t0_ns,
            name=self.mount.name,
            gyro_sigma=gyro_sigma,
            accel_sigma=accel_sigma,
        )

    def _field_in_S(self, field_N_uT: Array, at_sensor: Motion) -> Array:
        in_S = field_N_uT @ at_sensor.R_NB  # R_SN field, row by row
        if self.environment.disturbances:
            added = self.environment.disturbance_N_uT(at_sensor.t, at_sensor.p_NB)
            in_S += np.einsum("nji,nj->ni", at_sensor.R_NB, added)
        return np.asarray(in_S)

    def _sigmas(self, motion: Motion, accel: Array) -> tuple[Array | None, Array | None]:
        """Standard errors of the ideal reading, where those of the motion are known."""
        if motion.uncertainty is None:
            return None, None
        gyro_sigma, accel_sigma = np.empty((2, len(motion), 3))
        place = self.mount.p_BS, self.mount.R_BS
        for rows in _blocks(len(motion)):
            body = motion.rows(rows)
            known = body.uncertainty
            assert known is not None  # as that of the whole
            gyro_sigma[rows] = np.sqrt(np.square(known.omega) @ np.square(self.mount.R_BS))
            accel_sigma[rows] = specific_force_sigma(accel[rows], place, body.R_NB, body.omega_NB_B, known)
        return read_only(gyro_sigma), read_only(accel_sigma)

    def increments(self, motion: Motion) -> ImuIncrements:
        """What a perfect IMU at the mount adds up between the times of `motion`: coning and sculling are in it.

        From attitude, velocity and position at both ends of each interval, not from rates: as exact as these.
        """
        self._check_motion(motion)
        return ideal_increments(motion.at(self.mount), self.environment, self.mount.name)

    def record(
        self,
        motion: Motion,
        rng: int | np.random.Generator,
        run: int = 0,
        *,
        ideal: ImuRecording | None = None,
    ) -> Recorded[ImuRecording]:
        """What this IMU reads at the times of `motion`, with its biases and, when asked for, every error it made.

        rng: a seed, or a generator to draw one from. run: its number in an ensemble of one seed. ideal: known before.
        Every effect draws from a stream of its own, keyed by seed, run, name of the mount, sensor and name
        of the effect: adding, dropping or moving one leaves the numbers of the others alone.

        Raises ValueError for fewer than two samples, a temperature history that is shorter than the motion,
        and effects that do not suit their sensor.
        """
        self._check(motion)
        seed, run = seed_from(rng), whole_number("run", run)
        ideal = self.ideal(motion) if ideal is None else ideal
        there = [sensor for sensor in SENSORS if getattr(ideal, sensor) is not None]
        sensed = {sensor: self._sense(sensor, motion, ideal, seed, run) for sensor in there}
        clock_stream = stream(seed, run, self.mount.name, "clock")
        lost = self.clock.lost(len(motion), clock_stream)
        for each in sensed.values():
            each.reading[lost] = np.nan
        return Recorded(
            measured=ImuRecording(
                t=read_only(self.clock.stamps(motion.t, clock_stream)),
                **{sensor: read_only(each.reading) for sensor, each in sensed.items()},
                t0_ns=motion.t0_ns,
                name=self.mount.name,
                **self._noises(motion, ideal),
            ),
            ideal=ideal,
            gyro_bias=read_only(sensed["gyro"].bias),
            accel_bias=read_only(sensed["accel"].bias),
            disturbance_N_uT=self._disturbance(motion),
            temperature_degC=None if self.temperature is None else read_only(self.temperature.at(motion.t)),
            seed=seed,
            run=run,
            replay=partial(self._errors, motion, ideal, seed, run),
        )

    def record_increments(
        self, motion: Motion, rng: int | np.random.Generator, run: int = 0
    ) -> Recorded[ImuIncrements]:
        """What this IMU delivers where it adds up inside: the increments between the times of `motion`, with errors.

        The mean rate and the mean specific force of every interval go through the same effects as the samples of
        `record`, with draws addressed alike, and are multiplied by its length again: white noise of density N makes
        an angle random walk of N sqrt(t), and what is drawn once per run is what `record` draws with that seed.
        Vibration is averaged over each interval. Range and Quantisation act on the means,
        IncrementQuantisation on the sums. With an error in them increments have no dp, as nothing measures it.
        A magnetometer has no increments: what it would read is left out.

        Raises ValueError as `record` does, and for a clock by which a sensor has a rate, a latency or a window.
        """
        self._check(motion)
        self.clock.check_contiguous()
        seed, run = seed_from(rng), whole_number("run", run)
        ideal = self.increments(motion)
        gyro, accel = (self._sense(sensor, motion, ideal, seed, run) for sensor in _SUMS.values())
        clock_stream = stream(seed, run, self.mount.name, "clock")
        stamps = self.clock.stamps(motion.t, clock_stream)
        lost = self.clock.lost(len(ideal), clock_stream)
        exact = all(effect.idle for effect in (*self.gyro_effects, *self.accel_effects))
        return Recorded(
            measured=added_up(ideal, gyro.reading, accel.reading, stamps, lost, exact),
            ideal=ideal,
            gyro_bias=read_only(gyro.bias),
            accel_bias=read_only(accel.bias),
            seed=seed,
            run=run,
            replay=partial(self._errors_of_sums, motion, ideal, seed, run),
        )

    def _disturbance(self, motion: Motion) -> Array | None:
        if not self.environment.disturbances:
            return None
        p_NS = motion.p_NB + motion.R_NB @ self.mount.p_BS
        return read_only(self.environment.disturbance_N_uT(motion.t, p_NS))

    def _errors(
        self, motion: Motion, ideal: ImuRecording, seed: int, run: int, sensor: str
    ) -> dict[str, Array]:
        choice("sensor", sensor, [name for name in SENSORS if getattr(ideal, name) is not None])
        effects, sampling = self._parts(sensor)
        rows = sampling.rows(motion.t)
        errors = {effect.name: np.zeros((count(rows), 3)) for effect in effects}
        self._sense(sensor, motion, ideal, seed, run, errors)
        return {name: spread(added, rows, len(motion)) for name, added in errors.items()}

    def _errors_of_sums(
        self, motion: Motion, ideal: ImuIncrements, seed: int, run: int, sensor: str
    ) -> dict[str, Array]:
        effects, _ = self._parts(_SUMS[choice("sensor", sensor, list(_SUMS))])
        errors = {effect.name: np.zeros((len(ideal), 3)) for effect in effects}
        self._sense(_SUMS[sensor], motion, ideal, seed, run, errors)
        dt = np.diff(motion.t)[:, None]
        return {name: added * dt for name, added in errors.items()}

    def _sense(
        self,
        sensor: str,
        motion: Motion,
        ideal: ImuRecording | ImuIncrements,
        seed: int,
        run: int,
        errors: Mapping[str, Array] | None = None,
    ) -> Sensed:
        effects, _ = self._parts(sensor)
        felt = self._felt(sensor, motion, ideal)
        stream_of = partial(stream, seed, run, f"{self.mount.name}/{sensor}")
        sensed = sense(effects, felt.reading, self._contexts(sensor, motion, felt), stream_of, errors)
        return Sensed(*(spread(column, felt.rows, len(motion)) for column in sensed))

    def _felt(self, sensor: str, motion: Motion, ideal: ImuRecording | ImuIncrements) -> Felt:
        if isinstance(ideal, ImuIncrements):
            means, ends = ideal.mean_rates(), slice(1, len(motion))
            return Felt(
                getattr(means, sensor), ends, read_only(np.diff(motion.t)), means.accel, averaged=True
            )
        _, sampling = self._parts(sensor)
        rows = sampling.rows(motion.t)
        reading = sampling.collect(motion.t, getattr(ideal, sensor), rows)
        return Felt(reading, rows, steps(motion.t[rows]), ideal.accel[rows])

    def _noises(self, motion: Motion, ideal: ImuRecording) -> dict[str, Array]:
        """Deviations (3,) of the white noise in one sample at the median step, of the sensors that have some."""
        noises = {}
        for name, sensor in zip(CONSTANTS, SENSORS, strict=True):
            effects, sampling = self._parts(sensor)
            densities = [effect.density for effect in effects if isinstance(effect, WhiteNoise)]
            if getattr(ideal, sensor) is not None and np.any(densities):
                step = np.median(steps(motion.t[sampling.rows(motion.t)]))
                noises[name] = np.linalg.norm(densities, axis=0) / np.sqrt(step)
        return noises

    def _parts(self, sensor: str) -> tuple[Sequence[Effect], Sampling]:
        name = sensor.removesuffix("_uT")
        return getattr(self, f"{name}_effects"), getattr(self.clock, name)

    def _contexts(self, sensor: str, motion: Motion, felt: Felt) -> Iterator[Context]:
        t = motion.t[felt.rows]
        for block in _blocks(len(t)):
            yield Context(
                sensor=sensor,
                first=block.start,
                t=t[block],
                dt=felt.dt[block],
                specific_force=felt.force[block],
                environment=self.environment,
                mount=self.mount,
                body=motion,
                rows=part(felt.rows, block),
                history=self.temperature,
                averaged=felt.averaged,
            )

    def _check_motion(self, motion: Motion) -> None:
        instance("motion", motion, Motion, "A trajectory's sample(t) gives one.")
        far = float(np.abs(motion.p_NB).max(initial=0.0))
        if self.environment.omega_IN_N.any() and far > FARTHEST:
            raise ValueError(
                f"p_NB lies up to {far:.3g} m from the origin of N, which is a place on the turning Earth; N is flat, "
                f"with one gravity, and ends after {FARTHEST:.0e} m. Subtract the place from the positions."
            )

    def _check(self, motion: Motion) -> None:
        self._check_motion(motion)
        if len(motion) < 2:
            raise ValueError(
                f"a recording needs two samples or more, for noise depends on the time between them; got {len(motion)}."
            )
        if self.temperature is not None:
            self.temperature.check_covers(*motion.t[[0, -1]])


def _blocks(n: int) -> Iterator[slice]:
    return (slice(first, min(first + BLOCK, n)) for first in range(0, n, BLOCK))
