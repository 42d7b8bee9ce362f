"""Datasheet numbers against conversions done by hand."""

import numpy as np
import pytest
from scipy.optimize import linprog

from kreisel.data.temperature import TemperatureHistory
from kreisel.simulate.datasheet import PARAMETERS, completed, triads
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
    ("gyro_temperature_bias_deg_per_s_per_K", 0.5, "temperature_bias", 8.72664626e-3),
    ("gyro_temperature_bias_deg_per_h_per_K", 3600.0, "temperature_bias", 0.01745329252),
    ("accel_temperature_bias_mg_per_K", 0.2, "temperature_bias", 1.96133e-3),
    ("accel_temperature_bias_ug_per_K", 200.0, "temperature_bias", 1.96133e-3),
    ("mag_temperature_bias_mgauss_per_K", 0.3, "temperature_bias", 0.03),
    ("gyro_temperature_scale_percent_per_K", 0.03, "temperature_scale", 3e-4),
    ("accel_temperature_scale_ppm_per_K", 20.0, "temperature_scale", 2e-5),
    ("accel_reference_degC", 21.0, "reference_degC", 21.0),
    # 0.01745329252 rad/s over 9.80665 m/s^2.
    ("gyro_g_sensitivity_deg_per_s_per_g", 1.0, "g_sensitivity", 1.77974054e-3),
    ("gyro_g_sensitivity_deg_per_h_per_g", 3600.0, "g_sensitivity", 1.77974054e-3),
    ("gyro_fixed_bias_deg_per_s", -1.0, "fixed_bias", -0.01745329252),
    ("gyro_fixed_bias_deg_per_h", -3600.0, "fixed_bias", -0.01745329252),
    ("accel_fixed_bias_mg", -1000.0, "fixed_bias", -9.80665),
    ("mag_fixed_bias_mgauss", -20.0, "fixed_bias", -2.0),
    ("accel_fixed_scale_error_percent", -1.0, "fixed_scale", -0.01),
    ("gyro_fixed_temperature_bias_deg_per_s_per_K", -0.5, "fixed_temperature_bias", -8.72664626e-3),
    ("gyro_fixed_temperature_scale_ppm_per_K", -20.0, "fixed_temperature_scale", -2e-5),
    ("gyro_fixed_g_sensitivity_deg_per_s_per_g", -1.0, "fixed_g_sensitivity", -1.77974054e-3),
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
        (
            {"gyro_temperature_bias_dps_per_degC": -1.0},
            "gyro_temperature_bias_dps_per_degC must be 0 or more, deg/s/K",
        ),
        ({"gyro_reference_degC": -300.0}, "gyro_reference_degC must be from -273.15 to 2000, deg C"),
        ({"gyro_reference_degC": (1.0, 2.0, 3.0)}, "gyro_reference_degC must be one number, deg C"),
        ({"accel_nonlinearity_percent": 0.5}, "accel_nonlinearity_percent needs the range, accel_range_g"),
        (
            {"accel_nonlinearity_percent": 50.0, "accel_range_g": 8.0},
            "must be from -8.33333 to 8.33333, % of full scale",
        ),
        (
            {"gyro_fixed_scale_error_percent": -100.0},
            "gyro_fixed_scale_error_percent must be -99.9 or more, %",
        ),
        ({"gyro_noise_dps_rthz": 1.0, "gyro_noise_deg_per_s_rthz": 1.0}, "say the same; give one"),
        ({"accel_g_sensitivity_deg_per_s_per_g": 1.0}, "Did you mean 'gyro_g_sensitivity_deg_per_s_per_g'"),
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
    "gyro_temperature_bias_deg_per_s_per_K",
    "gyro_temperature_scale_ppm_per_K",
    "gyro_g_sensitivity_deg_per_s_per_g",
    "gyro_nonlinearity_ppm",
)


def test_effects_act_in_physical_order():
    values = dict.fromkeys(ONE_OF_EACH, 1.0)
    assert set(values) <= set(PARAMETERS)
    assert [effect.name for effect in Imu.from_datasheet(**values).gyro_effects] == [
        "misalignment", "scale_factor", "temperature_scale", "nonlinearity", "g_sensitivity", "turn_on_bias",
        "temperature_bias", "bias_instability", "bias_random_walk", "white_noise", "bandwidth", "range", "quantisation",
    ]  # fmt: skip


# --- what the coefficients do, on a body ---

TILTED = np.deg2rad(30.0)
T = np.arange(100) / 10.0


def tilted():
    """A body at rest, nose 30 deg down: it feels -g sin(30 deg) along x and g cos(30 deg) along z."""
    return rest(phi=(0.0, TILTED, 0.0)).sample(T)


def test_a_tilted_gyroscope_reads_its_g_sensitivity():
    imu = Imu.from_datasheet(gyro_fixed_g_sensitivity_deg_per_s_per_g=(0.1, 0.2, 0.3))
    recorded = imu.record(tilted(), 1)
    force = recorded.ideal.accel / 9.80665
    np.testing.assert_allclose(force[0], [-np.sin(TILTED), 0.0, np.cos(TILTED)], atol=1e-15)
    expected = np.deg2rad([-0.1 * 0.5, 0.0, 0.3 * np.cos(TILTED)])
    np.testing.assert_allclose(recorded.measured.gyro, np.tile(expected, (100, 1)), rtol=1e-12, atol=1e-18)


