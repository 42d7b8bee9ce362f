"""Nouns as the small tables of a notebook: their numbers and units, and nothing that a page could not bear."""

import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest

import kreisel
from kreisel.data.cards import brief, span
from kreisel.study.run import run as study_run

T = np.arange(400) * 0.01
MOUNT = kreisel.Mount(p_BS=[0.1, 0.0, 0.02], name="wrist")
MOTION = kreisel.figure_eight(period=8.0).sample(T)
IMU = kreisel.Imu.from_preset(
    "bmi088", mount=MOUNT, environment=kreisel.Environment(field_N_uT=[0, 18.5, -45])
)
RECORDED = IMU.record(MOTION, rng=1)
ATTITUDE = kreisel.run(kreisel.DcmFilter(), RECORDED.measured)
STILL = kreisel.Imu.from_preset("bmi088").record(kreisel.rest().sample(np.arange(20_000) * 0.01), rng=2)
SCENARIO = kreisel.Scenario.from_toml(
    'duration = 2.0\nrate_hz = 100.0\n[trajectory]\nkind = "lying_eight"\n[[filter]]\nkind = "dcm"\nmode = "6"\n'
)
NOUNS = [
    MOTION,
    kreisel.Poses(MOTION.t, MOTION.p_NB),
    MOUNT,
    IMU,
    IMU.clock,
    IMU.environment,
    RECORDED,
    RECORDED.measured,
    ATTITUDE,
    kreisel.attitude_errors(MOTION.at(MOUNT), ATTITUDE),
    kreisel.motion_errors(MOTION, MOTION),
    kreisel.Imu().increments(MOTION),
    kreisel.Imu().record_increments(MOTION, 1),
    kreisel.allan(STILL.measured),
    kreisel.allan(STILL.measured).noise,
    kreisel.Calibration(),
    SCENARIO,
    study_run(SCENARIO),
]


@pytest.mark.parametrize("noun", NOUNS, ids=lambda noun: type(noun).__name__)
def test_a_notebook_shows_a_small_well_formed_table_headed_by_the_type(noun):
    html = noun._repr_html_()
    page = ElementTree.fromstring(html)  # raises for what is not well formed
    assert page.find("strong").text.startswith(type(noun).__name__)
    widths = {len(row) for row in page.iter("tr")}
    assert len(widths) == 1, "every row has as many cells as the heading"
    # A screen of a notebook, however long the arrays are.
    assert len(html) < 8000
    assert "script" not in html and "http" not in html


def test_fields_come_with_their_unit_their_axes_and_what_they_span():
    rows = {row[0]: row for row in RECORDED.measured.card().rows}
    assert rows["gyro"][1:3] == ("rad/s", "S")
    low, high = (float(x) for x in rows["accel"][3].split(" to "))
    # Four digits are shown.
    assert low == pytest.approx(RECORDED.measured.accel.min(), rel=1e-3)
    assert high == pytest.approx(RECORDED.measured.accel.max(), rel=1e-3)


def test_errors_are_told_in_degrees():
    errors = kreisel.attitude_errors(MOTION.at(MOUNT), ATTITUDE)
    total = next(iter(errors.card().rows))
    assert float(total[1]) == pytest.approx(errors.summary().total_rmse_deg, rel=1e-3)


def test_an_imu_names_every_effect_and_what_in_it_is_not_as_usual():
    text = IMU._repr_html_()
    for effect in (*IMU.gyro_effects, *IMU.accel_effects):
        assert type(effect).__name__ in text
    assert brief(kreisel.WhiteNoise(2e-4)) == "WhiteNoise(density = [0.0002  0.0002  0.0002])"


def test_a_name_with_markup_stays_text():
    poses = kreisel.Poses(MOTION.t, MOTION.p_NB, name="<b>bold</b>")
    assert "<b>" not in poses._repr_html_()
    assert "&lt;b&gt;" in poses._repr_html_()


def test_missing_samples_are_counted_and_do_not_hide_the_rest():
    assert span(np.array([1.0, np.nan, 3.0])) == "1 to 3, 1 NaN"
    assert span(np.full(2, np.nan)) == span(np.zeros(0)) == "-"
    assert span(np.array([True, False, False, False])) == "25 %"


def test_showing_a_noun_loads_neither_pandas_nor_matplotlib():
    code = (
        "import sys, kreisel; kreisel.lissajous().sample([0.0, 0.1])._repr_html_();"
        "print([name for name in ('pandas', 'xarray', 'matplotlib', 'IPython') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
