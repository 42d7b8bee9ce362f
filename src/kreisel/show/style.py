"""Turns a bare matplotlib figure or axes into one that looks like kreisel's: colours, fonts and sizes.

Everything is set on the objects themselves: no rcParams, no pyplot, no state that outlives a figure.
"""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

# Vermillion, bluish green and blue of Okabe and Ito, "Color universal design" (2008): told apart with every
# kind of colour blindness, and still the red, green, blue that people expect of x, y, z.
XYZ = ("#D55E00", "#009E73", "#0072B2")
XYZ_DARK = ("#7A3600", "#00543D", "#003A5C")

BODY = "#D7263D"
BODY_SIDE = "#A31B2D"
BODY_BELOW = "#6E1420"
MASS = "#FFC914"
IMU = ("#7B2CBF", "#C77DFF", "#5A189A", "#E0AAFF")  # one violet for each IMU on the body
IMU_MARKERS = ("o", "s", "^", "D")
PATH = "#3D4B5C"
SHADOW = "#D3D8DE"
NOTE = "#8A6D00"
MISSING = "#C2185B"
TRUTH = "#AEB9C4"
UNCOUNTED = "#B9C2CB"
FLAG_REST = "#7A8B99"
FLAG_DISTURBED = "#E69F00"
OTHERS = ("#22303C", "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9")

INK = "#22303C"
FAINT_INK = "#5C6B7A"
GRID = "#E2E6EA"
GRID_IN_SPACE = "#D4DAE0"
PANEL = "#FBFCFD"
PAPER = "#FFFFFF"

TITLE_SIZE = 13.0
CAPTION_SIZE = 10.0
LABEL_SIZE = 9.5
TICK_SIZE = 8.5
LINE_WIDTH, DENSE_LINE_WIDTH, DENSE_ALPHA = 1.3, 0.8, 0.8
DPI = 144


def stacked(rows: int, title: str) -> tuple[Figure, list[Axes]]:
    """A figure of `rows` panels that share their time axis, and those panels from top to bottom."""
    figure = Figure(figsize=(9.0, 0.9 + 2.1 * rows), dpi=DPI, facecolor=PAPER)
    figure.set_layout_engine("constrained", h_pad=0.06, w_pad=0.08, hspace=0.03, rect=(0.0, 0.0, 1.0, 0.99))
    figure.suptitle(title, x=0.015, ha="left", fontsize=TITLE_SIZE, color=INK, fontweight="bold")
    panels = list(figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0])
    for axes in panels:
        dress(axes)
    panels[-1].set_xlabel("time [s]", fontsize=LABEL_SIZE, color=INK)
    return figure, panels


def dress(axes: Axes) -> None:
    """Thin grid on a light panel, quiet spines, readable ticks."""
    axes.set_facecolor(PANEL)
    axes.grid(True, color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(FAINT_INK)
        spine.set_linewidth(0.7)
    axes.tick_params(labelsize=TICK_SIZE, labelcolor=INK, color=FAINT_INK, width=0.7, length=3.0)
    # Left of the axis, where the caption of the panel is not.
    axes.yaxis.get_offset_text().set(fontsize=TICK_SIZE, color=FAINT_INK, x=-0.05)


def caption(axes: Axes, text: str, quantity: str) -> None:
    """What a panel shows, above it, and its quantity with unit on its vertical axis."""
    axes.set_title(text, loc="left", fontsize=CAPTION_SIZE, color=INK, pad=5.0)
    axes.set_ylabel(quantity, fontsize=LABEL_SIZE, color=INK)
