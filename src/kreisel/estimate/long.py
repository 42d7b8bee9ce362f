"""Turns a recording that comes in blocks into attitude, block by block, in memory that does not grow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.checks import instance
from kreisel.data.recording import SOURCE, ImuRecording
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters import Array, AttitudeFilter
from kreisel.estimate.run import readings


def run_long(
    filter: AttitudeFilter, blocks: Iterable[ImuRecording], R_NS: Array | None = None
) -> Iterator[AttitudeHistory]:
    """The attitude at every sample of a recording of any length, with the bits that `run` has for the whole.

    blocks : pieces of the recording, of any size, one after the other in time and all with the same t0_ns, as
        `kreisel.read_blocks` yields them; a generator may make them on the fly. Each gives one block of attitude
        before the next is asked for.
    R_NS : (3, 3), the first attitude where it is known.
    Raises ValueError where a block does not follow the one before, and where the filter needs a magnetometer that
    a block does not have.
    """
    state, parameters = filter.start(R_NS), filter.parameters()
    last: ImuRecording | None = None
    for block in blocks:
        instance("block", block, ImuRecording, SOURCE)
        if len(block) == 0:
            continue
        inputs = readings(filter, block.t, block.gyro, block.accel, block.mag_uT)
        if last is not None:
            _follows(last, block)
            # The first step of a batch is one of no time, which changes nothing after this one.
            first = np.concatenate([column[0] for column in inputs[1:]])
            filter.update(state, parameters, first, float(block.t[0] - last.t[-1]))
        columns = Columns.room_for(filter, (len(block),))
        filter.batch(state, parameters, *inputs, columns)
        last = block
        yield columns.history(block)


def _follows(before: ImuRecording, block: ImuRecording) -> None:
    if block.t0_ns != before.t0_ns:
        raise ValueError(
            f"blocks of one recording must have the same t0_ns; got {block.t0_ns} after {before.t0_ns}."
        )
    if not block.t[0] > before.t[-1]:
        raise ValueError(
            f"blocks must follow each other in time; one begins at {block.t[0]:.9g} s, and the one before ends at "
            f"{before.t[-1]:.9g} s. Count t through all of them."
        )
