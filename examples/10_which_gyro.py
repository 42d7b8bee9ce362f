"""Which grade of gyro does a flight of ten minutes need for 1 deg of heading, where no magnetometer can be trusted?

Circles to the left and then to the right, many times over: every run has noise and a turn-on bias of its own, and the
gyro is integrated as it comes. A sensor is good enough when 95 runs in 100 stay below the limit all the time.
"""

from dataclasses import replace

from kreisel import Scenario, monte_carlo
from kreisel.show import plot_ensembles, save

RUNS = 16
LIMIT = 1.0  # deg
GRADES = {  # angle random walk deg/sqrt(h), bias instability deg/h, turn-on bias deg/h (one sigma)
    "consumer, bias taken at rest": (0.3, 10.0, 30.0),
    "industrial": (0.2, 5.0, 15.0),
    "tactical, low end": (0.15, 2.0, 5.0),
    "tactical": (0.1, 0.5, 1.0),
    "navigation": (0.002, 0.003, 0.005),
}
KEYS = ("gyro_arw_deg_per_rth", "gyro_bias_instability_deg_per_h", "gyro_turn_on_bias_deg_per_h")

flight = Scenario.from_toml("""
rate_hz = 50.0
seed = 10

[trajectory]
kind = "profile"
banked = true
segments = [
  { do = "drive", duration = 15, speed = 15 },
  { do = "turn", angle_deg = 2880, rate_deg_s = 10 },
  { do = "turn", angle_deg = -2880, rate_deg_s = 10 },
]

[[filter]]
kind = "dcm"
mode = "gyro"                  # nothing but the gyro after the start
start_error_deg = [0, 0, 0]    # the heading is known at the start
""")

made = {}
for name, numbers in GRADES.items():
    imu = replace(flight.imus[0], datasheet=dict(zip(KEYS, numbers, strict=True)))
    made[name] = monte_carlo(replace(flight, imus=(imu,)), RUNS)
    worst = made[name].estimates[0].summary()["heading_max_deg"]
    answer = "enough" if worst["p95"] <= LIMIT else "not enough"
    print(f"{name:<30} {worst['median']:8.2g} deg in half the runs, {worst['p95']:8.2g} in 95 %: {answer}")

save(plot_ensembles(made, "heading_max_deg", LIMIT), "10_which_gyro.png")
