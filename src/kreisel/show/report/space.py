"""Turns an Account into what moves in space: a body, its IMUs, and the attitude that each filter gave it."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.data.attitude import Reference
from kreisel.data.checks import Array
from kreisel.data.motion import Mount
from kreisel.maths.rotations import quat_wxyz_from_matrix
from kreisel.show import body, style
from kreisel.show.report.lines import Packed, Timeline, packed
from kreisel.show.scene import staged
from kreisel.study.account import Account, Answer, body_path, sensor_attitude

_BODY_SHARE = 0.2

# Half the sides of the room around a body of which nobody knows where it is, in lengths of the body.
_ROOM = (0.9, 0.9, 0.6)

# A screen shows no more frames in a second; the page puts a smooth curve through what is left of them.
_FASTEST_HZ = 60.0
_MOST_ROWS = 40_000  # of all tracks together: some 1.2 MB as text


def space(account: Account, on: Timeline) -> dict[str, Any]:
    """Box, body and tracks, as the page takes them."""
    mounts = [reading.mount for reading in account.readings]
    rows = _MOST_ROWS // (1 + len(account.answers))
    truth = body_path(account.truth)
    still = truth is None
    p = np.zeros((1, 3)) if truth is None else truth.p_NB
    on_stage = staged(p, [], mounts, _BODY_SHARE)
    centre = 0.5 * (on_stage.low + on_stage.high)
    half = 0.5 * (on_stage.high - on_stage.low)
    if still:
        half = on_stage.length * np.array(_ROOM)
    return {
        "still": still,
        "centre": centre.tolist(),
        "half": half.tolist(),
        "length": on_stage.length,
        "corners": body.CORNERS.tolist(),
        "faces": body.FACES,
        "truth": _true_track(account, on, rows, centre),
        "answers": [_answer_track(answer, mounts, on, rows) for answer in account.answers],
        "imus": [
            {"p": mount.p_BS.tolist(), "R": mount.R_BS.tolist(), "colour": f"imu-{k % len(style.IMU)}"}
            for k, mount in enumerate(mounts)
        ],
    }


def _true_track(account: Account, on: Timeline, most: int, centre: Array) -> Packed | None:
    """Where the body was, about `centre`, and how it was turned; None without truth."""
    truth = account.truth
    if truth is None:
        return None
    path, attitude = body_path(truth), _body_attitude(account)
    good = np.ones(len(truth), dtype=np.bool_) if attitude is None else attitude.counts
    t = on.at(truth.t, truth.t0_ns)[good]
    rows = _rows(t, most)
    track = {"t": packed(t[rows] - on.start)}
    if attitude is not None:
        track["q"] = packed(quat_wxyz_from_matrix(attitude.R_NS[good][rows]).ravel())
    if path is not None:
        track["p"] = packed((path.p_NB[good][rows] - centre).ravel())
    return track


def _body_attitude(account: Account) -> Reference | None:
    """True attitude of the body; None for a truth of positions only."""
    truth = account.truth
    assert truth is not None
    if getattr(truth, "R_NB", True) is None:
        return None
    seen = sensor_attitude(truth, Mount())
    if body_path(truth) is not None or not account.readings:
        return seen
    R_SB = account.readings[0].mount.R_BS.T
    return Reference(seen.t, seen.R_NS @ R_SB, seen.counts, seen.t0_ns)


def _answer_track(answer: Answer, mounts: list[Mount], on: Timeline, most: int) -> Packed:
    """How the body was turned by what the filter said of its sensor."""
    mount = next(mount for mount in mounts if mount.name == answer.imu)
    t = on.at(answer.attitude.t, answer.attitude.t0_ns)
    rows = _rows(t, most)
    R_NB = answer.attitude.R_NS[rows] @ mount.R_BS.T
    return {"t": packed(t[rows] - on.start), "q": packed(quat_wxyz_from_matrix(R_NB).ravel())}


def _rows(t: Array, most: int) -> npt.NDArray[np.intp]:
    """Up to `most` rows spread evenly over the time `t` (n,), both ends among them."""
    if len(t) < 2:
        return np.arange(len(t))
    wanted = min(most, len(t), int(np.ceil(_FASTEST_HZ * (t[-1] - t[0]))) + 2)
    return np.unique(np.searchsorted(t, np.linspace(t[0], t[-1], wanted)).clip(0, len(t) - 1))
