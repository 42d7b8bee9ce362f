"""Turns the names of charts into Bokeh plots that share one time axis; the page fills them with lines."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from kreisel.show.series import time_limits

_HEIGHT = 210  # pixels


@dataclass(frozen=True, slots=True)
class Trace:
    """A line of a chart, and the entry of the legend that shows and hides it."""

    name: str
    entry: str
    colour: str  # a colour of the page's palette
    broad: bool = False  # pale and broad, beneath the others


@dataclass(frozen=True, slots=True)
class Chart:
    """Lines that share one vertical axis."""

    name: str
    title: str
    quantity: str  # with its unit
    traces: tuple[Trace, ...]


def _axes(*entries: str) -> tuple[Trace, ...]:
    return tuple(Trace(axis, entry, axis) for axis, entry in zip("xyz", entries, strict=True))


_TRUTH = tuple(Trace(f"true_{axis}", "truth", axis, broad=True) for axis in "xyz")

CHARTS = (
    Chart("attitude", "Attitude of the sensor", "φ [deg]", (*_TRUTH, *_axes("φx", "φy", "φz"))),
    Chart(
        "errors",
        "Error of the estimated attitude",
        "error [deg]",
        (Trace("heading", "heading", "z"), Trace("inclination", "inclination", "x")),
    ),
    Chart("bias", "Gyro bias in sensor axes", "bias [deg/s]", (*_TRUTH, *_axes("x", "y", "z"))),
    Chart("gyro", "Gyroscope, in sensor axes", "rate [rad/s]", _axes("x", "y", "z")),
    Chart(
        "accel",
        "Accelerometer: specific force, +g up at rest",
        "specific force [m/s²]",
        _axes("x", "y", "z"),
    ),
    Chart("mag", "Magnetometer, in sensor axes", "field [µT]", _axes("x", "y", "z")),
    Chart("position", "Position in N", "p [m]", _axes("east", "north", "up")),
    Chart("velocity", "Velocity in N", "v [m/s]", _axes("east", "north", "up")),
    Chart("acceleration", "Acceleration in N, without gravity", "a [m/s²]", _axes("east", "north", "up")),
)


def charts_with(lines: Collection[str]) -> list[Chart]:
    """The charts that have something to show, with the traces that are among `lines` ("gyro.x")."""
    found = []
    for chart in CHARTS:
        traces = tuple(trace for trace in chart.traces if f"{chart.name}.{trace.name}" in lines)
        if traces:
            found.append(Chart(chart.name, chart.title, chart.quantity, traces))
    return found


def plots(charts: list[Chart], start: float, end: float) -> list[Any]:
    """One Bokeh plot for each chart, without data and with one time axis for all."""
    import numpy as np
    from bokeh.models import Range1d

    first, last = time_limits(np.array([start, end]))
    shared = Range1d(start=first, end=last, bounds=(first, last))
    return [_plot(chart, shared) for chart in charts]


def _plot(chart: Chart, shared: Any) -> Any:
    from bokeh.models import BoxZoomTool, ColumnDataSource, Range1d, WheelZoomTool
    from bokeh.plotting import figure

    # Colours are the page's: it sets them for light and dark.
    plot = figure(
        name=chart.name, height=_HEIGHT, sizing_mode="stretch_width",
        x_range=shared, y_range=Range1d(start=0.0, end=1.0),
        toolbar_location=None, tools=[], min_border=0, min_border_left=66, min_border_right=10,
        background_fill_color=None, border_fill_color=None, outline_line_color=None,
        x_axis_label="time [s]", y_axis_label=chart.quantity,
    )  # fmt: skip
    box, wheel = BoxZoomTool(dimensions="width"), WheelZoomTool(dimensions="width", modifiers="ctrl")
    plot.add_tools(box, wheel)
    plot.toolbar.active_drag, plot.toolbar.active_scroll = box, wheel
    for trace in chart.traces:
        width, alpha = (4.0, 0.35) if trace.broad else (1.4, 1.0)
        source = ColumnDataSource({"t": [], "y": []})
        line = plot.line(
            "t", "y", source=source, name=trace.name, line_join="round", line_width=width, line_alpha=alpha
        )
        line.tags = [trace.colour, trace.entry]
    for axis in (plot.xaxis, plot.yaxis):
        axis.axis_label_text_font = axis.major_label_text_font = "system-ui, sans-serif"
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_text_font_size = axis.major_label_text_font_size = "12px"
        axis.axis_line_color = axis.major_tick_line_color = axis.minor_tick_line_color = None
    return plot
