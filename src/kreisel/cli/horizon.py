"""Turns an attitude into a small picture of characters: what a pilot sees who looks along the sensor's x axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from rich.text import Text

Array = npt.NDArray[np.float64]
Raster = npt.NDArray[np.int8]

SKY, GROUND, LADDER, WINGS = range(4)

# Half the angle of view, rad. Seen wider, a tilt of a few degrees would be less than a character.
_HALF_HIGH = np.radians(35.0)


_STEP = np.radians(10.0)  # rad, between rungs of the ladder
_RUNG = np.radians(9.0)  # rad, half a rung

_COLOURS = {SKY: "#3b78b8", GROUND: "#7a5230", LADDER: "#d8d8d8", WINGS: "#ffd200"}
_LETTERS = {SKY: " ", GROUND: "#", LADDER: "-", WINGS: "="}

_POINTS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")


def pilots_angles(R_NS: Array) -> tuple[float, float, float]:
    """Heading clockwise from north in [0, 360), pitch nose up and roll right side down, deg, of R_NS (3, 3)."""
    from kreisel.maths.rotations import euler_from_matrix

    roll, nose_down, yaw = np.degrees(euler_from_matrix(R_NS)).tolist()
    return (90.0 - yaw) % 360.0, -nose_down, roll


def raster(R_NS: Array, rows: int, columns: int) -> Raster:
    """What each of (2 rows, columns) picture elements shows, the upper left first, seen along x of S."""
    elements = 2 * rows
    scale = np.tan(_HALF_HIGH) / rows
    v = (rows - 0.5 - np.arange(elements)) * scale
    u = (np.arange(columns) - 0.5 * (columns - 1)) * scale
    d_S = np.stack(np.broadcast_arrays(1.0, -u[None, :], v[:, None]), axis=-1)
    d_N = d_S @ R_NS.T
    up = np.arcsin(d_N[..., 2] / np.linalg.norm(d_N, axis=-1))
    picture = np.where(up < 0.0, GROUND, SKY).astype(np.int8)
    picture[_rungs(d_N, up, R_NS[:, 0], scale)] = LADDER
    middle, centre = rows - 1, columns // 2
    for side in (-1, 1):
        picture[middle, centre + side * 4 : centre + side * 9 : side] = WINGS
    picture[middle, centre] = WINGS
    return picture


def _rungs(d_N: Array, up: Array, nose_N: Array, scale: float) -> npt.NDArray[np.bool_]:
    """Where an element lies on a rung: near a multiple of the step, and near the vertical through the nose."""
    level = np.rint(up / _STEP)
    across = nose_N[0] * d_N[..., 1] - nose_N[1] * d_N[..., 0]
    along = nose_N[0] * d_N[..., 0] + nose_N[1] * d_N[..., 1]
    beside = np.abs(np.arctan2(across, along)) * np.cos(up)
    long = np.where(level % 3 == 0, _RUNG, 0.5 * _RUNG)
    near = np.abs(up - level * _STEP) < 0.5 * scale
    return np.asarray(near & (level != 0) & (np.abs(level) < 9) & (beside < long))


def drawn(picture: Raster, coloured: bool) -> list[Text]:
    """The lines of a raster: two elements a character in colours, or the upper of the two as a letter."""
    from rich.text import Text

    if not coloured:
        return [Text("".join(_LETTERS[int(e)] for e in row)) for row in _letters(picture)]
    lines = []
    for upper, lower in zip(picture[0::2], picture[1::2], strict=True):
        line = Text()
        for a, b in zip(upper.tolist(), lower.tolist(), strict=True):
            line.append("▀", f"{_COLOURS[a]} on {_COLOURS[b]}")
        lines.append(line)
    return lines


def _letters(picture: Raster) -> Raster:
    """One element a character: the mark if there is one, else the lower."""
    upper, lower = picture[0::2], picture[1::2]
    return np.where(upper > GROUND, upper, lower)


def tape(heading_deg: float, columns: int) -> str:
    """A compass of one line, the heading in its middle: "NW   .   N   .   NE"."""
    # 180 deg across: the points on both sides of the heading are always in sight.
    per_column = 180.0 / columns
    letters = [" "] * columns
    first = heading_deg - per_column * (columns // 2)
    for degrees in range(-180, 900, 15):
        k = round((degrees - first) / per_column)
        name = _POINTS[degrees // 45 % 8] if degrees % 45 == 0 else "."
        k -= len(name) // 2
        if 0 <= k <= columns - len(name):
            letters[k : k + len(name)] = name
    return "".join(letters)
