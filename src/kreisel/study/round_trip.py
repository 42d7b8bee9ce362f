"""Turns a recording back into a motion and compares it with the motion the recording was made from."""

from __future__ import annotations

from kreisel.data.environment import Environment
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.estimate.strapdown import integrate
from kreisel.evaluate.motion_errors import MotionErrors, motion_errors


def round_trip(
    recording: ImuRecording | ImuIncrements, truth: Motion, environment: Environment | None = None
) -> MotionErrors:
    """Errors of `recording`, integrated from its first stamp on, against `truth`, the sensor's own motion.

    truth : `motion.at(mount)`, with the same stamps as the recording.
    """
    return motion_errors(truth, integrate(recording, truth, environment))
