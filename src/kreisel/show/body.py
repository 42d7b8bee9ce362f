"""Turns a pose into the flat red wedge that stands for the body.

Seen from above it is a triangle; its nose lies along x_B and its darker side is the lower one.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.show import style

# Corners in B for a body one long: nose, left and right end of the tail, above and below. The centre of
# mass is where that of a triangle is, two thirds of the length behind the nose.
_OUTLINE = np.array([[2 / 3, 0.0], [-1 / 3, 0.36], [-1 / 3, -0.36]])
_HALF_THICK = 0.035
CORNERS = np.concatenate([np.insert(_OUTLINE, 2, z, axis=1) for z in (_HALF_THICK, -_HALF_THICK)])

# Rows of CORNERS around each face, counter-clockwise seen from outside.
FACES = ((0, 1, 2), (5, 4, 3), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0))
FACE_COLOURS = (style.BODY, style.BODY_BELOW, style.BODY_SIDE, style.BODY_SIDE, style.BODY_SIDE)


def corners(p_NB: Array, R_NB: Array, length: float) -> Array:
    """Corners (6, 3) in N of a wedge of `length` m at p_NB (3,) turned by R_NB (3, 3); row 0 is the nose."""
    return np.asarray(p_NB + length * CORNERS @ R_NB.T)


def faces(p_NB: Array, R_NB: Array, length: float) -> list[Array]:
    """The five faces of that wedge, each (k, 3) in N, in the order of FACE_COLOURS."""
    placed = corners(p_NB, R_NB, length)
    return [placed[list(face)] for face in FACES]


def drawn_length(extent: float, reach: float, share: float) -> float:
    """Length to draw the body at, m: a `share` of the path's extent, or long enough to hold its sensors.

    extent: longest side of the box around the path, m; reach: longest lever arm, m. A body that rests and
    carries nothing is drawn 0.3 m long.
    """
    return max(share * extent, 2.0 * reach) or 0.3


def instants(p: Array, apart: float, most: int) -> npt.NDArray[np.intp]:
    """Up to `most` rows at which bodies drawn cover the path `p` (n, 2) evenly without hiding one another.

    The first row, then again and again the one farthest from all taken, until none is left that is
    `apart` m from them. `p` is the path as it is seen, without depth. Even spacing in time would put a body
    that goes round and round into the same places.
    """
    taken = [0]
    distance = np.linalg.norm(p - p[0], axis=1)
    while len(taken) < most and distance.max() > apart:
        taken.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(p - p[taken[-1]], axis=1))
    return np.sort(taken)
