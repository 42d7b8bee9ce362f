"""What a navigation-grade unit delivers: the turn, and the velocity without gravity, of every interval."""

from __future__ import annotations

from dataclasses import dataclass

from kreisel.data.cards import Card, Shown, course, span
from kreisel.data.checks import Array, increasing, shaped


@dataclass(frozen=True, slots=True, eq=False)
class ImuIncrements(Shown):
    """Compensated increments in sensor axes S: row k spans t[k] to t[k + 1]. A NaN row is a missing interval.

    Coning and sculling are in them: dtheta = Log(R_k^T R_k+1) and dv = R_k^T (v_k+1 - v_k - g dt) bring
    attitude and velocity from stamp to stamp with no error of method. R, v and p are against inertial axes: where N
    turns, its turn is in them (kreisel.maths.turning). Position is determined by them only
    as far as velocity can be interpolated; dp, which few units deliver, closes that gap.
    """

    t: Array  # (n + 1,) s after t0_ns, strictly increasing: both ends of every interval
    dtheta: Array  # (n, 3) rad, Log(R_k^T R_k+1)
    dv: Array  # (n, 3) m/s, R_k^T (v_k+1 - v_k - g dt)
    dp: Array | None = None  # (n, 3) m, R_k^T (p_k+1 - p_k - v_k dt - g dt^2 / 2)
    t0_ns: int = 0  # epoch of t = 0, ns
    name: str = ""

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", increasing("t", shaped("t", self.t, ("n",))))
        if not len(self.t):
            raise ValueError("t must hold both ends of every interval, one stamp more than rows; got none.")
        put(self, "dtheta", shaped("dtheta", self.dtheta, (len(self.t) - 1, 3)))
        put(self, "dv", shaped("dv", self.dv, (len(self.t) - 1, 3)))
        if self.dp is not None:
            put(self, "dp", shaped("dp", self.dp, (len(self.t) - 1, 3)))
        put(self, "t0_ns", int(self.t0_ns))

    def __len__(self) -> int:
        return len(self.dtheta)

    def card(self) -> Card:
        """What the increments of each kind span."""
        parts = (("dtheta", "rad", self.dtheta), ("dv", "m/s", self.dv), ("dp", "m", self.dp))
        rows = [(name, unit, "S", span(x)) for name, unit, x in parts if x is not None]
        return Card(course(self, self.t), ("", "unit", "frame", "span"), rows)
