"""Turns what a command made into a folder of files and a short summary that says what is in it."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Protocol, TextIO, TypeVar

import numpy as np

from kreisel.atomic import is_standard_output, refuse_unwritable, replacing
from kreisel.cli.notes import is_quiet
from kreisel.cli.progress import Progress
from kreisel.cli.values import as_typed
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion, Mount, Note
from kreisel.data.recording import ImuRecording
from kreisel.files.doors import format_to_write, suffix, write

if TYPE_CHECKING:
    from kreisel.evaluate.attitude_errors import Summary
    from kreisel.simulate.imu import Imu
    from kreisel.simulate.recorded import Recorded

# Shown of each kind of note; a path with a thousand reversals must not bury the summary.
_NOTES_SHOWN = 4

_TAKEN = ("truth", "path", "linear", "angular", "motion")

Made = TypeVar("Made", contravariant=True)


@dataclass(frozen=True, slots=True)
class Output(Generic[Made]):
    """One file of a folder, known by name before what it will hold has been made."""

    name: str
    what: str  # for the summary
    write: Callable[[Made, Path], Any]


class Simulated(Protocol):
    """What a simulation made: one mount and one recording per IMU."""

    @property
    def motion(self) -> Motion:
        """The truth, of the body."""
        ...

    @property
    def mounts(self) -> Sequence[Mount]:
        """Where the IMUs sit."""
        ...

    @property
    def recordings(self) -> Sequence[ImuRecording | ImuIncrements]:
        """What they read, or added up."""
        ...

    @property
    def recorded(self) -> Sequence[Recorded]:
        """Of the IMUs with errors: what is known of these."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Simulation:
    """A motion and what IMUs on it read."""

    motion: Motion
    mounts: Sequence[Mount]
    recordings: Sequence[ImuRecording | ImuIncrements]
    recorded: Sequence[Recorded] = ()


def check_format(output: str, format: str | None = None) -> None:
    """Refuse a file to write whose format neither `format` nor its suffix tells, before anything is done for it."""
    with as_typed():
        format_to_write(output, format)


def summary_stream(output: str) -> TextIO:
    """Where to print what is told about `output`: the data itself may have gone to standard output."""
    if not is_standard_output(output):
        return sys.stdout
    return io.StringIO() if is_quiet() else sys.stderr


def check_outputs(folder: Path, outputs: Sequence[Output[Any]]) -> None:
    """Refuse outputs of which one would replace another, or a file that is write-protected."""
    seen: dict[str, Output[Any]] = {}
    for output in outputs:
        # Many file systems take Imu.csv and imu.csv for one.
        other = seen.setdefault(output.name.casefold(), output)
        if other is not output:
            raise ValueError(
                f"two files would be called {output.name!r}: {other.what}; {output.what}. "
                "Give the IMU or filter another name."
            )
    for output in outputs if folder.is_dir() else ():
        refuse_unwritable(folder / output.name)


def write_outputs(folder: Path, outputs: Sequence[Output[Made]], made: Made) -> list[str]:
    """Write every output, or none where one cannot be; the lines of a summary that names each file."""
    check_outputs(folder, outputs)
    _make_folder(folder)
    with Progress(len(outputs), "writing") as progress:
        for output in outputs:
            output.write(made, folder / output.name)
            progress.advance()
    return [f"{folder / output.name}  {output.what}" for output in outputs]


def written(folder: Path | None, outputs: Sequence[Output[Any]]) -> list[Path]:
    """The files that `outputs` are in `folder`; none without a folder."""
    return [] if folder is None else [folder / output.name for output in outputs]


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise type(error)(
            f"cannot make the folder {folder}: {error.strerror}. Choose another with -o."
        ) from None


def write_json(report: Any, path: Path) -> None:
    """Write a report for programs; NaN, which JSON does not know, is a ValueError."""
    with replacing(path) as out:
        out.write((json.dumps(report, indent=2, allow_nan=False) + "\n").encode())


def check_imu_names(imus: Sequence[str]) -> None:
    """ValueError for a name that an IMU cannot have, because another file is called so."""
    taken = next((name for name in imus if name.casefold() in _TAKEN), None)
    if taken is not None:
        raise ValueError(f"an IMU cannot be called {taken!r}: files of that name are written too.")


def simulation_outputs(
    imus: Sequence[str],
    *,
    erring: Sequence[str] = (),
    magnetometer: bool = False,
    increments: bool = False,
    world: str = "enu-flu",
    imu_format: str = "csv",
    pictures: bool = True,
    animation: bool = False,
    rerun: bool = False,
) -> list[Output[Simulated]]:
    """IMU data, truth and pictures of a simulation whose IMUs have these names; `erring` are those with errors."""
    from kreisel.cli.error_terms import write_error_terms
    from kreisel.data.frames import from_enu_flu

    def recording(k: int) -> Callable[[Simulated, Path], None]:
        return lambda made, path: write(path, from_enu_flu(made.recordings[k], world), format=imu_format)

    def errors(k: int) -> Callable[[Simulated, Path], None]:
        return lambda made, path: write_error_terms(path, made.recorded[k], world)

    def truth(made: Simulated, path: Path) -> None:
        write(path, from_enu_flu(made.motion, world))

    sensors = ["gyroscope (rad/s)", "accelerometer (m/s^2)", *(["magnetometer (uT)"] if magnetometer else [])]

    def held(name: str) -> str:
        sums = ["turn (rad)", "velocity (m/s)", *([] if name in erring else ["position (m)"])]
        return (
            f"{', '.join(sums)} of {name} per interval" if increments else f"{', '.join(sensors)} of {name}"
        )

    data = [Output(f"{name}{suffix(imu_format)}", held(name), recording(k)) for k, name in enumerate(imus)]
    what = "ideal readings, biases and every error term of"
    return [
        *data,
        *(Output(f"{name}-errors.npz", f"{what} {name}", errors(k)) for k, name in enumerate(erring)),
        Output("truth.tum", "position and attitude of the body, as evo and others read it", truth),
        Output("truth.npz", "the whole motion, for numpy.load", truth),
        *(_pictures(imus, increments) if pictures else ()),
        *(
            [Output("motion.gif", "the body moving along its path, and what it feels", _film)]
            if animation
            else ()
        ),
        *([_viewer()] if rerun else ()),
    ]


