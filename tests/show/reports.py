"""A small run to report on, and the numbers of a page as its scripts would read them."""

from __future__ import annotations

import base64
import json
import re
from typing import Any

import numpy as np

from kreisel.study.run import Result, run
from kreisel.study.scenario import Scenario

SCENARIO = """
name = "there & <back>"
seed = 3
duration = {duration}
rate_hz = {rate_hz}
[trajectory]
kind = "lying_eight"
period = 8.0
[[imu]]
name = "wrist"
p_BS = [-0.1, 0.0, 0.05]
sensor = "bmi088"
[[imu]]
name = "elbow"
rotation_deg = [90, 0, 0]
[environment]
field_N_uT = [0.0, 20.0, -44.0]
[[filter]]
kind = "dcm"
[[filter]]
kind = "dcm"
name = "six"
mode = "6"
align = "heading"
"""


def made(duration: float = 8.0, rate_hz: float = 100.0) -> Result:
    """An eight flown with a noisy and a perfect IMU, and two filters on each."""
    return run(Scenario.from_toml(SCENARIO.format(duration=duration, rate_hz=rate_hz)))


def data_of(page: str) -> dict[str, Any]:
    """What the page's scripts read."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    data: dict[str, Any] = json.loads(found[1])
    return data


def floats(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype="<f4").astype(np.float64)


def line(data: dict[str, Any], layer: dict[str, Any], name: str) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of a line, breaks in it left out."""
    packed = layer["lines"][name]
    t, y = floats(packed["t"]) + data["start"], floats(packed["y"]) + packed["y0"]
    good = np.isfinite(y)
    return t[good], y[good]
