"""Turns a Motion into a picture of its path in space, with the body and its sensors along it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from kreisel.data.motion import Motion, Mount
from kreisel.show import body, style
from kreisel.show.scene import Stage, as_seen, furnish, place, sensor_path, stage

_BODIES = 9
_BODY_SHARE = 0.14


def plot_path(motion: Motion, mounts: Sequence[Mount] = ()) -> Figure:
    """The path in N as seen from south-east and above, with the body drawn at several places along it.

    The body is a red wedge, nose along x_B, drawn larger than life where the path is long; its centre of mass
    is yellow, each of `mounts` violet and truly where it is, with its own path as a thin line.
    Raises ValueError for a motion without samples.
    """
    if not len(motion):
        raise ValueError("The motion has no samples and so no path; sample it at one time or more.")
    figure = Figure(figsize=(9.0, 7.0), dpi=style.DPI, facecolor=style.PAPER)
    figure.text(
        0.02, 0.955, _title(motion, mounts), fontsize=style.TITLE_SIZE, color=style.INK, fontweight="bold"
    )
    scene: Axes3D = figure.add_axes((0.0, 0.0, 1.0, 0.94), projection="3d")
    on = stage(motion, mounts, _BODY_SHARE)
    furnish(scene, on)
    place(scene, 0.09, 0.09, 0.90, 0.86)
    rows = body.instants(as_seen(motion.p_NB), 1.4 * on.length, _BODIES)
    _draw_bodies(scene, motion, rows, on.length)
    handles = [*_draw_paths(scene, on, mounts), *_draw_dots(scene, motion, mounts, rows, on)]
    wedge = Polygon([(0.0, 0.0)], facecolor=style.BODY, label="body, nose forward")
    figure.legend(
        handles=[wedge, *handles],
        loc="upper left",
        bbox_to_anchor=(0.012, 0.945),
        ncols=3,
        frameon=False,
        fontsize=style.TICK_SIZE,
        labelcolor=style.INK,
    )
    return figure


def _draw_bodies(scene: Axes3D, motion: Motion, rows: npt.NDArray[np.intp], length: float) -> None:
    polygons = [face for k in rows for face in body.faces(motion.p_NB[k], motion.R_NB[k], length)]
    bodies = Poly3DCollection(
        polygons, facecolors=body.FACE_COLOURS * len(rows), edgecolors=style.BODY_BELOW, linewidths=0.4
    )
    bodies.set(zorder=3.0, gid="bodies")
    scene.add_collection3d(bodies, autolim=False)
    # The box is placed to fill the figure and may stick out of its axes.
    bodies.set_clip_on(False)


def _draw_paths(scene: Axes3D, on: Stage, mounts: Sequence[Mount]) -> list[Line2D]:
    """The path of the centre of mass, and of each sensor that is not at it."""
    look = {"linewidth": 1.4, "color": style.PATH, "label": "path of the centre of mass"}
    lines = list(scene.plot(*on.path.T, zorder=2.0, **look))
    for k, (path, mount) in enumerate(zip(on.sensors, mounts, strict=True)):
        if mount.p_BS.any():
            scene.plot(*path.T, color=style.IMU[k % len(style.IMU)], linewidth=0.7, alpha=0.7, zorder=2.5)
    return lines


def _draw_dots(
    scene: Axes3D, motion: Motion, mounts: Sequence[Mount], rows: npt.NDArray[np.intp], on: Stage
) -> list[Line2D]:
    """Centre of mass and sensors at `rows`, and the start."""
    look = {"linestyle": "none", "markeredgewidth": 0.6, "markeredgecolor": style.INK}
    mass = {"marker": "o", "markersize": 5.5, "color": style.MASS, "label": "centre of mass", **look}
    handles = list(scene.plot(*motion.p_NB[rows].T, zorder=5.0, **mass))
    for k, mount in enumerate(mounts):
        at = sensor_path(motion, mount)[rows]
        marker = style.IMU_MARKERS[k % len(style.IMU_MARKERS)]
        dots = {"marker": marker, "markersize": 5.0, "color": style.IMU[k % len(style.IMU)]}
        handles += scene.plot(*at.T, zorder=6.0, label=_name(mount, k, mounts), **{**look, **dots})
    ring = {"marker": "o", "markersize": 13.0, "markerfacecolor": "none", "markeredgewidth": 1.4}
    (start,) = scene.plot(
        *motion.p_NB[:1].T, zorder=7.0, linestyle="none", color=style.INK, label="start", **ring
    )
    start.set_path_effects([withStroke(linewidth=3.5, foreground=style.PAPER)])  # seen on dark red too
    handles.append(start)
    return handles


def _name(mount: Mount, k: int, mounts: Sequence[Mount]) -> str:
    """A mount's name for the legend; numbered where names repeat."""
    name = "IMU" if mount.name == "imu" else mount.name
    return name if [m.name for m in mounts].count(mount.name) == 1 else f"{name} {k + 1}"


def _title(motion: Motion, mounts: Sequence[Mount]) -> str:
    what = "path of the body" + (" and of its IMU" + "s" * (len(mounts) > 1) if mounts else "")
    return f"{motion.name}: {what}" if motion.name else what[0].upper() + what[1:]
