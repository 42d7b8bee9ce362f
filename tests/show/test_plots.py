"""The lines hold the data, the limits make sense, the input is left alone."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from kreisel.data.motion import Note
from kreisel.data.recording import ImuRecording
from kreisel.show import plot_angular, plot_imu, plot_linear, style
from kreisel.show.series import value_limits

pytestmark = pytest.mark.filterwarnings("error")


def lines(axes, colours=style.XYZ):
    """The x, y and z line of a panel, told by their colours."""
    return [next(line for line in axes.get_lines() if line.get_color() == c) for c in colours]


def entries(figure) -> list[str]:
    legends = [axes.get_legend() for axes in figure.axes if axes.get_legend()]
    return [text.get_text() for legend in legends for text in legend.get_texts()]


def test_linear_panels_hold_position_velocity_and_acceleration(circle) -> None:
    motion = circle()
    figure = plot_linear(motion)
    for axes, values in zip(figure.axes, (motion.p_NB, motion.v_NB, motion.a_NB), strict=True):
        for line, column in zip(lines(axes), values.T, strict=True):
            np.testing.assert_array_equal(line.get_data(), (motion.t, column))
    assert [axes.get_ylabel() for axes in figure.axes] == ["p [m]", "v [m/s]", "a [m/s²]"]
    assert figure.axes[-1].get_xlabel() == "time [s]" and "Circle" in figure.get_suptitle()


def test_angular_panels_hold_angles_in_degrees_and_rates_in_radians(circle) -> None:
    motion = circle(rate=0.3)  # 90 to 176 degrees: no wrap
    figure = plot_angular(motion)
    phi_z = lines(figure.axes[0])[2].get_ydata()
    np.testing.assert_allclose(phi_z, 90.0 + np.rad2deg(0.3 * motion.t), atol=1e-9)
    np.testing.assert_array_equal(lines(figure.axes[1])[2].get_ydata(), motion.omega_NB_B[:, 2])
    figure.draw_without_rendering()
    (right,) = figure.axes[1].child_axes
    np.testing.assert_allclose(right.get_ylim(), np.rad2deg(figure.axes[1].get_ylim()))


def test_wrapping_angles_are_broken_rather_than_joined(circle) -> None:
    motion = circle(rate=4.0)  # 20 rad in all, from 90 degrees: wraps three times
    phi_z = lines(plot_angular(motion).axes[0])[2].get_ydata()
    assert np.isnan(phi_z).sum() == 3
    assert np.nanmax(np.abs(np.diff(phi_z))) < 3.0  # 4 rad/s at 100 Hz is 2.3 degrees a sample


def test_missing_samples_are_gaps_with_a_mark(recording) -> None:
    source = recording()
    gyro = source.gyro.copy()
    gyro[100:150] = np.nan
    figure = plot_imu(replace(source, gyro=gyro))
    t, y = lines(figure.axes[0])[0].get_data()
    assert np.isnan(y).sum() == 1 and not ((t >= source.t[100]) & (t < source.t[150]) & np.isfinite(y)).any()
    assert entries(figure).count("missing (50)") == 1


def test_a_sample_between_two_missing_ones_is_a_dot(recording) -> None:
    source = recording()
    accel = source.accel.copy()
    accel[199], accel[201] = np.nan, np.nan
    line = lines(plot_imu(replace(source, accel=accel)).axes[1])[0]
    (row,) = line.get_markevery()
    assert line.get_marker() == "." and line.get_xdata()[row] == source.t[200]


def test_the_magnetometer_gets_a_panel_where_there_is_one(recording) -> None:
    assert len(plot_imu(recording()).axes) == 2
    figure = plot_imu(recording(mag=True))
    assert figure.axes[2].get_ylabel() == "mag [µT]"
    assert len(lines(figure.axes[2])[0].get_ydata()) == 40  # every tenth of 400, joined
    assert not any(entry.startswith("missing") for entry in entries(figure))


def test_the_ideal_is_drawn_over_at_its_own_times(recording) -> None:
    measured = recording()
    ideal = ImuRecording(
        t=measured.t[::2], gyro=measured.gyro[::2] + 1.0, accel=measured.accel[::2], t0_ns=500_000_000
    )
    figure = plot_imu(measured, ideal)
    for axes in figure.axes:
        assert len(lines(axes)) == 3
    dark = lines(figure.axes[0], style.XYZ_DARK)
    np.testing.assert_allclose(dark[1].get_xdata(), measured.t[::2] + 0.5, atol=1e-12)
    np.testing.assert_array_equal(dark[1].get_ydata(), ideal.gyro[:, 1])
    low, high = figure.axes[0].get_ylim()
    assert low < -1.0 and high > 10.8  # limits hold both


def test_timed_notes_are_marked_and_counted(circle) -> None:
    jumps = [Note("heading-jump", "The path reverses.", 1.0), Note("heading-jump", "Again.", 2.0)]
    motion = circle(notes=(*jumps, Note("rate-step", "A corner.", 3.0), Note("method", "Exact.")))
    for plot in (plot_linear, plot_angular):
        figure = plot(motion)
        marks = [line for line in figure.axes[2].get_lines() if line.get_color() == style.NOTE]
        assert [sorted(set(mark.get_xdata())) for mark in marks] == [[1.0, 2.0], [3.0]]
        assert [e for e in entries(figure) if "(" in e] == ["heading jump (2)", "rate step (1)"]
    assert not any("(" in e for e in entries(plot_linear(circle())))


def test_round_off_is_not_blown_up(rest) -> None:
    for plot in (plot_linear, plot_angular):
        for axes in plot(rest(jitter=1e-16)).axes:
            assert np.ptp(axes.get_ylim()) >= 1.9
    low, high = plot_linear(rest(jitter=1e-16)).axes[1].get_ylim()
    assert low == -high


def test_a_small_signal_is_no_round_off(rest) -> None:
    low, high = plot_linear(rest(jitter=1e-6)).axes[1].get_ylim()
    assert 2e-6 < high - low < 3e-6


@pytest.mark.parametrize(
    ("low", "high", "wanted"),
    [
        (0.0, 0.0, (-1.0, 1.0)),
        (-3e-17, 5e-17, (-1.0, 1.0)),
        (9.80665, 9.80665 + 4e-15, (8.80665, 10.80665)),
        (5e6, 5e6 + 1e-9, (4.5e6, 5.5e6)),
        (-1.0, 1.0, (-1.12, 1.12)),
    ],
)
def test_value_limits(low: float, high: float, wanted: tuple[float, float]) -> None:
    np.testing.assert_allclose(value_limits(low, high), wanted, rtol=1e-9)


def test_one_sample_is_drawn_as_dots(circle, rest) -> None:
    motion = rest(n=1)
    for plot in (plot_linear, plot_angular):
        figure = plot(motion)
        assert all(line.get_marker() == "." for axes in figure.axes for line in lines(axes))
        assert figure.axes[0].get_xlim() == (-0.5, 0.5)


def test_empty_and_all_missing_recordings_can_be_drawn() -> None:
    none = np.zeros((0, 3))
    plot_imu(ImuRecording(t=np.zeros(0), gyro=none, accel=none, mag_uT=none)).draw_without_rendering()
    lost = np.full((10, 3), np.nan)
    plot_imu(ImuRecording(t=np.arange(10.0), gyro=lost, accel=lost, mag_uT=lost)).draw_without_rendering()


def test_a_million_samples_draw_fast_and_keep_the_one_peak() -> None:
    n = 1_000_000
    y = np.random.default_rng(7).normal(size=(n, 3))
    y[654_321, 1] = 50.0
    source = ImuRecording(t=1e-3 * np.arange(n), gyro=y, accel=y)
    began = time.process_time()
    figure = plot_imu(source)
    figure.draw_without_rendering()
    # 1.2 s of one core when measured; the limit is what people were promised.
    assert time.process_time() - began < 3.0
    assert lines(figure.axes[0])[1].get_ydata().max() == 50.0
    assert all(len(line.get_xdata()) <= 10_000 for axes in figure.axes for line in axes.get_lines())


def test_inputs_are_untouched(circle, recording) -> None:
    motion, source = circle(n=20), recording(mag=True)
    before = [x.copy() for x in (motion.p_NB, motion.R_NB, source.gyro, source.mag_uT)]
    for figure in (plot_linear(motion), plot_angular(motion), plot_imu(source, source)):
        figure.draw_without_rendering()
    for x, old in zip((motion.p_NB, motion.R_NB, source.gyro, source.mag_uT), before, strict=True):
        np.testing.assert_array_equal(x, old)
