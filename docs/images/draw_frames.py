"""Turns the conventions of docs/frames.md into its pictures, beside this script.

Run: .venv/bin/python docs/images/draw_frames.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Arc, FancyArrowPatch, Polygon

from kreisel.maths.rotations import matrix_from_euler
from kreisel.show import body, style

HERE = Path(__file__).parent
ELEVATION, AZIMUTH = np.deg2rad([24.0, -62.0])  # of the eye
Names = tuple[str, str, str]
VIOLET = style.IMU[0]
GREY = style.FAINT_INK


def main() -> None:
    save(draw_frames(), "frames.png")
    save(draw_worlds(), "worlds.png")
    save(draw_angles(), "angles.png")


# --- the pictures ---


def draw_frames() -> Figure:
    """N on the ground, B on the body, S on its lever arm, and the vectors between them."""
    figure, (axes,) = sheet(9.0, 4.5, 1)
    ground(axes, (-0.5, 5.0), (-0.5, 1.5))
    origin, place = np.zeros(3), np.array([3.1, 0.9, 1.25])
    R_NB = matrix_from_euler(np.deg2rad([8.0, -8.0, 62.0]))
    sensor, R_NS = (
        place + R_NB @ [0.35, -1.15, 0.1],
        R_NB @ matrix_from_euler(np.deg2rad([-8.0, 10.0, 158.0])),
    )
    drop(axes, place)
    triad(axes, origin, np.eye(3), 1.3, ("x east", "y true north", "z up"), "N", at=(-0.14, -0.12))
    vector(axes, origin, place, style.PATH, "p_NB", 0.5, (-0.02, -0.17))
    wedge(axes, place, R_NB, 1.6)
    triad(axes, place, R_NB, 1.3, ("x forward", "y left", "z up"), "B", at=(-0.2, 0.01))
    vector(axes, place, sensor, VIOLET, "p_BS", 0.72, (-0.3, -0.12))
    axes.plot(*seen(sensor), "o", color=VIOLET, markersize=6.5, zorder=9)
    triad(axes, sensor, R_NS, 0.62, ("x", "y", "z"), "S", at=(0.17, 0.04), colour=VIOLET)
    axes.plot(*seen(place), "o", color=style.MASS, markeredgecolor=style.INK, markersize=7.5, zorder=9)
    lines = (
        ("v_N = R_NB v_B", "the columns of R_NB are the axes of B in N"),
        ("v_B = R_BS v_S", "how the sensor is turned on the body"),
        ("p_NS = p_NB + R_NB p_BS", "where it is"),
    )
    for k, (formula, text) in enumerate(lines):
        y = 0.97 - 0.058 * k
        axes.text(0.005, y, formula, transform=axes.transAxes, color=style.INK, fontsize=9.5)
        axes.text(0.25, y, text, transform=axes.transAxes, color=GREY, fontsize=9.5)
    return figure


def draw_worlds() -> Figure:
    """The same body in ENU/FLU and in NED/FRD: other names for the same directions."""
    figure, panels = sheet(10.6, 3.9, 2)
    ned, frd = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]), np.diag([1.0, -1.0, -1.0])
    ours = ("x east", "y north", "z up"), ("x forward", "y left", "z up")
    theirs = ("x north", "y east", "z down"), ("x forward", "y right", "z down")
    draw_world(panels[0], "enu-flu: ours, and ROS", np.eye(3), np.eye(3), ours, "+")
    draw_world(panels[1], "ned-frd: aerospace", ned, frd, theirs, "-")
    return figure


def draw_world(
    axes: Axes, title: str, N: np.ndarray, B: np.ndarray, names: tuple[Names, Names], sign: str
) -> None:
    """N and B with the columns of `N` and `B` as their axes, in our N and our B, and what gravity reads there."""
    up = B[2, 2] > 0.0
    R_NB, place = matrix_from_euler(np.deg2rad([0.0, 0.0, 62.0])), np.array([2.6, 0.9, 1.45])
    ground(axes, (-0.7, 4.4), (-0.4, 1.6))
    triad(axes, np.zeros(3), N, 1.1, names[0], "N", at=(-0.16, -0.12 if up else 0.12))
    drop(axes, place)
    wedge(axes, place, R_NB, 1.6)
    tail = place + R_NB @ [0.5, 0.0, 0.0]
    force = tail + np.array([0.0, 0.0, 1.35])
    vector(axes, tail, force, GREY, "", 0.0, (0.0, 0.0), width=2.6)
    axes.text(
        *(seen(force) + np.array([0.12, -0.08])),
        f"at rest\naccel = (0, 0, {sign}g)",
        color=GREY,
        fontsize=9.5,
        va="top",
    )
    triad(axes, place, R_NB @ B, 1.15, names[1], "B", at=(-0.2, 0.01))
    axes.plot(*seen(place), "o", color=style.MASS, markeredgecolor=style.INK, markersize=7.5, zorder=9)
    axes.set_title(title, loc="left", fontsize=11.5, color=style.INK, fontweight="bold")


def draw_angles() -> Figure:
    """Which way each angle counts, and which way declination does."""
    figure, (heading, declination, pitch, roll) = sheet(9.6, 6.6, 4)
    draw_heading(heading)
    draw_declination(declination)
    draw_pitch(pitch)
    draw_roll(roll)
    for axes in (heading, declination):
        axes.set(xlim=(-1.55, 1.85), ylim=(-0.65, 1.45))
    for axes in (pitch, roll):
        axes.set(xlim=(-1.55, 1.85), ylim=(-0.58, 1.0))
    return figure


def draw_heading(axes: Axes) -> None:
    """Seen from above: phi_z from east to the left, yaw of NED from north to the right."""
    caption(axes, "heading, seen from above", "phi_z > 0 turns left; in NED, yaw = 90° - phi_z")
    compass(axes)
    nose = np.deg2rad(35.0)
    flat(axes, nose, ((2 / 3, 0.0), (-1 / 3, 0.36), (-1 / 3, -0.36)))
    arrow(axes, (0, 0), 1.2 * np.array([np.cos(nose), np.sin(nose)]), style.BODY, 1.6)
    sweep(axes, 0.78, 0.0, 35.0, style.XYZ[2], "phi_z", (0.0, 0.0))
    sweep(axes, 0.96, 90.0, 35.0, GREY, "yaw in NED", (0.0, 0.05))


def draw_declination(axes: Axes) -> None:
    """Seen from above: magnetic north east of true north is positive."""
    caption(axes, "declination, seen from above", "positive where magnetic north lies east of true north")
    compass(axes)
    east = np.deg2rad(90.0 - 24.0)
    arrow(axes, (0, 0), 1.15 * np.array([np.cos(east), np.sin(east)]), style.OTHERS[4], 2.2)
    axes.text(0.52, 1.08, "magnetic north", color=style.OTHERS[4], fontsize=9.5)
    sweep(axes, 0.72, 90.0, 66.0, style.INK, "declination", (-0.86, 0.0))
    axes.text(-1.5, -0.35, "level, nose to true north, mag_uT reads x > 0", color=GREY, fontsize=9.5)
    axes.text(-1.5, -0.53, "and, where declination is positive, y < 0", color=GREY, fontsize=9.5)


def draw_pitch(axes: Axes) -> None:
    """Seen from the right, nose to the right: positive is nose down."""
    caption(axes, "pitch, seen from the right", "phi_y > 0 is nose down; in NED, nose up")
    horizon(axes)
    down = np.deg2rad(-22.0)
    flat(axes, down, ((2 / 3, 0.05), (2 / 3, -0.05), (-1 / 3, -0.05), (-1 / 3, 0.05)))
    arrow(
        axes,
        (0, 0),
        1.25 * np.array([np.cos(down), np.sin(down)]),
        style.XYZ[0],
        2.0,
        "x forward",
        (0.03, -0.13),
    )
    arrow(
        axes, (0, 0), 0.85 * np.array([-np.sin(down), np.cos(down)]), style.XYZ[2], 2.0, "z up", (0.05, -0.02)
    )
    into_page(axes, (0.0, 0.0), style.XYZ[1], "y left, into the page", (-1.5, 0.12))
    sweep(axes, 0.95, 0.0, -22.0, style.XYZ[1], "phi_y", (0.04, 0.03))


def draw_roll(axes: Axes) -> None:
    """Seen from behind: positive is the right side down, in FLU and in FRD."""
    caption(axes, "roll, seen from behind", "phi_x > 0 is right side down; in NED too")
    horizon(axes)
    tilt = np.deg2rad(-22.0)
    flat(axes, tilt, ((0.62, 0.05), (0.62, -0.05), (-0.62, -0.05), (-0.62, 0.05)))
    left = 1.25 * np.array([-np.cos(tilt), -np.sin(tilt)])
    arrow(axes, (0, 0), left, style.XYZ[1], 2.0, "y left", (-0.05, 0.08))
    arrow(
        axes, (0, 0), 0.85 * np.array([-np.sin(tilt), np.cos(tilt)]), style.XYZ[2], 2.0, "z up", (0.05, -0.02)
    )
    into_page(axes, (0.0, 0.0), style.XYZ[0], "x forward, into the page", (0.62, -0.2))
    sweep(axes, 0.95, 180.0, 158.0, style.XYZ[0], "phi_x", (-0.36, 0.0))


# --- in three dimensions ---


def seen(p_N: np.ndarray) -> np.ndarray:
    """(2,) to the right and up, of a point in N seen from far away."""
    (ce, se), (ca, sa) = ((np.cos(a), np.sin(a)) for a in (ELEVATION, AZIMUTH))
    return np.asarray(p_N) @ np.array([[-sa, -se * ca], [ca, -se * sa], [0.0, ce]])


def towards_eye() -> np.ndarray:
    ce, se = np.cos(ELEVATION), np.sin(ELEVATION)
    return np.array([ce * np.cos(AZIMUTH), ce * np.sin(AZIMUTH), se])


def ground(axes: Axes, east: tuple[float, float], north: tuple[float, float]) -> None:
    """A grid on the plane z = 0."""
    corners = [(east[0], north[0], 0), (east[1], north[0], 0), (east[1], north[1], 0), (east[0], north[1], 0)]
    axes.add_patch(Polygon(seen(np.array(corners)), facecolor=style.PANEL, edgecolor="none", zorder=0))
    for x in np.arange(np.ceil(east[0] * 2) / 2, east[1] + 1e-9, 0.5):
        axes.plot(*seen(np.array([(x, north[0], 0), (x, north[1], 0)])).T, color=style.GRID, lw=0.8, zorder=1)
    for y in np.arange(np.ceil(north[0] * 2) / 2, north[1] + 1e-9, 0.5):
        axes.plot(*seen(np.array([(east[0], y, 0), (east[1], y, 0)])).T, color=style.GRID, lw=0.8, zorder=1)


def drop(axes: Axes, p: np.ndarray) -> None:
    """The plumb line from a point to the ground, and its foot."""
    foot = p * [1.0, 1.0, 0.0]
    axes.plot(*seen(np.array([p, foot])).T, color=style.SHADOW, lw=1.2, ls=(0, (4, 3)), zorder=2)
    axes.plot(*seen(foot), "o", color=style.SHADOW, markersize=4.0, zorder=2)


def triad(
    axes: Axes,
    origin: np.ndarray,
    R: np.ndarray,
    length: float,
    names: Names,
    letter: str,
    at: tuple[float, float],
    colour: str | None = None,
) -> None:
    """Three axes, the columns of R, with their names at their tips and the frame's letter at the origin."""
    for k in np.argsort(R.T @ towards_eye()):
        tip = origin + length * R[:, k]
        tint = colour or style.XYZ[k]
        arrow(axes, seen(origin), seen(tip), tint, 1.6 if colour else 2.3)
        way = seen(tip) - seen(origin)
        way = way / max(float(np.linalg.norm(way)), 0.3 * length)
        beside = "left" if way[0] > 0.25 else "right" if way[0] < -0.25 else "center"
        place = seen(tip) + 0.10 * way
        axes.text(*place, names[k], color=tint, fontsize=9.5, ha=beside, va="center", zorder=10)
    axes.text(
        *(seen(origin) + at), letter, color=colour or style.INK, fontsize=13, fontweight="bold",
        ha="center", va="center", zorder=10,
    )  # fmt: skip


