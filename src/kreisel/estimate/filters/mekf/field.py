"""Turns the magnetic field of a window into heading, as far as norm and dip let it be trusted."""

import math

from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.covariance import look, row_of_next, take
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, load, scaled

# rad: an answer whose tilt is known worse than that is still finding its level.
_LEVEL = 0.06

# By how many spreads a disturbance that norm and dip no longer show may still turn the field.
_HIDDEN = 4.5

# rad: a magnetometer that reads the same to the last bit while it turns by this has died.
_STUCK = 0.35

# A reference of one sample may be off by this share, as near a magnet or a steel desk; less with every second, until it
# is as good as any after one of these parts of FIELD_MEMORY.
_NEW = 0.3
_PARTS = 4.0

# How much wider than FIELD_SPREAD the world's field may spread through a room.
_ROOM = 2.5

# How many times that a field differs which is another one.
_ELSEWHERE = 4.0

# Times of FIELD_MEMORY for which another field must have stayed.
_PROOF = 1.5

# s, over which errors of the heading are averaged; standard deviations beyond which their mean contradicts it.
_PATIENCE = 15.0
_CONTRADICTION = 3.0

# s: a tilt's error counts once in this time.
_TILT_TIME = 10.0


@kernel
def observe_field(state: Array, params: Array, P: Array, rest: bool) -> float:
    """Correct the heading by the field of this window; at.DISTURBED where it was hardly trusted, else 0.

    A disturbance with no preferred direction turns the heading by as much field as it changes norm and dip:
    these two known components tell how far the third may be off, here and for a while.
    """
    if state[at.STUCK] > _STUCK:
        return at.DISTURBED
    dt = state[at.LENGTH]
    east, north, up = scaled(1.0 / state[at.MAG_COUNT], load(state, at.MAG_SUM))
    level = math.hypot(east, north)
    tilt = 0.5 * (P[0, 0] + P[1, 1])
    if tilt > _LEVEL**2:
        # What is not level knows neither heading nor dip: let both follow this window, the dip until one was learned.
        P[2, 2] += 1.0
        if state[at.FIELD_TIME] < params[at.FIELD_MEMORY]:
            state[at.FIELD_TIME] = 0.0
    if state[at.FIELD_TIME] == 0.0:
        _begin(state, params, P, level, up)
    norm2 = state[at.FIELD] ** 2 + state[at.FIELD + 1] ** 2
    lever2 = norm2 / (level**2 + 1e-300)
    deviation = _deviation(state, params, level, up) / norm2
    spread2 = params[at.FIELD_SPREAD] ** 2 + _young(state, params) ** 2
    doubt = 1.0 + deviation / (spread2 + tilt)
    _widen(state, params, P, min(spread2 * lever2 * doubt**2, 3.0))
    variance = params[at.FIELD_NOISE] ** 2 * lever2 * doubt**2 / dt
    variance += tilt * up**2 / (level**2 + 1e-300) * max(1.0, _TILT_TIME / dt)
    cos_d, sin_d = params[at.DECLINATION], params[at.DECLINATION + 1]
    error = math.atan2(sin_d * north - cos_d * east, cos_d * north + sin_d * east)
    _correct_heading(state, params, P, error, variance, doubt)
    if tilt <= _LEVEL**2 or state[at.FIELD_TIME] == 0.0:
        _learn(state, params, level, up, doubt)
    if not rest and tilt <= _LEVEL**2:
        _reconsider(state, params, P, level, up)
    return at.DISTURBED if doubt > 2.0 else 0.0


@kernel
def _widen(state: Array, params: Array, P: Array, spread: float) -> None:
    """What turns the field may be that large from now on: more at once, less as what is there fades."""
    if spread > state[at.SPREAD]:
        P[at.D, at.D] += spread - state[at.SPREAD]
    state[at.SPREAD] = spread


@kernel
def _correct_heading(
    state: Array, params: Array, P: Array, error: float, variance: float, doubt: float
) -> None:
    """The heading is off by `error`, less what turns the field; a surprise counts by Student's t."""
    row = row_of_next(state)
    state[row + 2] = 1.0
    state[row + at.D] = -1.0
    known, own = look(state, P)
    surprise = error - state[at.TURNED] - known
    surprise -= 2.0 * math.pi * math.floor(surprise / (2.0 * math.pi) + 0.5)
    variance += own
    far2 = surprise**2 / variance
    tail = params[at.TAIL]
    before = state[at.CORRECTION + 2]
    take(state, P, surprise, variance * max(1.0, (tail + far2) / (tail + 1.0)))
    state[at.HEADING] -= state[at.CORRECTION + 2] - before
    _contradict(state, params, P, error, doubt)


