"""Turns a simulated motion into a folder of files and a short summary that says what is in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kreisel.data.motion import Motion, Mount, Note
from kreisel.files.doors import write

if TYPE_CHECKING:
    from kreisel.data.recording import ImuRecording
    from kreisel.simulate.imu import Imu
    from kreisel.simulate.recorded import Recorded

# Shown of each kind of note; a path with a thousand reversals must not bury the summary.
_NOTES_SHOWN = 4


def write_simulation(
    folder: Path,
    motion: Motion,
    mounts: Sequence[Mount],
    recordings: Sequence[ImuRecording],
    *,
    recorded: Sequence[Recorded] = (),
    world: str = "enu-flu",
    imu_format: str = "csv",
    pictures: bool = True,
    animation: bool = False,
) -> list[str]:
    """Write IMU data, truth and pictures to `folder`; the lines of a summary that names each file.

    recorded: of the recordings with errors, what is known of these; each goes into a file of its own.
    """
    from kreisel.cli.error_terms import write_error_terms
    from kreisel.data.frames import from_enu_flu

    check_names([recording.name for recording in recordings])
    make_folder(folder)
    lines = []
    for recording in recordings:
        path = folder / f"{recording.name}.{_SUFFIX.get(imu_format, imu_format)}"
        write(path, from_enu_flu(recording, world), format=imu_format)
        magnetometer = "" if recording.mag_uT is None else " and magnetometer (uT)"
        sensors = f"gyroscope (rad/s){',' if magnetometer else ' and'} accelerometer (m/s^2){magnetometer}"
        lines.append(f"{path}  {sensors}, {len(recording)} samples")
    for known in recorded:
        path = folder / f"{known.ideal.name}-errors.npz"
        write_error_terms(path, known, world)
        lines.append(f"{path}  its ideal readings, biases and every error term, for numpy.load")
    truth = from_enu_flu(motion, world)
    write(folder / "truth.tum", truth)
    lines.append(f"{folder / 'truth.tum'}  position and attitude of the body, as evo and others read it")
    write(folder / "truth.npz", truth)
    lines.append(f"{folder / 'truth.npz'}  the whole motion, for numpy.load")
    if pictures:
        lines += _draw(folder, motion, mounts, recordings)
    if animation:
        from kreisel.show.animation import animate

        animate(motion, mounts, folder / "motion.gif", recording=recordings[0])
        lines.append(f"{folder / 'motion.gif'}  the body moving along its path, and what it feels")
    return lines


def make_folder(folder: Path) -> None:
    """Make `folder` and those above it; OSError, one sentence, where that cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise type(error)(
            f"cannot make the folder {folder}: {error.strerror}. Choose another with -o."
        ) from None


def check_names(imus: Sequence[str]) -> None:
    """Refuse an IMU whose files would have the names of others."""
    taken = next(
        (name for name in imus if name in _TAKEN or name.removesuffix("-errors") in {*imus} - {name}), None
    )
    if taken is not None:
        raise ValueError(f"an IMU cannot be called {taken!r}: a file of that name is written too.")


_TAKEN = ("truth", "path", "linear", "angular", "motion")

_SUFFIX = {"euroc-imu": "txt"}


def _draw(
    folder: Path, motion: Motion, mounts: Sequence[Mount], recordings: Sequence[ImuRecording]
) -> list[str]:
    from kreisel import show

    figures = {
        "path.png": (show.plot_path(motion, mounts), "the path with the body on it"),
        "linear.png": (show.plot_linear(motion), "position, velocity, acceleration"),
        "angular.png": (show.plot_angular(motion), "angles, rates, angular accelerations"),
    }
    for recording in recordings:
        figures[f"{recording.name}.png"] = (show.plot_imu(recording), "what the IMU reads")
    for name, (figure, _) in figures.items():
        show.save(figure, folder / name)
    return [f"{folder / name}  {what}" for name, (_, what) in figures.items()]


def describe_notes(notes: Sequence[Note]) -> list[str]:
    """One line a note; of each kind with times only the first few and how many there are."""
    lines, seen = [], dict.fromkeys(note.kind for note in notes)
    for kind in seen:
        same = [n for n in notes if n.kind == kind]
        shown = same if kind == "method" else same[:_NOTES_SHOWN]
        lines += [n.text if n.t is None else f"at {n.t:.6g} s: {n.text}" for n in shown]
        if len(same) > len(shown):
            lines.append(
                f"... and {len(same) - len(shown)} more of this kind, the last at {same[-1].t:.6g} s"
            )
    return lines


def describe_round_trip(imu: Imu, motion: Motion) -> list[str]:
    """Lines of "name  errors" for ideal rates and increments of `imu`, each integrated back over all of `motion`.

    Rates show what is lost between the samples. Increments have no error of method in attitude and velocity; their
    position, integrated from velocity, shows whether the path and its derivative are one.
    """
    from kreisel.study.round_trip import round_trip

    truth, lines = motion.at(imu.mount), []
    increments = replace(imu.increments(motion), dp=None)
    for kind, recording in (("rates", imu.ideal(motion)), ("increments", increments)):
        errors = round_trip(recording, truth, imu.environment)
        p, v, turn = (float(x.max()) for x in (errors.position, errors.velocity, errors.attitude))
        lines.append(f"{imu.mount.name} {kind}  {p:.2g} m, {v:.2g} m/s, {np.rad2deg(turn):.2g} deg")
    return lines


def aligned(lines: Sequence[str]) -> str:
    """Lines of "name  what" with the second column aligned."""
    pairs = [line.split("  ", 1) for line in lines]
    width = max(len(pair[0]) for pair in pairs)
    return "\n".join(f"  {pair[0]:<{width}}  {pair[-1]}" for pair in pairs)
