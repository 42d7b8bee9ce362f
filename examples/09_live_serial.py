"""Attitude while it happens: a microcontroller on a serial port, read into `kreisel live`.

    python 09_live_serial.py /dev/ttyUSB0           what docs/live.md has an ESP32 or Arduino print
    python 09_live_serial.py /dev/ttyUSB0 921600    at another speed

Without a port a BMI088 is simulated that is turned by hand; what was shown is kept and drawn.
"""

import subprocess
import sys
import time

import numpy as np

from kreisel import Environment, FunctionTrajectory, Imu, read
from kreisel.show import plot_attitude, save


def from_port(port, baud=115200):
    """Lines of a serial port, the first of which is half a line."""
    try:
        import serial
    except ImportError:
        sys.exit("Reading a port needs pyserial: pip install pyserial")
    with serial.Serial(port, int(baud)) as lines:
        lines.readline()
        yield from lines


def simulated():
    """Lines of 8 s as docs/live.md prints them: header, then ms, deg/s, g and uT."""
    turns = (lambda t: 0.7 * np.sin(t), lambda t: 0.5 * np.sin(0.8 * t), lambda t: 0.6 * t)
    motion = FunctionTrajectory((0.0, 0.0, 0.0), turns).sample(np.arange(0, 8, 0.01))
    field = Environment(field_N_uT=[0, 20, -44])
    imu = Imu.from_preset("bmi088", environment=field).record(motion, rng=9).measured
    yield b"t [ms],gx [deg/s],gy [deg/s],gz [deg/s],ax [g],ay [g],az [g]\n"
    for row in np.column_stack([1e3 * imu.t, np.rad2deg(imu.gyro), imu.accel / 9.80665]).tolist():
        time.sleep(0.01 * sys.stdout.isatty())
        yield ",".join(f"{x:.5f}" for x in row).encode() + b"\n"


command = [sys.executable, "-m", "kreisel", "live", "-o", "09_attitude.npz"]
with subprocess.Popen(command, stdin=subprocess.PIPE) as live:
    try:
        for line in from_port(*sys.argv[1:]) if len(sys.argv) > 1 else simulated():
            live.stdin.write(line)
            live.stdin.flush()
    except KeyboardInterrupt:
        pass  # it has reached both of us: the other one writes what it has
    live.stdin.close()

save(plot_attitude(read("09_attitude.npz")), "09_live_serial.png")
