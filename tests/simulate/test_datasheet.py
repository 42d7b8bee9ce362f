"""Datasheet numbers against conversions done by hand."""

import numpy as np
import pytest

from kreisel.simulate.datasheet import PARAMETERS, triads
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.rest import rest

# By hand, with pi / 180 = 0.01745329252, g = 9.80665, 0.664 = 0.66428.
BY_HAND = [
    # 60 deg/sqrt(h) are 1 deg/s/sqrt(Hz): an hour has sqrt(3600 s).
    ("gyro_arw_deg_per_rth", 60.0, "white_noise", 0.01745329252),
    # A one-sided density of sqrt(2) is a two-sided one of 1.
    ("gyro_noise_deg_per_s_rthz", 1.41421356237, "white_noise", 0.01745329252),
    ("accel_noise_ug_rthz", 141.421356237, "white_noise", 9.80665e-4),
    ("accel_vrw_m_per_s_rth", 0.6, "white_noise", 0.01),
    # 206264.806 deg/h are 1 rad/s.
    ("gyro_bias_instability_deg_per_h", 206264.806247 * 0.664282, "bias_instability", 1.0),
    ("accel_bias_instability_ug", 1e6 * 0.664282, "bias_instability", 9.80665),
    ("gyro_bias_random_walk_deg_per_s_rts", 2.0, "bias_random_walk", 0.03490658504),
    ("gyro_rrw_deg_per_h_rth", 216000.0, "bias_random_walk", 0.01745329252),
    ("accel_bias_random_walk_ug_rts", 1e6, "bias_random_walk", 9.80665),
    ("gyro_turn_on_bias_deg_per_s", 1.0, "turn_on_bias", 0.01745329252),
    ("gyro_turn_on_bias_deg_per_h", 3600.0, "turn_on_bias", 0.01745329252),
    ("accel_turn_on_bias_mg", 1000.0, "turn_on_bias", 9.80665),
    ("gyro_scale_error_percent", 1.0, "scale", 0.01),
    ("accel_scale_error_ppm", 300.0, "scale", 3e-4),
    ("gyro_misalignment_percent", 2.0, "misalignment", 0.02),
    ("accel_misalignment_deg", 0.5, "misalignment", 8.72664626e-3),
    ("gyro_range_deg_per_s", 2000.0, "limit", 34.9065850),
    ("accel_range_g", 16.0, "limit", 156.9064),
    ("gyro_resolution_deg_per_s", 0.07, "step", 1.22173048e-3),
    ("gyro_lsb_per_deg_per_s", 16.4, "step", 1.06422515e-3),
    ("accel_lsb_per_g", 2048.0, "step", 4.78840332e-3),
    ("accel_resolution_mg", 0.488, "step", 4.7856452e-3),
    ("gyro_bandwidth_hz", 330.0, "bandwidth", 330.0),
    # A gauss is 100 microtesla.
    ("mag_noise_uT_rthz", 1.41421356237, "white_noise", 1.0),
    ("mag_noise_ugauss_rthz", 14142.1356237, "white_noise", 1.0),
    ("mag_turn_on_bias_uT", 3.0, "turn_on_bias", 3.0),
    ("mag_turn_on_bias_mgauss", 20.0, "turn_on_bias", 2.0),
    ("mag_range_gauss", 1.9, "limit", 190.0),
    ("mag_range_uT", 4900.0, "limit", 4900.0),
    ("mag_resolution_uT", 0.15, "step", 0.15),
    ("mag_resolution_mgauss", 0.25, "step", 0.025),
]


def of(values, name):
    return getattr(triads(values), name.split("_")[0])


@pytest.mark.parametrize(("name", "value", "quantity", "expected"), BY_HAND, ids=[row[0] for row in BY_HAND])
def test_units(name, value, quantity, expected):
    triad = of({name: value}, name)
    found = getattr(triad.noise if hasattr(triad.noise, quantity) else triad, quantity)
    # The constants above have nine digits or more, 0.664282 six.
    np.testing.assert_allclose(found, expected, rtol=2e-6 if quantity == "bias_instability" else 1e-8)


def test_noise_in_a_band():
    """0.1 deg/s RMS in 50 Hz: the variance is density^2 * 50 one-sided, N^2 * 100 two-sided."""
    triad, _, _ = triads({"gyro_noise_rms_deg_per_s": 0.1, "gyro_noise_bandwidth_hz": 50.0})
    np.testing.assert_allclose(triad.noise.white_noise, np.deg2rad(0.01), rtol=1e-12)
    peaks, _, _ = triads({"gyro_noise_peak_to_peak_deg_per_s": 0.66, "gyro_noise_bandwidth_hz": 50.0})
    np.testing.assert_allclose(peaks.noise.white_noise, np.deg2rad(0.01), rtol=1e-12)
    _, _, mag = triads({"mag_noise_rms_mgauss": 2.0, "mag_noise_bandwidth_hz": 50.0})
    np.testing.assert_allclose(mag.noise.white_noise, 0.02, rtol=1e-12)