def picture(name: str, what: str, draw: Callable[[Made], Any]) -> Output[Made]:
    """The output of a figure that `draw` makes."""

    def save(made: Made, path: Path) -> None:
        from kreisel import show

        show.save(draw(made), path)

    return Output(name, what, save)


def _pictures(imus: Sequence[str], increments: bool) -> Iterator[Output[Simulated]]:
    from kreisel import show

    yield picture(
        "path.png", "the path with the body on it", lambda made: show.plot_path(made.motion, made.mounts)
    )
    yield picture(
        "linear.png", "position, velocity, acceleration", lambda made: show.plot_linear(made.motion)
    )
    yield picture(
        "angular.png", "angles, rates, angular accelerations", lambda made: show.plot_angular(made.motion)
    )

    def imu(k: int) -> Callable[[Simulated], Any]:
        return lambda made: show.plot_imu(_rates(made.recordings[k]))

    for k, name in enumerate(imus):
        text = f"mean rate and force in the intervals of {name}" if increments else f"what {name} reads"
        yield picture(f"{name}.png", text, imu(k))


def _rates(read: ImuRecording | ImuIncrements) -> ImuRecording:
    """What can be drawn over time."""
    return read.mean_rates() if isinstance(read, ImuIncrements) else read


def _film(made: Simulated, path: Path) -> None:
    from kreisel.show.animation import animate

    animate(made.motion, made.mounts, path, recording=_rates(made.recordings[0]))


def _viewer() -> Output[Simulated]:
    from kreisel.show.viewer import installed, save_rerun

    installed()  # now, and not when everything else has been written

    def save(made: Simulated, path: Path) -> None:
        save_rerun(path, made.motion, made.mounts, list(map(_rates, made.recordings)))

    return Output("motion.rrd", "body, IMUs and readings, for the Rerun viewer", save)


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


def describe_round_trip(
    imu: Imu, motion: Motion, measured: ImuRecording | ImuIncrements | None = None
) -> list[str]:
    """Lines of "name  errors" for readings of `imu`, each integrated back over all of `motion`.

    Ideal rates show what is lost between the samples. Increments have no error of method in attitude and velocity;
    their position, integrated from velocity, shows whether the path and its derivative are one. `measured`, what the
    sensor read with its errors, or perfect increments with dp, shows how far it drifts without a filter.
    """
    from kreisel.study.round_trip import complete, round_trip

    truth, lines = motion.at(imu.mount), []
    increments = replace(imu.increments(motion), dp=None)
    readings: dict[str, tuple[ImuRecording | ImuIncrements, Motion]] = {
        "ideal rates": (imu.ideal(motion), truth),
        "ideal increments": (increments, truth),
    }
    if measured is not None:
        exact = isinstance(measured, ImuIncrements) and measured.dp is not None
        whole = (measured, truth) if isinstance(measured, ImuIncrements) else complete(measured, truth)
        readings["increments as written" if exact else "with its errors"] = whole
    for kind, (recording, true) in readings.items():
        errors = round_trip(recording, true, imu.environment)
        p, v, turn = two_digits([float(x.max()) for x in (errors.position, errors.velocity, errors.attitude)])
        lines.append(f"{imu.mount.name} {kind}  {p} m, {v} m/s, {turn} deg")
    return lines


def two_digits(error: Sequence[float]) -> list[str]:
    """Position m, velocity m/s and attitude (rad, told in deg) with the digits that count: 100 rather than 1e+02."""
    p, v, turn = error
    return [f"{float(f'{x:.2g}'):.4g}" for x in (p, v, float(np.rad2deg(turn)))]


def removed(summary: Summary) -> list[str]:
    """A sentence for every offset that was removed before errors were counted."""
    lines = []
    if summary.heading_offset_deg is not None:
        lines.append(f"removed: heading offset of {summary.heading_offset_deg:.4g} deg")
    for name, offset in (("frame", summary.frame_offset_deg), ("sensor", summary.sensor_offset_deg)):
        if offset is not None:
            parts = ", ".join(f"{angle:.4g}" for angle in offset)
            lines.append(f"removed: turn of the {name} by the rotation vector ({parts}) deg")
    if summary.clock_offset_s:
        lines.append(f"removed: clock offset of {summary.clock_offset_s:.6g} s")
    return lines


def aligned(lines: Sequence[str]) -> str:
    """Lines of "name  what" with the second column aligned."""
    pairs = [line.split("  ", 1) for line in lines]
    width = max(len(pair[0]) for pair in pairs)
    return "\n".join(f"  {pair[0]:<{width}}  {pair[-1]}" for pair in pairs)
