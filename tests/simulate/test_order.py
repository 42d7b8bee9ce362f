"""The physical order of effects, and places that are stated."""

import pytest

from kreisel import discovery
from kreisel.simulate.effects.scale_factor import ScaleFactor
from kreisel.simulate.effects.vibration_lines import VibrationLines
from kreisel.simulate.effects.white_noise import WhiteNoise
from kreisel.simulate.imu import Imu
from kreisel.simulate.order import ORDER, placed

SHAKING = VibrationLines(30.0, 1.0)
SENSOR = Imu.from_preset("mpu6050").accel_effects


def names(effects):
    return [effect.name for effect in effects]


def test_every_plug_in_has_its_place():
    assert sorted(ORDER) == discovery.names("kreisel.simulate.effects")


def test_a_datasheet_is_in_that_order():
    ranks = [ORDER.index(name) for name in names(SENSOR)]
    assert ranks == sorted(ranks) and len(ranks) > 3


def test_what_shakes_the_sensor_comes_first_and_its_noise_after_its_biases():
    assert names(placed(SENSOR, SHAKING)) == ["vibration_lines", *names(SENSOR)]
    more = placed(SENSOR, WhiteNoise(1e-3, name="more"))
    at = names(more).index("more")
    assert all(ORDER.index(name) <= ORDER.index("white_noise") for name in names(more[:at]))
    assert all(ORDER.index(name) > ORDER.index("white_noise") for name in names(more[at + 1 :]))


def test_a_kind_that_nobody_ranked_acts_before_the_output():
    class Foreign(ScaleFactor):
        pass

    made = placed(SENSOR, Foreign(0.1, name="foreign"))
    at = names(made).index("foreign")
    assert names(made)[at - 1] == "white_noise"


def test_a_stated_place():
    last = names(SENSOR)[-1]
    assert names(placed(SENSOR, SHAKING, after=last)) == [*names(SENSOR), "vibration_lines"]
    assert names(placed(SENSOR, SHAKING, before=last)) == [*names(SENSOR)[:-1], "vibration_lines", last]


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ({"before": "rnge"}, "before must be one of .*Did you mean 'range'"),
        ({"before": "range", "after": "range"}, "are two places; give one"),
    ],
)
def test_no_place(place, message):
    with pytest.raises(ValueError, match=message):
        placed(SENSOR, SHAKING, **place)
    with pytest.raises(ValueError, match="this sensor has no other effects"):
        placed((), SHAKING, before="range")
