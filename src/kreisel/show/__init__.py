"""Draws what was computed and computes nothing: figures and animations, made without a display.

Names are loaded at first use, so that importing this package does not load matplotlib.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kreisel.show.allan import plot_allan as plot_allan
    from kreisel.show.animation import animate as animate
    from kreisel.show.attitude import plot_attitude as plot_attitude
    from kreisel.show.attitude import plot_attitude_errors as plot_attitude_errors
    from kreisel.show.attitude import plot_bias as plot_bias
    from kreisel.show.broad import plot_broad as plot_broad
    from kreisel.show.calibration import plot_calibration as plot_calibration
    from kreisel.show.ensemble import plot_ensembles as plot_ensembles
    from kreisel.show.ensemble import plot_fans as plot_fans
    from kreisel.show.ensemble import plot_histograms as plot_histograms
    from kreisel.show.ensemble import plot_tornado as plot_tornado
    from kreisel.show.path import plot_path as plot_path
    from kreisel.show.plots import plot_angular as plot_angular
    from kreisel.show.plots import plot_imu as plot_imu
    from kreisel.show.plots import plot_linear as plot_linear
    from kreisel.show.report import write_report as write_report
    from kreisel.show.saving import save as save
    from kreisel.show.twin import plot_twin as plot_twin
    from kreisel.show.viewer import save_rerun as save_rerun

_HOMES = {
    "animate": "kreisel.show.animation",
    "plot_allan": "kreisel.show.allan",
    "plot_angular": "kreisel.show.plots",
    "plot_attitude": "kreisel.show.attitude",
    "plot_attitude_errors": "kreisel.show.attitude",
    "plot_bias": "kreisel.show.attitude",
    "plot_broad": "kreisel.show.broad",
    "plot_calibration": "kreisel.show.calibration",
    "plot_ensembles": "kreisel.show.ensemble",
    "plot_fans": "kreisel.show.ensemble",
    "plot_histograms": "kreisel.show.ensemble",
    "plot_imu": "kreisel.show.plots",
    "plot_linear": "kreisel.show.plots",
    "plot_path": "kreisel.show.path",
    "plot_tornado": "kreisel.show.ensemble",
    "plot_twin": "kreisel.show.twin",
    "save": "kreisel.show.saving",
    "save_rerun": "kreisel.show.viewer",
    "write_report": "kreisel.show.report",
}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'kreisel.show' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
