"""What is in a report: the numbers of its run, every peak, and nothing that a browser would have to fetch."""

import re
import sys
from dataclasses import replace

import numpy as np
import pytest

from kreisel import show
from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.maths.rotations import matrix_from_quat_wxyz
from kreisel.study.account import Account, account_of, account_of_files
from tests.show.reports import data_of, floats, line, made

pytest.importorskip("bokeh", reason="bokeh is not installed: pip install kreisel[report]")

# Single precision about the middle of a line: half of 2^-23 of half its span, and a little for the sum.
SINGLE = 2.0**-23


@pytest.fixture(scope="module")
def result():
    return made()


@pytest.fixture(scope="module")
def page(result, tmp_path_factory):
    return show.write_report(result, tmp_path_factory.mktemp("report") / "report.html").read_text()


@pytest.fixture
def written(tmp_path):
    """The data of the page of an account."""
    return lambda account: data_of(show.write_report(account, tmp_path / "page.html").read_text())


def near(found, wanted, span=None):
    np.testing.assert_allclose(
        found, wanted, rtol=0.0, atol=SINGLE * (np.ptp(wanted) if span is None else span)
    )


def test_lines_are_the_run(result, page):
    data = data_of(page)
    t = result.motion.t
    for name, values in (("position", result.motion.p_NB), ("acceleration", result.motion.a_NB)):
        for k, axis in enumerate("xyz"):
            at, y = line(data, data["motion"][0], f"{name}.{axis}")
            near(at, t)
            near(y, values[:, k])
    for layer, recording in zip(data["readings"], result.recordings, strict=True):
        for name, values in (("gyro", recording.gyro), ("accel", recording.accel), ("mag", recording.mag_uT)):
            near(line(data, layer, f"{name}.y")[1], values[:, 1])
    for layer, estimate in zip(data["answers"], result.estimates, strict=True):
        assert (layer["imu"], layer["filter"]) == (estimate.imu, estimate.filter)
        near(line(data, layer, "errors.heading")[1], np.rad2deg(estimate.errors.heading))
        near(line(data, layer, "bias.z")[1], np.rad2deg(estimate.attitude.gyro_bias[:, 2]))
        near(line(data, layer, "attitude.x")[1], np.rad2deg(estimate.attitude.euler[:, 0]), span=360.0)


def test_truth_lies_beneath_what_was_estimated(result, page):
    data = data_of(page)
    for layer, mount in zip(data["readings"], result.mounts, strict=True):
        near(line(data, layer, "attitude.true_y")[1], np.rad2deg(result.motion.at(mount).euler[:, 1]), 360.0)
    near(line(data, data["readings"][0], "bias.true_x")[1], np.rad2deg(result.recorded[0].gyro_bias[:, 0]))
    assert not line(data, data["readings"][1], "bias.true_x")[1].any()  # the elbow's IMU is perfect


def test_the_body_is_where_it_was_and_turned_as_each_filter_has_it(result, page):
    space = data_of(page)["space"]
    t, p = floats(space["truth"]["t"]), floats(space["truth"]["p"]).reshape(-1, 3) + space["centre"]
    rows = np.searchsorted(result.motion.t, t - 1e-4)
    # Sixty poses a second of a path that was sampled at a hundred hertz, both ends among them.
    assert 450 < len(t) < 500 and t[0] == 0.0 and t[-1] == 8.0
    near(p, result.motion.p_NB[rows])
    R = matrix_from_quat_wxyz(floats(space["truth"]["q"]).reshape(-1, 4))
    np.testing.assert_allclose(R, result.motion.R_NB[rows], atol=1e-6)
    # The elbow's IMU is turned against the body; its perfect readings leave little of an error in the body's attitude.
    R = matrix_from_quat_wxyz(floats(space["answers"][2]["q"]).reshape(-1, 4))
    off = np.trace(R @ np.swapaxes(result.motion.R_NB[rows], -1, -2), axis1=1, axis2=2)
    worst = result.estimates[2].errors.total.max()
    assert np.arccos(np.clip(0.5 * (off - 1.0), -1.0, 1.0)).max() < worst + 1e-3


def test_no_peak_is_lost(written, rng):
    n = 60_000
    t = 0.005 * np.arange(n)
    gyro = rng.normal(size=(n, 3))
    # Far enough apart for each to be the largest of its column.
    rows = 1500 * np.arange(40) + rng.integers(0, 1000, 40)
    gyro[rows, 1] = 50.0 * (-1.0) ** np.arange(40) + np.arange(40)
    recording = ImuRecording(t, gyro, rng.normal(size=(n, 3)))
    attitude = AttitudeHistory(t[::600], np.tile(np.eye(3), (100, 1, 1)))
    data = written(account_of_files(recording, {"still": attitude}))
    at, y = line(data, data["readings"][0], "gyro.y")
    assert len(y) < 0.1 * n
    for row in rows:
        k = np.argmin(np.abs(at - t[row]) + np.abs(y - gyro[row, 1]))
        # The clock's single precision at 300 s is 1.5e-5 s.
        assert abs(at[k] - t[row]) < 1e-4 and abs(y[k] - gyro[row, 1]) < 1e-4


def test_ten_minutes_at_200_hertz_stay_under_six_megabytes(tmp_path):
    scenario = made(duration=1.0).scenario
    from kreisel.study.run import run

    long = run(
        replace(scenario, duration=600.0, rate_hz=200.0, imus=scenario.imus[:1], filters=scenario.filters[:1])
    )
    assert len(long.motion) == 120_001
    assert show.write_report(long, tmp_path / "a.html").stat().st_size < 6e6


