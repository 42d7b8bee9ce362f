"""Which grade of gyro does a flight of ten minutes need for 1 deg of heading, where no magnetometer can be trusted?

Circles to the left and then to the right, many times over: every run has noise and a turn-on bias of its own, and the
gyro is integrated as it comes. A sensor is good enough when 95 runs in 100 stay below the limit all the time.
"""

import sys
from dataclasses import replace

from kreisel import Scenario, monte_carlo
from kreisel.show import plot_ensembles, save

RUNS = int(sys.argv[1]) if len(sys.argv) > 1 else 16
LIMIT = 1.0  # deg
GRADES = {
    "consumer: MPU-6050": "mpu6050",
    "consumer: BMI270": "bmi270",
    "industrial: ADIS16470": "adis16470",
    "tactical: STIM300": "stim300",
    "tactical: HG1700": "hg1700",
    "navigation: HG9900": "hg9900",
}

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
  { do = "drive", duration = 15, speed = 0 },
]

[[filter]]
kind = "dcm"
mode = "gyro"                  # nothing but the gyro after the start
start_error_deg = [0, 0, 0]    # the heading is known at the start
""")

made = {}
for name, sensor in GRADES.items():
    made[name] = monte_carlo(replace(flight, imus=(replace(flight.imus[0], sensor=sensor),)), RUNS)
    worst = made[name].estimates[0].summary()["heading_max_deg"]
    answer = "enough" if worst["p95"] <= LIMIT else "not enough"
    print(f"{name:<24} {worst['median']:8.2g} deg in half the runs, {worst['p95']:8.2g} in 95 %: {answer}")

save(plot_ensembles(made, "heading_max_deg", LIMIT), "10_which_gyro.png")