def test_bits_share_the_range():
    triad, _, _ = triads({"gyro_bits": 16, "gyro_range_deg_per_s": 2000.0})
    np.testing.assert_allclose(triad.step, np.deg2rad(4000.0 / 65536.0))


def test_a_datasheet_that_states_both_agrees_with_itself():
    """ADIS16470: 0.008 deg/s/sqrt(Hz) on page 1, 0.34 deg/sqrt(h) in table 1; densities are one-sided."""
    density, _, _ = triads({"gyro_noise_deg_per_s_rthz": 0.008})
    walk, _, _ = triads({"gyro_arw_deg_per_rth": 0.34})
    # Both are printed with one or two digits.
    np.testing.assert_allclose(density.noise.white_noise, walk.noise.white_noise, rtol=0.01)


def test_rms_noise_stated_beside_a_density_tells_its_reading():
    """BMI088: 0.014 deg/s/sqrt(Hz) and 0.1 deg/s RMS at a bandwidth of 47 Hz."""
    density, _, _ = triads({"gyro_noise_deg_per_s_rthz": 0.014})
    rms, _, _ = triads({"gyro_noise_rms_deg_per_s": 0.1, "gyro_noise_bandwidth_hz": 47.0})
    # 0.1 is printed with one digit: up to 5 % off. Read as two-sided the two would be 41 % apart.
    np.testing.assert_allclose(density.noise.white_noise, rms.noise.white_noise, rtol=0.05)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"gyro_nose_deg_per_s_rthz": 1.0}, "Did you mean 'gyro_noise_deg_per_s_rthz'"),
        ({"gyro_arw_deg_per_rth": 1.0, "gyro_noise_deg_per_s_rthz": 1.0}, "say the same; give one"),
        ({"gyro_resolution_deg_per_s": 1.0, "gyro_lsb_per_deg_per_s": 1.0}, "say the same; give one"),
        ({"gyro_bits": 16}, "gyro_bits needs the range, gyro_range_deg_per_s"),
        ({"accel_noise_rms_mg": 1.0}, "accel_noise_bandwidth_hz"),
        ({"accel_noise_bandwidth_hz": 1.0}, "belongs to RMS or peak-to-peak noise"),
        ({"accel_noise_ug_rthz": -1.0}, r"accel_noise_ug_rthz must be 0 or more, ug/sqrt\(Hz\)"),
        ({"gyro_range_deg_per_s": 0.0}, "gyro_range_deg_per_s must be"),
        ({"gyro_bandwidth_hz": (1.0, 2.0, 3.0)}, "gyro_bandwidth_hz must be one number"),
        ({"gyro_misalignment_deg": 30.0}, "gyro_misalignment_deg must be from 0 to 5.72958, deg"),
    ],
)
def test_bad_values_are_refused_by_name(values, message):
    with pytest.raises(ValueError, match=message):
        Imu.from_datasheet(**values)


def test_a_range_below_gravity_is_refused():
    imu = Imu.from_datasheet(accel_range_g=0.5)
    with pytest.raises(ValueError, match="must not be below gravity"):
        imu.record(rest().sample(np.arange(3) / 10.0), 1)


def test_nothing_given_is_a_perfect_sensor():
    imu = Imu.from_datasheet()
    assert imu.gyro_effects == imu.accel_effects == ()
    assert (
        Imu.from_datasheet(
            **dict.fromkeys(["gyro_arw_deg_per_rth", "accel_scale_error_ppm"], 0.0)
        ).gyro_effects
        == ()
    )


ONE_OF_EACH = (
    "gyro_resolution_deg_per_s",
    "gyro_range_deg_per_s",
    "gyro_bandwidth_hz",
    "gyro_arw_deg_per_rth",
    "gyro_bias_instability_deg_per_h",
    "gyro_rrw_deg_per_h_rth",
    "gyro_turn_on_bias_deg_per_h",
    "gyro_misalignment_percent",
    "gyro_scale_error_ppm",
)


def test_effects_act_in_physical_order():
    values = dict.fromkeys(ONE_OF_EACH, 1.0)
    assert set(values) <= set(PARAMETERS)
    assert [effect.name for effect in Imu.from_datasheet(**values).gyro_effects] == [
        "misalignment", "scale_factor", "turn_on_bias", "bias_instability", "bias_random_walk", "white_noise",
        "bandwidth", "range", "quantisation",
    ]  # fmt: skip
