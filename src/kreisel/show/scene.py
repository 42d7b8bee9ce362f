"""Turns the points of a path into the box they are seen in: equal scales, a floor, labelled axes of N."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import proj3d
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from kreisel.data.checks import Array
from kreisel.data.motion import Motion, Mount
from kreisel.show import body, style
from kreisel.show.series import ROUND_OFF
from kreisel.show.thinning import along_path

# Sides of the box are at least this share of its longest: a plane path is seen in a room, not in a slot.
_FLATTEST = 0.3
_ELEVATION_DEG, _AZIMUTH_DEG = 27.0, -58.0  # of the eye, seen from the scene


@dataclass(frozen=True, slots=True)
class Stage:
    """What is drawn of a motion, and at which scale."""

    path: Array  # (k, 3) m, p_NB thinned
    sensors: tuple[Array, ...]  # (k, 3) m each, p_NS thinned
    low: Array  # (3,) m, corners of the box
    high: Array  # (3,) m
    length: float  # m, the body's, as drawn


def stage(motion: Motion, mounts: Sequence[Mount], share: float) -> Stage:
    """Box and scale for `motion`: the body is drawn as long as `share` of the longest side of its path."""
    return staged(motion.p_NB, [sensor_path(motion, mount) for mount in mounts], mounts, share)


def staged(p_NB: Array, sensors: Sequence[Array], mounts: Sequence[Mount], share: float) -> Stage:
    """The same for a path (n, 3), m, and those of the IMUs at `mounts`, where they are known."""
    sides = np.ptp(p_NB, axis=0)
    extent = float(sides.max()) if sides.max() > ROUND_OFF else 0.0
    reach = max((float(np.linalg.norm(mount.p_BS)) for mount in mounts), default=0.0)
    length = body.drawn_length(extent, reach, share)
    paths = [p_NB, *sensors]
    # A thousandth of the picture is less than a pixel.
    thin = [p[along_path(p, 1e-3 * max(extent, length))] for p in paths]
    low, high = (np.array([getattr(p, side)(axis=0) for p in thin]) for side in ("min", "max"))
    low, high = low.min(axis=0) - 0.6 * length, high.max(axis=0) + 0.6 * length
    centre, half = 0.5 * (low + high), 0.5 * (high - low)
    half = np.maximum(half, _FLATTEST * half.max())
    return Stage(thin[0], tuple(thin[1:]), centre - half, centre + half, length)


def sensor_path(motion: Motion, mount: Mount) -> Array:
    """p_NS (n, 3), m: where the sensor at `mount` is."""
    return np.asarray(motion.p_NB + motion.R_NB @ mount.p_BS)


def as_seen(p_N: Array) -> Array:
    """Points (n, 3) in N as the eye sees them from far, without depth: (n, 2) m, to the right and up."""
    (ce, se), (ca, sa) = ((np.cos(a), np.sin(a)) for a in np.deg2rad([_ELEVATION_DEG, _AZIMUTH_DEG]))
    return np.asarray(p_N @ np.array([[-sa, -se * ca], [ca, -se * sa], [0.0, ce]]))


def furnish(scene: Axes3D, on: Stage) -> None:
    """Give `scene` the limits, equal scales, grid and labels of a stage, and the shadow of its path."""
    scene.computed_zorder = False
    scene.view_init(elev=_ELEVATION_DEG, azim=_AZIMUTH_DEG)
    scene.set(xlim=(on.low[0], on.high[0]), ylim=(on.low[1], on.high[1]), zlim=(on.low[2], on.high[2]))
    scene.set_box_aspect(tuple(on.high - on.low))
    sides = on.high - on.low
    labelled = zip((scene.xaxis, scene.yaxis, scene.zaxis), ("east", "north", "up"), sides, strict=True)
    for axis, label, side in labelled:
        axis.set_pane_color(style.PANEL)
        axis.line.set(color=style.FAINT_INK, linewidth=0.7)
        axis.set_major_locator(MaxNLocator(5 if side > 0.6 * sides.max() else 3))
        axis.set_label_text(f"{label} [m]", fontsize=style.LABEL_SIZE, color=style.INK)
        axis.labelpad = 7.0
        axis.set_tick_params(labelsize=style.TICK_SIZE, labelcolor=style.INK, color=style.GRID)
    _draw_grid(scene, on)
    x, y, _ = on.path.T
    scene.plot(x, y, np.full(len(x), on.low[2]), color=style.SHADOW, linewidth=1.0, zorder=1.0)


def place(scene: Axes3D, left: float, bottom: float, right: float, top: float) -> None:
    """Zoom and shift `scene` until its box fills a part of the figure, given in fractions of the figure.

    A flat box would otherwise leave most of a figure empty, and a cube overlap its title.
    """
    for _ in range(3):  # perspective makes the size only nearly proportional to the zoom
        box = seen_box(scene)
        at, size = scene.get_position(), box[1] - box[0]
        zoom = min((right - left) / size[0], (top - bottom) / size[1])
        width, height = at.width * zoom, at.height * zoom
        shift = 0.5 * (box[0] + box[1]) - (0.5 * (at.x0 + at.x1), 0.5 * (at.y0 + at.y1))
        x, y = np.array([0.5 * (left + right), 0.5 * (bottom + top)]) - zoom * shift
        scene.set_position((x - 0.5 * width, y - 0.5 * height, width, height))


def seen_box(scene: Axes3D) -> Array:
    """Lower left and upper right corner (2, 2) of the box as it is seen, in fractions of the figure."""
    scene.apply_aspect()
    corners = np.array(np.meshgrid(scene.get_xlim(), scene.get_ylim(), scene.get_zlim())).reshape(3, -1)
    x, y, _ = proj3d.proj_transform(*corners, scene.get_proj())
    to_figure = scene.transData - scene.get_figure().transFigure
    seen = to_figure.transform(np.column_stack([x, y]))
    return np.array([seen.min(axis=0), seen.max(axis=0)])


def _draw_grid(scene: Axes3D, on: Stage) -> None:
    """Thin lines on floor and back walls; matplotlib's own grid takes its colour from rcParams alone."""
    scene.grid(False)
    (x0, y0, z0), (x1, y1, z1) = on.low, on.high
    at = [
        [float(v) for v in axis.get_majorticklocs() if low < v < high]
        for axis, low, high in zip((scene.xaxis, scene.yaxis, scene.zaxis), on.low, on.high, strict=True)
    ]
    lines = [[(x, y0, z0), (x, y1, z0), (x, y1, z1)] for x in at[0]]
    lines += [[(x1, y, z0), (x0, y, z0), (x0, y, z1)] for y in at[1]]
    lines += [[(x0, y0, z), (x0, y1, z), (x1, y1, z)] for z in at[2]]
    scene.add_collection3d(
        Line3DCollection(lines, colors=style.GRID_IN_SPACE, linewidths=0.7, zorder=0.5, clip_on=False),
        autolim=False,
    )
