"""Turns a Motion into pictures of the body at any of its rows, fast enough for an animation.

Everything that stands still is drawn once. A picture is a copy of that, with the few things that move drawn
over it in pixels of the figure.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import IdentityTransform
from mpl_toolkits.mplot3d import proj3d
from mpl_toolkits.mplot3d.axes3d import Axes3D

from kreisel.data.checks import Array
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.show import body, series, style
from kreisel.show.scene import furnish, place, sensor_path, stage

Picture = npt.NDArray[np.uint8]

_DPI = 100
_BODY_SHARE = 0.27
_TRAIL_PIECES, _POINTS_PER_PIECE = 16, 5
_TRAIL = tuple(
    to_hex(1.0 + age * (np.array(to_rgb(style.BODY)) - 1.0)) for age in np.linspace(0.2, 1.0, _TRAIL_PIECES)
)
_WHOLE_PATH = "#A9B3BE"
_PALE_XYZ = ("#F6DCC9", "#C9E9DF", "#C9DFEE")

_PARTS = (style.PAPER, style.PANEL, style.BODY, style.BODY_SIDE, style.BODY_BELOW, style.MASS, style.INK)
COLOURS = (*_PARTS, *style.IMU, *style.XYZ, *_PALE_XYZ, *_TRAIL, style.GRID, style.GRID_IN_SPACE)
"""Colours a palette for these pictures has to hold."""


class Film:
    """Pictures of one motion: the body on its path and, given a recording, what its IMU reads beside it."""

    def __init__(self, motion: Motion, mounts: Sequence[Mount], recording: ImuRecording | None) -> None:
        alone = recording is None
        self._figure = Figure(figsize=(5.4, 4.6) if alone else (9.4, 4.5), dpi=_DPI, facecolor=style.PAPER)
        self._canvas = FigureCanvasAgg(self._figure)
        self._figure.text(0.015, 0.975, motion.name, va="top", fontsize=11.0, color=style.INK, weight="bold")
        self._body = _BodyOnPath(self._figure, motion, mounts, 1.0 if alone else 0.55)
        self._readings = [] if recording is None else _readings(self._figure, motion, recording)
        self._t = motion.t
        self._clock = self._figure.text(0.985, 0.975, "", va="top", ha="right", fontsize=11.0, animated=True)
        self._clock.set(color=style.INK, family="monospace")
        self._pale, self._full = (self._background(pale) for pale in (True, False))

    def picture(self, row: int) -> Picture:
        """The body at `row`, its trail behind it and the readings run up to there: (height, width, 3)."""
        buffer = np.asarray(self._canvas.buffer_rgba())
        buffer[:] = self._pale
        moved = self._body.move(row)
        for readings in self._readings:
            past = readings.past(self._t[row])
            buffer[:, past] = self._full[:, past]
            moved += readings.move(self._t[row])
        self._clock.set_text(f"{self._t[row]:.2f} s")
        for artist in (*moved, self._clock):
            self._figure.draw_artist(artist)
        return buffer[..., :3].copy()

    def _background(self, pale: bool) -> Any:
        """What stands still, the curves pale or in full colour."""
        for readings in self._readings:
            for line, colour in zip(readings.curves, _PALE_XYZ if pale else style.XYZ, strict=True):
                line.set_color(colour)
        self._canvas.draw()
        return np.asarray(self._canvas.buffer_rgba()).copy()


class _BodyOnPath:
    """The body, its sensors, its trail and its shadow, moved over a scene that stands still."""

    def __init__(self, figure: Figure, motion: Motion, mounts: Sequence[Mount], right: float) -> None:
        on = stage(motion, mounts, _BODY_SHARE)
        self._scene: Axes3D = figure.add_axes((0.0, 0.0, right, 1.0), projection="3d")
        furnish(self._scene, on)
        self._scene.plot(*on.path.T, color=_WHOLE_PATH, linewidth=1.0, zorder=2.0)
        place(self._scene, 0.09 * right, 0.12, 0.87 * right, 0.93)
        self._motion, self._length, self._floor = motion, on.length, on.low[2]
        self._sensors = [sensor_path(motion, mount) for mount in mounts]
        steps = np.linalg.norm(np.diff(motion.p_NB, axis=0), axis=1)
        self._travelled = np.concatenate([[0.0], np.cumsum(steps)])
        self._trail_length = 1.2 * float(np.ptp(motion.p_NB, axis=0).max())
        self._make_artists(figure)

    def _make_artists(self, figure: Figure) -> None:
        here: dict[str, Any] = {"transform": IdentityTransform(), "animated": True}
        widths = np.linspace(1.0, 3.0, _TRAIL_PIECES)
        self._trail = LineCollection([], colors=_TRAIL, linewidths=widths, capstyle="round", **here)
        self._wedge = PolyCollection([], edgecolors=style.BODY_BELOW, linewidths=0.5, **here)
        for collection in (self._trail, self._wedge):
            figure.add_artist(collection)
        self._shadow = _dot(figure, "o", 6.0, style.SHADOW, style.SHADOW)
        self._dots = [_dot(figure, "o", 7.0, style.MASS, style.INK)]
        for k in range(len(self._sensors)):
            marker, colour = style.IMU_MARKERS[k % len(style.IMU)], style.IMU[k % len(style.IMU)]
            self._dots.append(_dot(figure, marker, 6.5, colour, style.INK))

    def move(self, row: int) -> list[Any]:
        """Put everything where it is at `row`; the artists to draw, in that order."""
        p, R = self._motion.p_NB[row], self._motion.R_NB[row]
        faces = [self._pixels(face) for face in body.faces(p, R, self._length)]
        towards_us = [k for k, face in enumerate(faces) if _area(face) > 0.0]
        self._wedge.set_verts([faces[k] for k in towards_us])
        self._wedge.set_facecolor([body.FACE_COLOURS[k] for k in towards_us])
        self._trail.set_segments(self._trail_behind(row))
        points = [np.array([p[0], p[1], self._floor]), p, *(sensor[row] for sensor in self._sensors)]
        for dot, (x, y) in zip((self._shadow, *self._dots), self._pixels(np.array(points)), strict=True):
            dot.set_data([x], [y])
        return [self._shadow, self._trail, self._wedge, *self._dots]

    def _trail_behind(self, row: int) -> list[Array]:
        """The path behind `row` in pixels, in pieces of equal length, oldest first."""
        back = self._trail_length * np.linspace(1.0, 0.0, _TRAIL_PIECES * _POINTS_PER_PIECE + 1)
        rows = np.searchsorted(self._travelled[: row + 1], self._travelled[row] - back)
        points = self._pixels(self._motion.p_NB[rows])
        starts = range(0, len(points) - 1, _POINTS_PER_PIECE)
        return [points[k : k + _POINTS_PER_PIECE + 1] for k in starts]

    def _pixels(self, points: Array) -> Array:
        """Where points (k, 3) in N are seen: (k, 2), in pixels from the lower left corner of the figure."""
        x, y, _ = proj3d.proj_transform(*points.T, self._scene.get_proj())
        return np.asarray(self._scene.transData.transform(np.column_stack([x, y])))


class _Readings:
    """One panel of readings with a cursor at the present and a dot on each curve."""

    def __init__(self, figure: Figure, axes: Axes, t: Array, values: Array) -> None:
        self.curves = series.draw_components(axes, t, values, linewidth=1.2, alpha=1.0)
        series.fit(axes, t, values)
        self.axes, self._t, self._values = axes, t, values
        here: dict[str, Any] = {"transform": IdentityTransform(), "animated": True}
        self._cursor = Line2D([], [], color=style.FAINT_INK, linewidth=0.9, **here)
        figure.add_artist(self._cursor)
        self._dots = [_dot(figure, "o", 5.5, colour, style.PAPER) for colour in style.XYZ]

    def past(self, now: float) -> slice:
        """Pixel columns of the panel from its left end to `now`."""
        return slice(int(self.axes.bbox.x0), int(self._pixels(now, 0.0)[0]))

    def move(self, now: float) -> list[Any]:
        """Put cursor and dots at `now`; the artists to draw. A missing sample has no dot."""
        x, _ = self._pixels(now, 0.0)
        self._cursor.set_data([x, x], [self.axes.bbox.y0, self.axes.bbox.y1])
        sample = max(int(np.searchsorted(self._t, now, side="right")) - 1, 0)
        for dot, value in zip(self._dots, self._values[sample], strict=True):
            dot.set_data([x], [self._pixels(now, value)[1]])
        return [self._cursor, *self._dots]

    def _pixels(self, t: float, value: float) -> Array:
        return np.asarray(self.axes.transData.transform((t, value)))


def _readings(figure: Figure, motion: Motion, recording: ImuRecording) -> list[_Readings]:
    """Panels for gyro and accelerometer on the right of the figure, over the time of the motion."""
    t = recording.t + (recording.t0_ns - motion.t0_ns) * 1e-9
    rows = (("gyro [rad/s]", recording.gyro), ("accel [m/s²]", recording.accel))
    panels = []
    for k, (quantity, values) in enumerate(rows):
        axes = figure.add_axes((0.615, 0.555 - 0.435 * k, 0.37, 0.335))
        style.dress(axes)
        style.caption(axes, quantity, "")
        panels.append(_Readings(figure, axes, t, values))
        axes.tick_params(labelbottom=k == len(rows) - 1)
    series.legend(panels[0].axes, panels[0].curves)
    axes.set_xlabel("time [s]", fontsize=style.LABEL_SIZE, color=style.INK)
    return panels


def _dot(figure: Figure, marker: str, size: float, colour: str, edge: str) -> Line2D:
    look: dict[str, Any] = {"marker": marker, "markersize": size, "color": colour, "markeredgecolor": edge}
    dot = Line2D([], [], markeredgewidth=0.7, transform=IdentityTransform(), animated=True, **look)
    figure.add_artist(dot)
    return dot


def _area(polygon: Array) -> float:
    """Area of a polygon (k, 2), positive where its corners run counter-clockwise (shoelace formula)."""
    x, y = polygon.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
