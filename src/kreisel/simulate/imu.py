"""Turns the motion of a body into what an IMU mounted on it reads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
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
from kreisel.data.temperature import TemperatureHistory
from kreisel.maths.kinematics import specific_force, specific_force_sigma
from kreisel.maths.random import seed_from, stream
from kreisel.maths.turning import felt_acceleration, felt_rate
from kreisel.simulate.chain import Felt, Sensed, checked_effects, sense
from kreisel.simulate.clock import Clock
from kreisel.simulate.effects import Effect
from kreisel.simulate.increments import added_up, ideal_increments
from kreisel.simulate.recorded import Recorded
from kreisel.simulate.session import SENSORS, Session, blocks, contexts_of

if TYPE_CHECKING:
    from kreisel.data.noise import NoiseModel
    from kreisel.simulate.datasheet import Triads

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
        for rows in blocks(len(motion)):
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
        for rows in blocks(len(motion)):
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
        return Session(self, seed_from(rng), whole_number("run", run)).record(motion, ideal)

    def record_long(
        self,
        motions: Iterable[Motion],
        rng: int | np.random.Generator,
        run: int = 0,
        *,
        step: float | None = None,
    ) -> Iterator[Recorded]:
        """What `record` gives for a motion that comes in blocks, block by block, in memory that does not grow.

        motions : pieces of one motion, one after the other, the first with two samples of each sensor; a generator
            may make them, as in ``(path.sample(t) for t in pieces)``. Each is recorded before the next is asked for.
        step : s, the median step of the whole motion, from which gyro_noise, accel_noise and mag_noise_uT follow;
            that of the first block where it is left out. All else has the bits of the whole.
        Raises ValueError as `record` does, where blocks do not follow each other, and for a clock with latency or
        window, which looks back beyond a block.
        """
        if self.clock.looks_back:
            raise ValueError(
                "a clock with latency or window looks back beyond a block. Record in one piece, with record()."
            )
        session, last = Session(self, seed_from(rng), whole_number("run", run), step), -np.inf
        for k, motion in enumerate(motions):
            self._check(motion, fewest=1 if k else 2)
            if not motion.t[0] > last:
                raise ValueError(
                    f"blocks must follow each other in time; one begins at {motion.t[0]:.9g} s, not after {last:.9g} s."
                )
            last = float(motion.t[-1])
            yield session.record(motion)

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

    def _errors_of_sums(
        self, motion: Motion, ideal: ImuIncrements, seed: int, run: int, sensor: str
    ) -> dict[str, Array]:
        effects = self._effects(_SUMS[choice("sensor", sensor, list(_SUMS))])
        errors = {effect.name: np.zeros((len(ideal), 3)) for effect in effects}
        self._sense(_SUMS[sensor], motion, ideal, seed, run, errors)
        dt = np.diff(motion.t)[:, None]
        return {name: added * dt for name, added in errors.items()}

    def _sense(
        self,
        sensor: str,
        motion: Motion,
        ideal: ImuIncrements,
        seed: int,
        run: int,
        errors: Mapping[str, Array] | None = None,
    ) -> Sensed:
        """Means over the intervals as `sensor` has them."""
        means, ends = ideal.mean_rates(), slice(1, len(motion))
        dt = read_only(np.diff(motion.t))
        felt = Felt(getattr(means, sensor), ends, dt, means.accel, averaged=True)
        stream_of = partial(stream, seed, run, f"{self.mount.name}/{sensor}")
        contexts = contexts_of(self, sensor, motion, felt)
        return sense(self._effects(sensor), felt.reading, contexts, stream_of, errors)

    def _effects(self, sensor: str) -> Sequence[Effect]:
        return self.gyro_effects if sensor == "gyro" else self.accel_effects

    def _check_motion(self, motion: Motion) -> None:
        instance("motion", motion, Motion, "A trajectory's sample(t) gives one.")
        far = float(np.abs(motion.p_NB).max(initial=0.0))
        if self.environment.omega_IN_N.any() and far > FARTHEST:
            raise ValueError(
                f"p_NB lies up to {far:.3g} m from the origin of N, which is a place on the turning Earth; N is flat, "
                f"with one gravity, and ends after {FARTHEST:.0e} m. Subtract the place from the positions."
            )

    def _check(self, motion: Motion, fewest: int = 2) -> None:
        self._check_motion(motion)
        if len(motion) < fewest:
            raise ValueError(
                f"a recording needs two samples or more, for noise depends on the time between them; got {len(motion)}."
            )
        if self.temperature is not None:
            self.temperature.check_covers(*motion.t[[0, -1]])
