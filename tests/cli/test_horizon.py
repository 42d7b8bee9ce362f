"""The horizon in the terminal: where sky and ground are for whoever looks along x of the sensor."""

from __future__ import annotations

import numpy as np
import pytest
from rich.console import Console

from kreisel.cli.horizon import GROUND, SKY, drawn, pilots_angles, raster, tape
from kreisel.cli.lines import Lines, Sample
from kreisel.cli.screen import panel
from kreisel.estimate.stream import Snapshot
from kreisel.maths.rotations import matrix_from_euler


def turned(heading: float, pitch: float, roll: float) -> np.ndarray:
    """R_NS of a pilot's angles, deg: nose up is a negative turn about y, which points left."""
    return matrix_from_euler(np.radians([roll, -pitch, 90.0 - heading]))


@pytest.mark.parametrize("angles", [(0.0, 0.0, 0.0), (123.0, 40.0, -170.0), (359.0, -80.0, 20.0)])
def test_angles_are_those_of_pilots(angles: tuple[float, float, float]) -> None:
    # Near the vertical, pitch is an arcsine: 1e-9 deg is a thousand times its round-off.
    assert pilots_angles(turned(*angles)) == pytest.approx(angles, abs=1e-9)


def test_the_ground_is_where_it_is() -> None:
    def ground(*angles: float) -> np.ndarray:
        return raster(turned(*angles), 13, 41) == GROUND

    level = ground(77.0, 0.0, 0.0)
    assert not level[:12].any() and level[16].mean() > 0.8
    assert ground(0.0, 30.0, 0.0).sum() < level.sum() < ground(0.0, -30.0, 0.0).sum()
    right_down = ground(0.0, 0.0, 30.0)
    # The right side down: the ground comes up on the right.
    assert right_down[:, -8:].sum() > 3 * right_down[:, :8].sum()
    upside_down = raster(turned(0.0, 0.0, 180.0), 13, 41)
    assert (upside_down[:10] != SKY).all() and (upside_down[16:] != GROUND).all()


def test_the_tape_has_the_heading_in_its_middle() -> None:
    for heading, name in ((0.0, "N"), (90.0, "E"), (180.0, "S"), (270.0, "W"), (359.9, "N")):
        line = tape(heading, 41)
        assert len(line) == 41 and line[20] == name
    assert tape(90.0, 41).index("NE") < 20 < tape(90.0, 41).index("SE")


def test_without_colours_there_are_letters() -> None:
    plain = [line.plain for line in drawn(raster(turned(0.0, 0.0, 0.0), 13, 41), coloured=False)]
    assert len(plain) == 13 and "#" in plain[-1] and "#" not in plain[0] and "=" in "".join(plain)


@pytest.mark.parametrize(("width", "height", "horizon"), [(100, 30, True), (60, 30, False), (100, 10, False)])
@pytest.mark.parametrize("colour", [True, False])
def test_the_panel_fits_the_terminal(width: int, height: int, horizon: bool, colour: bool) -> None:
    kind = {"color_system": "truecolor", "no_color": not colour, "highlight": False}
    console = Console(width=width, height=height, force_terminal=True, **kind)
    now = Snapshot(
        turned(359.97, 5.0, -5.0), np.radians([0.5, -0.001, 0.0]), np.zeros(3), 0.0, True, True, True
    )
    sample = Sample(1.0, 0.01, (0.0,) * 3, (0.0, 0.0, 9.8), (20.0, 0.0, -40.0))
    with console.capture() as shown:
        console.print(panel(console, sample, now, Lines(), rate_hz=100.0, silence=4.0, listens=True))
    text = shown.get()
    # The numbers alone are a dozen lines.
    assert len(text.splitlines()) <= max(height, 12)
    assert ("▀" in text) == (horizon and colour) and ("#" in text) == (horizon and not colour)
    for word in (
        "0.0",
        "nose up",
        "left side down",
        "+0.50 +0.00 +0.00",
        "at rest",
        "disturbed",
        "silent for 4 s",
    ):
        assert word in text
    assert "360.0" not in text
