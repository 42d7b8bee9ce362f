"""Turns a Motion into a GIF of the body moving along its path, with the readings of its IMU beside it."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording

MOST_FRAMES = 1200
"""More would take minutes, and some 20 MB."""

# Viewers slow a GIF with shorter delays down to ten frames a second.
_SHORTEST_DELAY_CS = 2


def animate(
    motion: Motion,
    mounts: Sequence[Mount],
    path: str | os.PathLike[str],
    *,
    recording: ImuRecording | None = None,
    fps: float = 25.0,
    speed: float = 1.0,
) -> Path:
    """Write a GIF of the body moving along its path to `path`, a fading trail behind it.

    The body is a red wedge, nose along x_B, drawn larger than life; its centre of mass is yellow, each of
    `mounts` violet and truly where it is. With `recording`, its gyro and accelerometer run along beside it.
    `speed` is seconds of motion for each second of film: 0.2 is slow motion. A GIF counts its delays in
    hundredths of a second, so `fps` is taken to the nearest rate with a whole number of them, 50 at most; the
    body moves at `speed` all the same.

    The file appears under its name only when it is complete. Raises ValueError for a suffix other than .gif,
    a motion without samples, fps or speed that are not positive, and more than 1200 frames; OSError for a place
    that cannot be written.
    """
    from kreisel.show.film import COLOURS, Film
    from kreisel.show.gif import shared_palette, write_gif
    from kreisel.show.saving import drawn_whole, writable

    target = writable(path, (".gif",))
    rows, delay_cs = film_rows(motion, fps, speed)
    film = Film(motion, mounts, recording)
    samples = [film.picture(row) for row in rows[np.linspace(0, len(rows) - 1, 8).astype(int)]]
    with drawn_whole(target) as drawing:
        write_gif(drawing, (film.picture(row) for row in rows), shared_palette(samples, COLOURS), delay_cs)
    return target


def film_rows(motion: Motion, fps: float, speed: float) -> tuple[npt.NDArray[np.intp], int]:
    """The row of `motion` each frame shows, nearest to its time, and the delay between frames in 1/100 s."""
    if not len(motion):
        raise ValueError("The motion has no samples, so nothing moves; sample it at one time or more.")
    for name, value in (("fps", fps), ("speed", speed)):
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} must be a positive number; got {value!r}.")
    delay_cs = max(_SHORTEST_DELAY_CS, round(100.0 / fps))
    step = 0.01 * delay_cs * speed
    span = float(motion.t[-1] - motion.t[0])
    # Round-off in the span must not cost the last frame.
    count = int(span / step + 1e-6) + 1
    if count > MOST_FRAMES:
        enough = math.ceil(10.0 * speed * count / MOST_FRAMES) / 10.0
        raise ValueError(
            f"{span:.6g} s of motion at fps={fps:g} and speed={speed:g} take {count} frames; "
            f"{MOST_FRAMES} are the most. Set speed={enough:g} or more, or give a part of the motion."
        )
    times = motion.t[0] + step * np.arange(count)
    after = np.clip(np.searchsorted(motion.t, times), 1, max(len(motion) - 1, 1))
    before_is_nearer = times - motion.t[after - 1] <= motion.t[np.minimum(after, len(motion) - 1)] - times
    return np.where(before_is_nearer, after - 1, np.minimum(after, len(motion) - 1)), delay_cs
