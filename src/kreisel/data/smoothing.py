"""What smoothing found out about noisy samples."""

from __future__ import annotations

from dataclasses import dataclass

from kreisel.data.cards import Shown
from kreisel.data.checks import Array


@dataclass(frozen=True, slots=True, eq=False)
class Smoothing(Shown):
    """Noise and mistakes in samples of positions (m, along the axes of N) or attitudes (rad, about those of B)."""

    sigma: Array  # (3,) standard deviation of the noise that was taken out: as given, else as found
    found: Array  # (3,) the same as the samples show it
    memory: Array  # (3,) s, the noise is correlated as exp(-dt / memory); 0 where it is white
    outliers: Array  # (m,) s, samples that were set aside
    jumps: Array  # (m,) s, without which the parts of the recording were joined
    rough: Array  # (m,) s, where the samples are rougher than elsewhere, by neither outliers nor a jump
