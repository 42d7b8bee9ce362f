"""Turns the directions in which the parameters could move unnoticed into sentences that name parameter and axis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from kreisel.data.checks import Array

HIDDEN = 0.05
"""Share of a direction that may be unseen before it counts as hidden: an axis 13 degrees off one that is."""

ALONE = 0.9
"""From this share on a direction is hidden by itself, not because another parameter would do the same."""

_AXES_OF = {"lever_arm": "the body", "tilt": "N"}
_ONE_AXIS = 0.99


def unseen_sentences(directions: Array, slots: Mapping[str, slice]) -> Iterator[str]:
    """One sentence for each axis of a parameter that `directions` (m, p), orthonormal rows, leave open."""
    for name, s in slots.items():
        values, vectors = np.linalg.eigh(directions[:, s].T @ directions[:, s])
        hidden = values > HIDDEN
        if hidden.sum() > 1 and values[hidden].min() > ALONE:
            yield _several(name, vectors[:, ~hidden].T)
            continue
        for value, axis in zip(values[hidden], vectors.T[hidden], strict=True):
            what = name + _along(name, axis)
            others = [] if value > ALONE else _partners(directions, slots, name, axis)
            yield _sentence(what, " or ".join(others))


def _partners(directions: Array, slots: Mapping[str, slice], name: str, axis: Array) -> list[str]:
    """The parameters that move along when `name` moves along `axis` unnoticed."""
    weights = directions[:, slots[name]] @ axis
    way = weights @ directions
    way = way / np.linalg.norm(way)
    return [other for other, s in slots.items() if other != name and np.square(way[s]).sum() > HIDDEN]


def _several(name: str, shown: Array) -> str:
    only = f", other than{_along(name, shown[0])}," if len(shown) else ""
    return f"{name}{only} is not shown by this motion and stays as given."


def _sentence(what: str, others: str) -> str:
    if others:
        return f"{what} is not shown apart from {others}: only what they do together is right."
    return f"{what} is not shown by this motion and stays as given."


def _along(name: str, axis: Array) -> str:
    if len(axis) == 1:
        return ""
    frame = _AXES_OF.get(name, "the sensor")
    main = int(np.argmax(np.abs(axis)))
    if abs(axis[main]) > _ONE_AXIS:
        return f" along {'xyz'[main]} of {frame}"
    parts = ", ".join(f"{x:.2f}" for x in axis * np.sign(axis[main]))
    return f" along ({parts}) of {frame}"
