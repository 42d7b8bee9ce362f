"""Turns a course of more samples than memory holds into the files that a simulation in one piece would write."""

from __future__ import annotations

import shutil
from argparse import Namespace
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from kreisel.atomic import replacing
from kreisel.cli.courses import Course
from kreisel.cli.error_terms import error_terms
from kreisel.cli.memory import available
from kreisel.cli.notes import note
from kreisel.data.frames import from_enu_flu, to_enu_flu
from kreisel.data.median import RunningMedian
from kreisel.data.motion import Motion, Note
from kreisel.data.recording import ImuRecording
from kreisel.files.blocks import read_blocks, write_blocks
from kreisel.files.doors import suffix
from kreisel.files.members import ROWS
from kreisel.files.spool import write_archive
from kreisel.simulate.clock import steps as time_steps
from kreisel.simulate.imu import Imu

# Measured: what a simulation in one piece takes of memory, and its files of disk, for a motion and for each IMU.
_BYTES = 500


class Sampled(NamedTuple):
    """What the summary tells of a motion."""

    samples: int
    start: float  # s
    end: float  # s
    t0_ns: int
    notes: tuple[Note, ...]

    @classmethod
    def of(cls, motion: Motion) -> Sampled:
        """Of one in one piece."""
        return cls(len(motion), float(motion.t[0]), float(motion.t[-1]), motion.t0_ns, motion.notes)


def in_blocks(args: Namespace, course: Course, imus: Sequence[Imu]) -> bool:
    """Whether a simulation is to go in blocks; ValueError where what was asked for needs all of it at once."""
    needed = _BYTES * len(course) * (1 + len(imus))
    # Central differences, and samples that come late or are collected, are made of others of any block.
    whole = args.method == "gradient" or any(imu.clock.looks_back for imu in imus)
    if whole or 2 * needed <= available():
        return False
    for option in ("animation", "rerun", "check", "increments"):
        if getattr(args, option):
            raise ValueError(
                f"--{option} needs the whole motion in memory, and {len(course):.3g} samples are too many. "
                "Leave it out, or take a lower --rate."
            )
    place = args.output.absolute()
    free = shutil.disk_usage(next(each for each in (place, *place.parents) if each.is_dir())).free
    if needed > free:
        raise ValueError(
            f"{len(course):.3g} samples take about {needed / 1e9:.3g} GB of disk, and {args.output} has "
            f"{free / 1e9:.3g} GB. Is this the rate that was meant, and the unit of time?"
        )
    if not args.no_pictures:
        note(f"{len(course):.3g} samples go in blocks; pictures, which need all at once, are left out")
    return True


def write_long(args: Namespace, course: Course, imus: Sequence[Imu], erring: Sequence[Imu]) -> Sampled:
    """Write IMU data, errors and truth into the folder, the truth first: the rest is made from it."""
    folder, world = args.output, args.to_frame
    folder.mkdir(parents=True, exist_ok=True)
    truth, steps, ends = folder / "truth.npz", RunningMedian(), list[Sampled]()
    write_blocks(truth, (from_enu_flu(block, world) for block in _noted(course, steps, ends)))
    write_blocks(folder / "truth.tum", read_blocks(truth))  # type: ignore[arg-type]
    step = steps.value()
    for imu in imus:
        name = imu.mount.name
        read = (from_enu_flu(block, world) for block in _readings(imu, imu in erring, truth, args, step))
        write_blocks(folder / f"{name}{suffix(args.imu_format)}", read, args.imu_format)
    for imu in erring:
        with replacing(folder / f"{imu.mount.name}-errors.npz") as out:
            recorded = imu.record_long(_motions(truth, world), args.seed, step=step)
            write_archive((error_terms(block, world) for block in recorded), out)
    first, last = ends
    return Sampled(len(course), first.start, last.end, last.t0_ns, last.notes)


def _noted(course: Course, steps: RunningMedian, ends: list[Sampled]) -> Iterator[Motion]:
    """The blocks of the course, each with the notes of all so far; `ends` takes the first and the last of them."""
    last, notes = None, dict[Note, None]()
    for block in course.blocks(ROWS):
        notes |= dict.fromkeys(block.notes)
        steps.add(time_steps(block.t, last))
        last = float(block.t[-1])
        noted = replace(block, notes=tuple(notes))
        ends[:] = [*ends[:1], Sampled.of(noted)] if ends else [Sampled.of(noted)] * 2
        yield noted


def _motions(truth: Path, world: str) -> Iterator[Motion]:
    for block in read_blocks(truth):
        assert isinstance(block, Motion)  # as it was written
        yield to_enu_flu(block, world)


def _readings(imu: Imu, errs: bool, truth: Path, args: Namespace, step: float) -> Iterator[ImuRecording]:
    motions = _motions(truth, args.to_frame)
    if errs:
        return (each.measured for each in imu.record_long(motions, args.seed, step=step))
    return map(imu.ideal, motions)
