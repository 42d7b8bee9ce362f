"""Exact against numeric derivatives: the error of MATLAB's gradient in per cent, over time.

The MATLAB tool's own functions, with both options: "sym" differentiates functions, "num" samples at 200 Hz.
"""

import matplotlib.pyplot as plt
import numpy as np

from kreisel.compat import my_ang, my_lin

t = np.arange(0, 5, 0.005)  # s
s = (
    lambda t: 0.8 * np.cos(2 * np.pi * t),
    lambda t: 0.8 * np.sin(2 * np.pi * t),
    lambda t: 0.3 * np.cos(2 * np.pi * 3 * t),
)  # m
phi = (s[0], s[1], lambda t: 0.3 * np.cos(2 * np.pi * t))  # rad

s_sym, v_sym, a_sym = my_lin(s, "sym", t)
s_num, v_num, a_num = my_lin(s_sym, "num", t)
phi_sym, omega_sym, alpha_sym = my_ang(phi, "sym", t)
phi_num, omega_num, alpha_num = my_ang(phi_sym, "num", t)

figure, panels = plt.subplots(4, 1, figsize=(9, 9), sharex=True, layout="constrained")
figure.suptitle("Error of numeric derivatives at 200 Hz, per cent of the largest value")
names = ("velocity", "acceleration", "angular rate", "angular acceleration")
exact = (v_sym, a_sym, omega_sym, alpha_sym)
numeric = (v_num, a_num, omega_num, alpha_num)
for panel, name, x, y in zip(panels, names, exact, numeric, strict=True):
    percent = 100 * np.linalg.norm(y - x, axis=1) / np.linalg.norm(x, axis=1).max()
    panel.semilogy(t, percent, linewidth=1)
    panel.set_title(
        f"{name}: {percent[2:-2].max():.2g} % inside, {percent.max():.2g} % at the ends", loc="left"
    )
    panel.set(ylabel="error [%]", ylim=(1e-3, 100))
    panel.grid(True, alpha=0.3)
panels[-1].set_xlabel("time [s]")
figure.savefig("02_exact_against_numeric.png", dpi=144)