def test_nothing_is_fetched(page):
    # Bokeh's script, by far the longest, holds addresses for maps and formulas that it is never asked for; that it
    # asks for none is test_report_browser's.
    own = "".join(sorted(page.split("<script>"), key=len)[:-1])
    assert "class Scene" in own
    loading = r"""(?:src|href)\s*=\s*["']?\s*(?:https?:)?//|url\(\s*["']?(?:https?:)?//|@import|<link|<img|<iframe"""
    assert not re.search(loading, own)
    assert "default-src 'none'" in page and "connect-src" not in page


def test_what_users_called_things_is_text_and_no_markup(page):
    assert "<back>" not in page and "there &amp; &lt;back&gt;" in page


def test_the_tables_hold_the_scenario_and_its_errors(result, page):
    summary = result.estimates[0].summary
    assert f"<td>{summary.heading_rmse_deg:#.3g}</td>" in page and "<td>wrist, six</td>" in page
    assert "bmi088, 801 samples at 100 Hz, at (-100, 0, 50) mm in the body" in page
    assert '<th scope="row">filters[1].tuning.mode</th><td>6</td>' in page
    assert "<option>wrist</option><option>elbow</option>" in page


def test_the_same_run_gives_the_same_bytes(result, page, tmp_path):
    assert show.write_report(result, tmp_path / "again.html").read_text() == page


def test_far_from_zero_no_digit_is_lost_that_could_be_seen(result, written):
    far, late = np.array([4.2e6, -1.1e6, 300.0]), 3.0e5
    motion = result.motion
    moved = replace(motion, t=motion.t + late, p_NB=motion.p_NB + far)
    data = written(Account("far", (), (), moved))
    t, y = line(data, data["motion"][0], "position.x")
    near(t - late, motion.t)
    near(y - far[0], motion.p_NB[:, 0], span=np.ptp(motion.p_NB[:, 0]) + 1e-2)  # 4e6 m has 1e-9 m of its own
    p = floats(data["space"]["truth"]["p"]).reshape(-1, 3)
    assert np.abs(p).max() < 2.0


def test_clocks_are_brought_together(written):
    t = 0.01 * np.arange(100)
    recording = ImuRecording(t, np.zeros((100, 3)), np.ones((100, 3)), t0_ns=10**18 + 250_000_000)
    turns = AttitudeHistory(t, np.tile(np.eye(3), (100, 1, 1)), t0_ns=10**18)
    data = written(account_of_files(recording, {"own": turns}, turns))
    assert (data["start"], data["end"]) == (0.0, pytest.approx(1.24))
    assert line(data, data["readings"][0], "gyro.x")[0][0] == pytest.approx(0.25, abs=1e-7)


def test_a_recording_alone_shows_the_body_as_estimated(result, written):
    found = result.estimates[0].attitude
    data = written(account_of_files(result.recordings[0], {"mine": found}))
    assert data["space"]["truth"] is None and data["space"]["still"]
    assert (
        "position.x" not in data["motion"][0]["lines"] and "errors.heading" not in data["answers"][0]["lines"]
    )


def test_rows_of_a_reference_that_do_not_count_are_gaps(result, written):
    R = result.motion.R_NB.copy()
    counts = np.ones(len(R), dtype=bool)
    R[100:200], counts[100:200] = np.nan, False
    truth = Reference(result.motion.t, R, counts)
    found = AttitudeHistory(result.motion.t, result.motion.R_NB)
    data = written(account_of_files(result.recordings[1], {"a": found}, truth))
    for name, layer in (("attitude.true_x", "readings"), ("errors.heading", "answers")):
        at, _ = line(data, data[layer][0], name)
        assert len(at) == len(R) - 100 and not ((at > 0.995) & (at < 1.985)).any()


def test_a_truth_of_positions_only_shows_the_path_without_errors(result, written):
    poses = Poses(result.motion.t, result.motion.p_NB)
    with pytest.raises(ValueError, match="positions only"):
        account_of_files(result.recordings[0], {"a": result.estimates[0].attitude}, poses)
    readings = account_of(result).readings
    data = written(Account("path", readings, (), poses))
    assert "q" not in data["space"]["truth"] and "position.x" in data["motion"][0]["lines"]


def test_a_start_that_would_flatten_the_rest_is_named_and_left_off_the_scale(result, written):
    R = result.motion.R_NB.copy()
    R[:5] = R[:5] @ np.diag([-1.0, -1.0, 1.0])
    data = written(
        account_of_files(result.recordings[0], {"a": AttitudeHistory(result.motion.t, R)}, result.motion)
    )
    layer = data["answers"][0]
    assert layer["beyond"]["errors"] == pytest.approx(180.0) and layer["limits"]["errors"][1] < 10.0


def test_a_body_at_rest_and_a_single_sample_have_a_page(rest, written):
    assert written(Account("rest", (), (), rest()))["space"]["length"] == 0.3
    assert written(Account("one", (), (), rest(1)))["end"] == 0.0


def test_what_cannot_be_is_said(result, tmp_path, monkeypatch):
    with pytest.raises(ValueError, match=r"name the file \.html"):
        show.write_report(result, tmp_path / "report.pdf")
    with pytest.raises(ValueError, match="nothing to report"):
        show.write_report(Account("empty", ()), tmp_path / "report.html")
    monkeypatch.setitem(sys.modules, "bokeh", None)
    with pytest.raises(ValueError, match=r"pip install 'kreisel\[report\]'"):
        show.write_report(result, tmp_path / "report.html")
    assert not list(tmp_path.iterdir())


def test_the_imu_is_drawn_where_it_sits(result, page):
    space = data_of(page)["space"]
    assert space["imus"][0]["p"] == [-0.1, 0.0, 0.05]
    np.testing.assert_allclose(space["imus"][1]["R"], [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-15)
