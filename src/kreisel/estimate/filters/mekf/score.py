"""Turns windows into how well a filter foretold them, and two filters' scores into which of them to believe."""

from kreisel.estimate.filters.mekf import layout as at
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, added, load, norm, store

# m/s: surprise that every motion may bring.
_ORDINARY = 0.25

# By what share of the other's square a surprise must be smaller.
_LESS = 0.1

# How many times less again, by this power, where the rival's mean field is shorter: a frame that sways by 6 deg
# shortens the field by 0.5 percent, and must foretell three times as well.
_SHORTER = 200.0


@kernel
def begin_score(state: Array) -> None:
    """Nothing has been foretold yet."""
    for i in range(at.SCORE, at.ONE):
        state[i] = 0.0


@kernel
def keep_score(state: Array) -> None:
    """Add this window's surprise of the velocity, of which rest has nothing to tell, and its field in N."""
    dt = state[at.LENGTH]
    if int(state[at.CALM]) & at.REST == 0:
        state[at.SCORE] += dt * (state[at.SURPRISE] ** 2 + state[at.SURPRISE + 1] ** 2)
        state[at.SCORED] += dt
    if state[at.MAG_COUNT] > 0.0:
        field = added(load(state, at.FIELD_SUM), dt / state[at.MAG_COUNT], load(state, at.MAG_SUM))
        store(state, at.FIELD_SUM, field)
        state[at.FIELD_SUMMED] += dt


@kernel
def is_better(rival: Array, state: Array, least: float) -> bool:
    """Whether `rival` foretold by far better than `state` for `least` seconds or longer.

    The field of the world is the same vector at all times; in a frame that sways its mean is shorter.
    """
    if min(rival[at.SCORED], state[at.SCORED]) < least:
        return False
    surprise2 = state[at.SCORE] / state[at.SCORED]
    seen = _mean_field(state)
    length = min(_mean_field(rival) / seen, 1.0) if seen > 0.0 else 1.0
    less = rival[at.SCORE] / rival[at.SCORED] < _LESS * length**_SHORTER * surprise2
    return less and surprise2 > _ORDINARY**2


@kernel
def _mean_field(state: Array) -> float:
    seconds = state[at.FIELD_SUMMED]
    return norm(load(state, at.FIELD_SUM)) / seconds if seconds > 0.0 else 0.0
