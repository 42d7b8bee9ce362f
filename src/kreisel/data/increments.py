"""What a navigation-grade unit delivers: the turn, and the velocity without gravity, of every interval."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kreisel.data.cards import Card, course, span
from kreisel.data.checks import Array, increasing, read_only, shaped
from kreisel.data.recording import ImuRecording
from kreisel.data.tables import Tabular


@dataclass(frozen=True, slots=True, eq=False)
class ImuIncrements(Tabular):
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
        for name in ("dtheta", "dv", "dp"):
            rows = getattr(self, name)
            if rows is None and name == "dp":
                continue
            if np.shape(rows) == (len(self.t), 3):
                raise ValueError(
                    f"{name} must have one row fewer than t has stamps, which are both ends of every interval; got "
                    f"{len(rows)} rows for {len(self.t)} stamps. Put the stamp where the first interval begins first."
                )
            put(self, name, shaped(name, rows, (len(self.t) - 1, 3)))
        put(self, "t0_ns", int(self.t0_ns))

    def __len__(self) -> int:
        return len(self.dtheta)

    def mean_rates(self) -> ImuRecording:
        """Mean rate dtheta / dt and mean specific force dv / dt of every interval, stamped at its end.

        What pictures, Allan deviations and filters take; coning and sculling of the interval stay in them as means.
        """
        dt = np.diff(self.t)[:, None]
        return ImuRecording(
            t=read_only(self.t[1:]),
            gyro=read_only(self.dtheta / dt),
            accel=read_only(self.dv / dt),
            t0_ns=self.t0_ns,
            name=self.name,
        )

    def card(self) -> Card:
        """What the increments of each kind span."""
        parts = (("dtheta", "rad", self.dtheta), ("dv", "m/s", self.dv), ("dp", "m", self.dp))
        rows = [(name, unit, "S", span(x)) for name, unit, x in parts if x is not None]
        return Card(course(self, self.t), ("", "unit", "frame", "span"), rows)