def test_a_tolerance_is_drawn_in_every_run_and_hears_force_across_too(rng):
    imu = Imu.from_datasheet(gyro_g_sensitivity_deg_per_s_per_g=0.1)
    motion, seed = rest().sample(T[:2]), int(rng.integers(2**62))
    heard = np.array([imu.record(motion, seed, run).measured.gyro[0] for run in range(300)])
    # Gravity lies along z; 900 draws: 2.4 %, five of them.
    np.testing.assert_allclose(np.rad2deg(np.std(heard)), 0.1, rtol=0.12, err_msg=f"seed {seed}")
    assert np.rad2deg(np.std(heard[:, 0])) > 0.07


def test_bias_and_scale_follow_the_temperature():
    history = TemperatureHistory(np.array([0.0, 10.0]), np.array([20.0, 40.0]))
    imu = Imu.from_datasheet(
        temperature=history,
        gyro_fixed_temperature_bias_dps_per_degC=(0.05, 0.0, -0.1),
        gyro_reference_degC=30.0,
        accel_fixed_temperature_scale_percent_per_degC=0.1,
    )
    recorded = imu.record(rest().sample(T), 1)
    degrees = 20.0 + 2.0 * T
    np.testing.assert_array_equal(recorded.temperature_degC, degrees)
    bias = np.deg2rad((degrees - 30.0)[:, None] * [0.05, 0.0, -0.1])
    np.testing.assert_allclose(recorded.gyro_bias, bias, atol=1e-16)
    # Where no reference is given it is 25 deg C.
    scale = 1.0 + 1e-3 * (degrees - 25.0)
    np.testing.assert_allclose(recorded.measured.accel[:, 2], 9.80665 * scale, rtol=1e-14)


def test_a_temperature_coefficient_is_one_sigma_of_a_draw(rng):
    hot = TemperatureHistory.constant(35.0)
    imu = Imu.from_datasheet(accel_temperature_bias_mg_per_K=0.2, temperature=hot)
    motion, seed = rest().sample(T[:2]), int(rng.integers(2**62))
    bias = np.array([imu.record(motion, seed, run).accel_bias[0] for run in range(300)])
    # Ten kelvin above: 2 mg; 900 draws: 2.4 %, five of them.
    np.testing.assert_allclose(np.std(bias) / 9.80665e-3, 2.0, rtol=0.12, err_msg=f"seed {seed}")


def test_non_linearity_is_the_distance_from_the_best_straight_line():
    """The line is fitted here by linear programming over the range, as a lab would."""
    share, limit = 0.02, 4.0 * 9.80665
    _, triad, _ = triads({"accel_nonlinearity_percent": 100.0 * share, "accel_range_g": 4.0})
    x = np.linspace(-limit, limit, 2001)
    read = x + triad.cubic[0] * x**3
    rows = np.stack([x, np.ones_like(x)], axis=1)
    bound = np.full((len(x), 1), -1.0)
    fit = linprog(
        [0.0, 0.0, 1.0],
        A_ub=np.block([[rows, bound], [-rows, bound]]),
        b_ub=np.concatenate([read, -read]),
        bounds=[(None, None)] * 3,
    )
    # Between points of the grid the curve is 1e-6 of itself away.
    np.testing.assert_allclose(fit.x, [1.0 + 3.0 * share, 0.0, share * limit], rtol=1e-5, atol=1e-9)


def test_a_preset_takes_numbers_in_place_of_its_own_and_beside_them():
    imu = Imu.from_preset("bmi088", gyro_arw_deg_per_rth=0.6, accel_temperature_bias_mg_per_K=0.2)
    noise = next(effect for effect in imu.gyro_effects if effect.name == "white_noise")
    np.testing.assert_allclose(noise.density, np.deg2rad(0.01), rtol=1e-12)
    own = [effect.name for effect in Imu.from_preset("bmi088").accel_effects]
    assert {effect.name for effect in imu.accel_effects} == {*own, "temperature_bias"}


def test_numbers_replace_what_says_the_same_by_another_name():
    base = {
        "gyro_noise_rms_deg_per_s": 0.1,
        "gyro_noise_bandwidth_hz": 50.0,
        "gyro_bits": 16,
        "gyro_range_deg_per_s": 2000.0,
    }
    made = completed(base, {"gyro_noise_dps_rthz": 0.01, "gyro_range_dps": 250.0})
    assert made == {"gyro_noise_dps_rthz": 0.01, "gyro_bits": 16, "gyro_range_dps": 250.0}
    gyro = triads(made).gyro
    np.testing.assert_allclose(gyro.step, np.deg2rad(500.0 / 65536.0))
    quieter = completed(base, {"gyro_noise_rms_deg_per_s": 0.05})
    np.testing.assert_allclose(triads(quieter).gyro.noise.white_noise, np.deg2rad(0.005), rtol=1e-12)
    with pytest.raises(ValueError, match="Did you mean 'gyro_bits'"):
        completed(base, {"gyro_bit": 12})
