"""Every MATLAB example of document 000 runs, translated line by line, and gives what its trajectory must."""

import numpy as np
import pytest

from kreisel.compat import my_ang, my_imu, my_lin, my_rotate, my_tang

# Common to all of them: t_start, t_step, t_stop and f.
t = np.arange(0, 1001) * 0.005  # s
f = 1  # Hz
inside = slice(2, -2)

# The example's ellipse: 4 cos, 4 sin, 1.5 cos, all at f. s'' = -(2 pi f)^2 s.
sx = 0.8 * 5 * np.cos(2 * np.pi * f * t)  # m
sy = 0.8 * 5 * np.sin(2 * np.pi * f * t)  # m
sz = 0.3 * 5 * np.cos(2 * np.pi * f * t)  # m
s = np.column_stack([sx, sy, sz])


def test_my_lin_num() -> None:
    s_calc, v, a = my_lin(s, "num", t)
    np.testing.assert_array_equal(s_calc, s)
    # A central difference of a sine is short by (w h)^2 / 6 = 1.6e-4, and twice that for a.
    np.testing.assert_allclose(v[inside, 1], 2 * np.pi * s[inside, 0], rtol=2e-4, atol=1e-9)
    np.testing.assert_allclose(a[inside], -((2 * np.pi) ** 2) * s[inside], rtol=4e-4, atol=1e-9)


def test_my_lin_sym() -> None:
    functions = (
        lambda t: 0.8 * np.cos(2 * np.pi * f * t),
        lambda t: 0.8 * np.sin(2 * np.pi * f * t),
        lambda t: 0.3 * np.cos(2 * np.pi * f * t),
    )
    s_calc, v, a = my_lin(functions, "sym", t)
    np.testing.assert_allclose(s_calc, s / 5, atol=1e-15)
    np.testing.assert_allclose(v[:, 1], 2 * np.pi * s[:, 0] / 5, atol=1e-14)
    np.testing.assert_allclose(a, -((2 * np.pi) ** 2) * s / 5, atol=1e-13)


def test_my_tang() -> None:
    _, v, _ = my_lin(s, "num", t)
    phi_tz, phi_ty, phi_tx, ta = my_tang(v, t)
    assert phi_tz.shape == phi_ty.shape == phi_tx.shape == (len(t),)
    # R(phi) takes the body's nose to the tangent: (cos z cos y, sin z cos y, -sin y).
    nose = np.column_stack(
        [np.cos(phi_tz) * np.cos(phi_ty), np.sin(phi_tz) * np.cos(phi_ty), -np.sin(phi_ty)]
    )
    np.testing.assert_allclose(nose, ta, atol=1e-14)
    assert not phi_tx.any()


def test_my_ang_num() -> None:
    phix = 0 * t  # rad
    phiy = 0 * t  # rad
    phiz = 0.3 * np.cos(2 * np.pi * f * t)  # rad
    phi = np.column_stack([phix, phiy, phiz])
    phi_calc, omega, alpha = my_ang(phi, "num", t)
    np.testing.assert_array_equal(phi_calc, phi)
    assert not omega[:, :2].any()
    # In the plane the scheme gives sin of the angle between neighbours: short by (w h)^2 / 6 = 1.6e-4 of a
    # harmonic, here of three that mix; 1e-3 bounds them.
    rate = -0.3 * 2 * np.pi * np.sin(2 * np.pi * t)
    np.testing.assert_allclose(omega[inside, 2], rate[inside], atol=1e-3 * np.abs(rate).max())
    np.testing.assert_allclose(alpha[inside, 2], -((2 * np.pi) ** 2) * phiz[inside], atol=1e-3 * 12)


def test_my_ang_sym() -> None:
    functions = (
        lambda t: 0.8 * np.cos(2 * np.pi * f * t),
        lambda t: 0.8 * np.sin(2 * np.pi * f * t),
        lambda t: 0.3 * np.cos(2 * np.pi * f * t),
    )
    exact = my_ang(functions, "sym", t)
    samples = my_ang(exact[0], "num", t)
    np.testing.assert_allclose(exact[0], s / 5, atol=1e-15)
    for derivative in (1, 2):
        scale = np.abs(exact[derivative]).max()
        # The scheme's own error: (w h)^2 / 6 of each of the harmonics in R, the highest strong one about 4.
        np.testing.assert_allclose(samples[derivative][inside], exact[derivative][inside], atol=5e-3 * scale)


@pytest.mark.parametrize("shape", [(-1,), (-1, 1), (1, -1)])
def test_whole_chain(shape: tuple[int, ...]) -> None:
    time = t.reshape(shape)
    r = np.array([-150e-3, -150e-3, 50e-3]) / 2  # m
    s_S_N, v_S_N, a_S_N = my_lin(s, "num", time)
    phi_tz, phi_ty, phi_tx, _ = my_tang(v_S_N, time)
    phi = np.column_stack([phi_tx, phi_ty, phi_tz])
    phi, omega, alpha = my_ang(phi, "num", time)
    a_S_B = my_rotate(phi, a_S_N, time)
    a_I_B = my_imu(a_S_B, omega, alpha, r, time)
    assert s_S_N.shape == omega.shape == a_I_B.shape == (len(t), 3)
    # Turning keeps lengths; the lever arm adds at most (omega^2 + alpha) r.
    np.testing.assert_allclose(np.linalg.norm(a_S_B, axis=1), np.linalg.norm(a_S_N, axis=1), rtol=1e-14)
    bound = (np.sum(omega**2, axis=1) + np.linalg.norm(alpha, axis=1)) * np.linalg.norm(r)
    assert (np.linalg.norm(a_I_B - a_S_B, axis=1) <= bound * (1 + 1e-12)).all()
    np.testing.assert_allclose(a_I_B, my_imu(a_S_B, omega, alpha, r[:, None], time), rtol=0, atol=0)
