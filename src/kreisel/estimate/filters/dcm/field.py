"""Turns the magnetic field of a window into heading, as far as it can be trusted."""

import math

from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.covariance import observe
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, load, scaled

# rad: an answer whose tilt is known worse than that is still finding its level.
_LEVEL = 0.06

# rad: a magnetometer that reads the same to the last bit while it turns by this has died.
_STUCK = 0.35

# Variance of a candidate that has not been watched yet, in any unit.
_UNKNOWN = 1e12

# A reference of one sample may be off by this share, as near a magnet or a steel desk; less with every second, until it
# is as good as any after one of these parts of FIELD_MEMORY.
_NEW = 0.3
_PARTS = 4.0

# How much wider than FIELD_SPREAD the world's field may spread through a room.
_ROOM = 2.0


@kernel
def observe_field(state: Array, params: Array, P: Array, rest: bool) -> float:
    """Correct the heading by the field of this window; at.DISTURBED where it was hardly trusted, else 0.

    A disturbance with no preferred direction turns the heading by as much field as it changes norm and dip:
    these two known components tell how far to believe the third.
    """
    if state[at.STUCK] > _STUCK:
        return at.DISTURBED
    east, north, up = scaled(1.0 / state[at.MAG_COUNT], load(state, at.MAG_SUM))
    level = math.hypot(east, north)
    tilt = 0.5 * (P[0, 0] + P[1, 1])
    if tilt > _LEVEL**2:
        # What is not level knows neither heading nor dip: let both follow this window.
        P[2, 2] += 1.0
        state[at.FIELD_TIME] = 0.0
    if state[at.FIELD_TIME] == 0.0:
        _begin(state, level, up)
    norm2 = state[at.FIELD] ** 2 + state[at.FIELD + 1] ** 2
    deviation = _deviation(state, params, level, up)
    spread2 = params[at.FIELD_SPREAD] ** 2 + _young(state, params) ** 2
    doubt = 1.0 + deviation / (norm2 * (spread2 + tilt))
    variance = (doubt * params[at.HEADING_NOISE]) ** 2 / state[at.LENGTH]
    # Tilt turns a steep field's heading too, and stays longer than a window: means do not cure it before TILT_TIME.
    # The smallest number keeps a vertical field from dividing by zero.
    variance += tilt * up**2 / (level**2 + 1e-300) * max(1.0, params[at.TILT_TIME] / state[at.LENGTH])
    cos_d, sin_d = params[at.DECLINATION], params[at.DECLINATION + 1]
    error = math.atan2(sin_d * north - cos_d * east, cos_d * north + sin_d * east)
    before = state[at.CORRECTION + 2]
    observe(state, P, 2, error, variance)
    state[at.HEADING] -= state[at.CORRECTION + 2] - before
    reference = state[at.FIELD : at.FIELD_TIME + 1]
    learn_reference(reference, params[at.FIELD_MEMORY], state[at.LENGTH], level, up, 1.0 / doubt)
    if not rest:
        _reconsider(state, params, P, level, up)
    return at.DISTURBED if doubt > 2.0 else 0.0


@kernel
def _young(state: Array, params: Array) -> float:
    """How far, as a share, the reference itself may be off: what first samples saw may have been iron."""
    return _NEW * max(0.0, 1.0 - _PARTS * state[at.FIELD_TIME] / params[at.FIELD_MEMORY])


@kernel
def _begin(state: Array, level: float, up: float) -> None:
    state[at.FIELD], state[at.FIELD + 1] = level, up
    state[at.CANDIDATE], state[at.CANDIDATE + 1] = level, up
    state[at.CANDIDATE + 2] = _UNKNOWN
    state[at.DEVIATION] = state[at.STEADY] = 0.0


@kernel
def _deviation(state: Array, params: Array, level: float, up: float) -> float:
    """Mean square by which norm and dip, as field, differ from the reference, or did a moment ago."""
    norm = math.hypot(state[at.FIELD], state[at.FIELD + 1])
    stretched = math.hypot(level, up) - norm
    dipped = norm * (math.atan2(up, level) - math.atan2(state[at.FIELD + 1], state[at.FIELD]))
    released = state[at.DEVIATION] * math.exp(-state[at.LENGTH] / params[at.FIELD_RELEASE])
    # What disturbed a moment ago is still near.
    state[at.DEVIATION] = max(released, 0.5 * (stretched**2 + dipped**2))
    return state[at.DEVIATION]


@kernel
def learn_reference(
    reference: Array, memory: float, dt: float, level: float, up: float, trust: float
) -> None:
    """The reference is the mean of a first while, and then slowly follows what is trusted.

    reference: horizontal and up, and for how long it has been learned, s.
    """
    reference[2] += dt
    if reference[2] < memory:
        trust = 1.0
    k = trust * dt / min(reference[2], memory)
    reference[0] += k * (level - reference[0])
    reference[1] += k * (up - reference[1])


@kernel
def _reconsider(state: Array, params: Array, P: Array, level: float, up: float) -> None:
    """A field that stays the same in N while the body moves is the world's, whatever the reference says.

    Iron on the body fails this test; a start beside iron, or another room, passes it after FIELD_MEMORY of
    motion. The heading may then be off by as much as the reference was.
    """
    room2 = (_ROOM * params[at.FIELD_SPREAD]) ** 2 * (level**2 + up**2)
    k = min(1.0, _PARTS * state[at.LENGTH] / params[at.FIELD_MEMORY])
    a, b = level - state[at.CANDIDATE], up - state[at.CANDIDATE + 1]
    state[at.CANDIDATE] += k * a
    state[at.CANDIDATE + 1] += k * b
    state[at.CANDIDATE + 2] += k * (0.5 * (a * a + b * b) - state[at.CANDIDATE + 2])
    state[at.STEADY] = state[at.STEADY] + state[at.LENGTH] if state[at.CANDIDATE + 2] < room2 else 0.0
    a, b = state[at.CANDIDATE] - state[at.FIELD], state[at.CANDIDATE + 1] - state[at.FIELD + 1]
    if state[at.STEADY] > params[at.FIELD_MEMORY] and a * a + b * b > 2.0 * room2:
        state[at.FIELD], state[at.FIELD + 1] = state[at.CANDIDATE], state[at.CANDIDATE + 1]
        P[2, 2] += min(1.0, (a * a + b * b) / (level**2 + 1e-300))
        state[at.DEVIATION] = state[at.STEADY] = 0.0
