"""Turns the directions in which the parameters could move unnoticed into sentences that name parameter and axis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from kreisel.data.checks import Array

HIDDEN = 0.01
"""Share of a direction that may be unseen before it counts as hidden: an axis 6 degrees off one that is."""

# From this share on a direction is hidden by itself, not because another parameter would do the same.
_ALONE = 0.9

_AXES_OF = {"lever_arm": "body", "tilt": "N"}
_ONE_AXIS = 0.99


def unseen_sentences(directions: Array, slots: Mapping[str, slice]) -> Iterator[str]:
    """One sentence for each axis of a parameter that `directions` (m, p), orthonormal rows, leave open."""
    shares = {name: directions[:, s].T @ directions[:, s] for name, s in slots.items()}
    hidden = [name for name, share in shares.items() if np.linalg.eigvalsh(share)[-1] > HIDDEN]
    for name in hidden:
        values, vectors = np.linalg.eigh(shares[name])
        others = " or ".join(other for other in hidden if other != name)
        for value, axis in zip(values, vectors.T, strict=True):
            if value > HIDDEN:
                what = name + _along(name, axis)
                yield _sentence(what, others if value < _ALONE else "")


def _sentence(what: str, others: str) -> str:
    if others:
        return f"{what} is not shown apart from {others}: only what they do together is right."
    return f"{what} is not shown by this motion and stays as given."


def _along(name: str, axis: Array) -> str:
    if len(axis) == 1:
        return ""
    frame = _AXES_OF.get(name, "sensor")
    main = int(np.argmax(np.abs(axis)))
    if abs(axis[main]) > _ONE_AXIS:
        return f" along {'xyz'[main]} of the {frame}".replace("the N", "N")
    parts = ", ".join(f"{x:.2f}" for x in axis * np.sign(axis[main]))
    return f" along ({parts}) of the {frame}".replace("the N", "N")