def vector(
    axes: Axes,
    begin: np.ndarray,
    end: np.ndarray,
    colour: str,
    name: str,
    share: float,
    shift: tuple[float, float],
    width: float = 1.8,
) -> None:
    """An arrow between two points, named at a share of its way."""
    arrow(axes, seen(begin), seen(end), colour, width)
    axes.text(
        *(seen(begin + share * (end - begin)) + shift),
        name,
        color=colour,
        fontsize=10.5,
        style="italic",
        zorder=10,
    )


def wedge(axes: Axes, p: np.ndarray, R: np.ndarray, length: float) -> None:
    """The body: those faces of it that look to the eye."""
    for face, colour in zip(body.faces(p, R, length), body.FACE_COLOURS, strict=True):
        if np.cross(face[1] - face[0], face[2] - face[0]) @ towards_eye() > 0.0:
            axes.add_patch(
                Polygon(seen(face), facecolor=colour, edgecolor="white", lw=0.6, alpha=0.9, zorder=4)
            )


# --- on paper ---


def sheet(width: float, height: float, panels: int) -> tuple[Figure, list[Axes]]:
    """White paper with panels that have equal scales and no frames."""
    figure = Figure(figsize=(width, height), dpi=style.DPI, facecolor=style.PAPER)
    figure.set_layout_engine("constrained", h_pad=0.08, w_pad=0.08)
    FigureCanvasAgg(figure)
    rows = 2 if panels > 2 else 1
    found = list(np.ravel(figure.subplots(rows, panels // rows)))
    for axes in found:
        axes.set_aspect("equal")
        axes.margins(0.01)
        axes.axis("off")
    return figure, found


def arrow(
    axes: Axes,
    begin: object,
    end: object,
    colour: str,
    width: float,
    name: str = "",
    shift: tuple[float, float] = (0.0, 0.0),
) -> None:
    head = f"-|>,head_length={3.0 + 1.6 * width},head_width={1.4 + 0.8 * width}"
    patch = FancyArrowPatch(
        begin, end, arrowstyle=head, color=colour, lw=width, shrinkA=0, shrinkB=0, zorder=6
    )
    patch.set(capstyle="butt", joinstyle="miter")
    axes.add_patch(patch)
    # A patch alone does not widen the limits.
    axes.update_datalim([begin, end])
    axes.autoscale_view()
    if name:
        axes.text(end[0] + shift[0], end[1] + shift[1], name, color=colour, fontsize=9.5)


def sweep(
    axes: Axes, radius: float, begin: float, end: float, colour: str, name: str, shift: tuple[float, float]
) -> None:
    """An arc from one angle to another, deg, with a head at its end and a name beside its middle."""
    axes.add_patch(
        Arc(
            (0, 0),
            2 * radius,
            2 * radius,
            theta1=min(begin, end),
            theta2=max(begin, end),
            color=colour,
            lw=1.5,
        )
    )
    near, last = np.deg2rad([end - np.sign(end - begin) * 3.0, end])
    points = [radius * np.array([np.cos(a), np.sin(a)]) for a in (near, last)]
    arrow(axes, *points, colour, 1.2)
    middle = np.deg2rad(0.5 * (begin + end))
    x, y = (radius + 0.06) * np.array([np.cos(middle), np.sin(middle)]) + shift
    axes.text(x, y, name, color=colour, fontsize=10.0, style="italic", va="center")


def flat(axes: Axes, angle: float, outline: tuple[tuple[float, float], ...]) -> None:
    """The body as a flat shape turned by `angle` rad, its centre of mass in yellow."""
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    axes.add_patch(
        Polygon(
            0.95 * np.array(outline) @ turn.T, facecolor=style.BODY, edgecolor="white", alpha=0.9, zorder=4
        )
    )
    axes.plot(0, 0, "o", color=style.MASS, markeredgecolor=style.INK, markersize=7.5, zorder=9)


def compass(axes: Axes) -> None:
    """East to the right, true north upwards."""
    arrow(axes, (0, 0), (1.2, 0.0), style.SHADOW, 1.6)
    arrow(axes, (0, 0), (0.0, 1.2), style.SHADOW, 1.6)
    axes.text(1.25, 0.0, "east", color=GREY, fontsize=9.5, va="center")
    axes.text(0.0, 1.25, "true north", color=GREY, fontsize=9.5, ha="center", va="bottom")


def horizon(axes: Axes) -> None:
    axes.plot((-1.4, 1.4), (0.0, 0.0), color=style.SHADOW, lw=1.2, ls=(0, (4, 3)), zorder=1)


def into_page(
    axes: Axes, at: tuple[float, float], colour: str, name: str, label: tuple[float, float]
) -> None:
    """The tail of an arrow that points away from the reader."""
    axes.plot(*at, "o", color="white", markeredgecolor=colour, markeredgewidth=1.8, markersize=13, zorder=10)
    axes.plot(*at, "x", color=colour, markersize=7, markeredgewidth=1.8, zorder=11)
    axes.text(*label, name, color=colour, fontsize=9.5)


def caption(axes: Axes, title: str, text: str) -> None:
    axes.set_title(f"{title}\n", loc="left", fontsize=11.5, color=style.INK, fontweight="bold")
    axes.text(0.0, 1.015, text, transform=axes.transAxes, color=GREY, fontsize=9.5, va="bottom")


def save(figure: Figure, name: str) -> None:
    # Without the version of matplotlib: the same picture is the same file.
    figure.savefig(HERE / name, metadata={"Software": None})


if __name__ == "__main__":
    main()