@kernel
def _contradict(state: Array, params: Array, P: Array, error: float, doubt: float) -> None:
    """A heading that trusted fields contradict for long is wrong, however well it seems to be known.

    What turns a field differs from place to place and from one attitude to another: its mean over a while is small.
    """
    state[at.CONTRARY] += state[at.LENGTH] / (_PATIENCE * doubt) * (error - state[at.CONTRARY])
    uneven2 = params[at.FIELD_SPREAD] ** 2 * (1.0 + (state[at.FIELD + 1] / (state[at.FIELD] + 1e-300)) ** 2)
    if state[at.CONTRARY] ** 2 > _CONTRADICTION**2 * (P[2, 2] + min(uneven2, 1.0)):
        P[2, 2] += state[at.CONTRARY] ** 2
        state[at.CONTRARY] = 0.0


@kernel
def _young(state: Array, params: Array) -> float:
    """How far, as a share, the reference itself may be off: what first samples saw may have been iron."""
    return _NEW * max(0.0, 1.0 - _PARTS * state[at.FIELD_TIME] / params[at.FIELD_MEMORY])


@kernel
def _learn(state: Array, params: Array, level: float, up: float, doubt: float) -> None:
    """The reference is the mean of a first while and then slowly follows; what is doubted counts less."""
    state[at.FIELD_TIME] += state[at.LENGTH]
    k = state[at.LENGTH] / (doubt * min(state[at.FIELD_TIME], params[at.FIELD_MEMORY]))
    state[at.FIELD] += k * (level - state[at.FIELD])
    state[at.FIELD + 1] += k * (up - state[at.FIELD + 1])


@kernel
def _begin(state: Array, params: Array, P: Array, level: float, up: float) -> None:
    state[at.FIELD], state[at.FIELD + 1] = level, up
    state[at.CANDIDATE], state[at.CANDIDATE + 1] = level, up
    state[at.CANDIDATE + 2] = state[at.DEVIATION] = state[at.STEADY] = state[at.CONTRARY] = 0.0


@kernel
def _deviation(state: Array, params: Array, level: float, up: float) -> float:
    """Mean square by which norm and dip, as field, differ from the reference, or did a moment ago."""
    norm = math.hypot(state[at.FIELD], state[at.FIELD + 1])
    stretched = math.hypot(level, up) - norm
    dipped = norm * (math.atan2(up, level) - math.atan2(state[at.FIELD + 1], state[at.FIELD]))
    # What disturbed a moment ago is still near. The larger it was, the less likely do norm and dip both miss it: that
    # is as the inverse square, so that what may still hide is of one size.
    hidden = min(state[at.DEVIATION], (_HIDDEN * params[at.FIELD_SPREAD] * norm) ** 2)
    released = hidden * math.exp(-state[at.LENGTH] / params[at.FIELD_RELEASE])
    state[at.DEVIATION] = max(released, min(0.5 * (stretched**2 + dipped**2), norm**2))
    return state[at.DEVIATION]


@kernel
def _reconsider(state: Array, params: Array, P: Array, level: float, up: float) -> None:
    """A field that stays the same in N while the body moves is the world's, whatever the reference says.

    Iron on the body fails this test; a start beside iron, or another room, passes it after FIELD_MEMORY of
    motion. The heading may then be off by as much as the reference was.
    """
    room2 = (_ROOM * params[at.FIELD_SPREAD]) ** 2 * (level**2 + up**2)
    k = min(1.0, _PARTS * state[at.LENGTH] / params[at.FIELD_MEMORY])
    a, b = level - state[at.CANDIDATE], up - state[at.CANDIDATE + 1]
    if 0.5 * (a * a + b * b) > _ELSEWHERE**2 * room2:
        state[at.CANDIDATE], state[at.CANDIDATE + 1], state[at.CANDIDATE + 2] = level, up, room2
        state[at.STEADY] = a = b = 0.0
    state[at.CANDIDATE] += k * a
    state[at.CANDIDATE + 1] += k * b
    state[at.CANDIDATE + 2] += k * (0.5 * (a * a + b * b) - state[at.CANDIDATE + 2])
    a, b = state[at.CANDIDATE] - state[at.FIELD], state[at.CANDIDATE + 1] - state[at.FIELD + 1]
    is_other = a * a + b * b > 2.0 * room2 / _ROOM**2 and state[at.CANDIDATE + 2] < room2
    state[at.STEADY] = state[at.STEADY] + state[at.LENGTH] if is_other else 0.0
    if state[at.STEADY] > _PROOF * params[at.FIELD_MEMORY]:
        state[at.FIELD], state[at.FIELD + 1] = state[at.CANDIDATE], state[at.CANDIDATE + 1]
        P[2, 2] += min(1.0, (a * a + b * b) / (level**2 + 1e-300))
        state[at.DEVIATION] = state[at.STEADY] = 0.0
