"""Turns a real recording and the trajectory it was made on into what stands between it and its simulated twin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kreisel.data.checks import Array, instance, read_only, scalar
from kreisel.data.environment import Environment
from kreisel.data.motion import Mount, Note
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Trajectory
from kreisel.evaluate.align.alignment import Alignment, SensorAlignment, compared, correlated
from kreisel.evaluate.align.confirmed import ALL, Confirmed, confirmed
from kreisel.evaluate.align.model import SENSORS, Scene, expected_readings
from kreisel.evaluate.align.parameters import DEFAULT, NEED_MOTION, Parameters, slots_of
from kreisel.evaluate.align.solve import Solution, solve, turned_back
from kreisel.evaluate.align.start import rough_start, strangers
from kreisel.evaluate.align.unseen import unseen_sentences

__all__ = ["Alignment", "SensorAlignment", "align"]

_ROUNDS = 4

# Correlation of all axes together that one sensor must reach: strangers that are laid over each other stay under 0.3.
_ALIKE = 0.5


def align(
    recording: ImuRecording,
    trajectory: Trajectory,
    *,
    estimate: Sequence[str] = DEFAULT,
    mount: Mount | None = None,
    environment: Environment | None = None,
    search: float = 0.5,
) -> Alignment:
    """Where on the body that moved along `trajectory` the IMU sat, how it was turned, and what is wrong with it.

    Least squares of the readings, both sensors at once, each weighted by its residual (Gauss-Newton).
    estimate : any of "rotation", "lever_arm", "gyro_bias", "accel_bias", "gyro_scale", "accel_scale", "gyro_clock",
        "accel_clock", "drift" (of the clock, common to both), "tilt" (of the trajectory's frame against gravity);
        empty to compare as it is. The default leaves out scale, drift and tilt.
    mount : lever arm and rotation as far as known; what is not estimated stays so. An estimated rotation needs no
        start: it may be any.
    environment : gravity; the standard one by default.
    search : s, how far the clocks may be apart.

    A direction that the motion does not show stays as it was given; its errors are infinite and a note names it.
    Raises TypeError for other types; ValueError for names that are none, no overlap in time, too little motion, a
    recording that does not show the trajectory's motion, and fewer than 50 samples.
    """
    scene = _scene(recording, trajectory, environment or Environment())
    estimate = (estimate,) if isinstance(estimate, str) else tuple(estimate)
    slots = slots_of(estimate)
    mount = mount or Mount(name=recording.name or "imu")
    start = Parameters(R_BS=mount.R_BS, lever_arm=mount.p_BS)
    moving = bool(NEED_MOTION & set(slots))
    if moving:
        scene, start = _moving_start(scene, start, set(slots), scalar("search", search, "s", 0.0))
    scene, found = _solved(scene, start, slots, mount.R_BS)
    at = found.parameters
    twin = {sensor: read_only(expected_readings(scene, sensor, at)) for sensor in SENSORS}
    if moving and max(correlated(scene.readings[sensor], twin[sensor]) for sensor in SENSORS) < _ALIKE:
        raise ValueError(strangers(search))
    errors = {name: read_only(found.errors[s]) for name, s in slots.items()}
    return Alignment(
        mount=Mount(at.lever_arm, at.R_BS, mount.name),
        gyro=_sensor(scene, "gyro", found, twin["gyro"]),
        accel=_sensor(scene, "accel", found, twin["accel"]),
        drift=float(at.drift[0]),
        start=float(recording.t[0]),
        tilt=read_only(at.tilt),
        errors=errors,
        twin=ImuRecording(recording.t, **twin, t0_ns=recording.t0_ns, name=recording.name),
        notes=_notes(found, slots),
    )


def _scene(recording: ImuRecording, trajectory: Trajectory, environment: Environment) -> Scene:
    instance("recording", recording, ImuRecording, "kreisel.read gives one.")
    if not isinstance(trajectory, Trajectory):
        raise TypeError(
            f"trajectory must have a span and sample(t); got {type(trajectory).__name__}. "
            "SampledTrajectory.from_poses makes one of poses."
        )
    if not len(recording):
        raise ValueError("the recording has no samples; there is nothing to align.")
    # Epochs are subtracted as integers: as floats they would be rounded to 128 ns.
    stamps = recording.t + (recording.t0_ns - _epoch(trajectory, recording)) / 1e9
    gravity = float(np.linalg.norm(environment.g_N))
    down = environment.g_N / gravity if gravity > 0.0 else np.zeros(3)
    readings = {"gyro": recording.gyro, "accel": recording.accel}
    return Scene(stamps, readings, trajectory, gravity, down)


def _epoch(trajectory: Trajectory, recording: ImuRecording) -> int:
    """t0_ns of the motions that the trajectory gives."""
    first, last = trajectory.span
    return trajectory.sample(np.clip(recording.t[:1], first, last)).t0_ns


def _moving_start(
    scene: Scene, given: Parameters, names: set[str], search: float
) -> tuple[Scene, Parameters]:
    """The scene with what of its motion is confirmed, and parameters near enough for least squares."""
    clocks = names & {"gyro_clock", "accel_clock"}
    rough = rough_start(scene, given.R_BS, turned="rotation" in names, search=search if clocks else 0.0)
    changes: dict[str, Array] = {name: np.array([rough.clock]) for name in clocks}
    return scene._replace(confirmed=rough.confirmed), replace(given, R_BS=rough.R_BS, **changes)


def _solved(
    scene: Scene, start: Parameters, slots: Mapping[str, slice], given: Array
) -> tuple[Scene, Solution]:
    """Least squares, and again where its answer changes what it rested on."""
    found = solve(scene, start, slots)
    for _ in range(_ROUNDS):
        turned, rank = turned_back(found, slots, given), scene.confirmed.rank
        if rank != ALL.rank:
            # A lever arm, once known, can explain forces that no motion of the body's origin did.
            scene = scene._replace(confirmed=_confirmed(scene, found.parameters))
        if turned is found.parameters and scene.confirmed.rank == rank:
            break
        found = solve(scene, turned, slots)
    return scene, found


def _confirmed(scene: Scene, at: Parameters) -> Confirmed:
    read: dict[str, Array] = {}
    seen: dict[str, Array] = {}
    for sensor in SENSORS:
        expected, readings = expected_readings(scene, sensor, at), scene.readings[sensor]
        both = np.isfinite(expected).all(axis=1) & np.isfinite(readings).all(axis=1)
        for side, values in ((read, readings), (seen, expected)):
            truth = (values[both] - getattr(at, f"{sensor}_bias")) / getattr(at, f"{sensor}_scale")
            side[sensor] = truth @ at.R_BS.T
    return confirmed(read, seen)


def _sensor(scene: Scene, sensor: str, found: Solution, twin: Array) -> SensorAlignment:
    at = found.parameters
    return SensorAlignment(
        read_only(getattr(at, f"{sensor}_bias")),
        read_only(getattr(at, f"{sensor}_scale")),
        float(getattr(at, f"{sensor}_clock")[0]),
        *compared(scene.readings[sensor], twin),
        effective_samples=found.effective[sensor],
    )


def _notes(found: Solution, slots: Mapping[str, slice]) -> tuple[Note, ...]:
    notes = [Note("unseen", text) for text in unseen_sentences(found.unseen, slots)]
    if not found.settled:
        notes.append(
            Note("unsettled", "least squares did not settle: the numbers are those of its last step.")
        )
    return tuple(notes)
